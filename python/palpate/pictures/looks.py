"""Numbers of looks that pictures from Python and the page share: both read ``looks.json``."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from typing import Literal

import msgspec

from palpate.base.errors import OptionError
from palpate.base.nearest import perhaps

__all__ = ["ANATOMY", "Look", "Looks", "Preset", "Quality", "Stop", "looks", "preset_called"]

ANATOMY = "bone-in-tissue"
"""The transfer function that every scan is shown with first."""

Pair = tuple[float, float]
Quality = Literal["fast", "balanced", "fine", "still"]


class Look(msgspec.Struct, frozen=True, rename="camel"):
    """Base of the structures in ``looks.json``."""


class Preset(Look, frozen=True):
    """A transfer function by a name that the field uses."""

    name: str
    title: str
    scale: Literal["HU", "share"]
    """Whether its values are HU, or fractions of the values that the scan has."""
    opacities: tuple[Pair, ...]
    """Value, and opacity of 1 mm in percent."""
    colours: tuple[tuple[float, str], ...]
    """Value, and colour "#rrggbb"."""


class Stop(Look, frozen=True):
    """A stop of the curve for bone in soft tissue."""

    at: float
    """In tissue units: 0 at soft tissue, 1 at bone."""
    colour: str
    soft: float
    """Extinction of soft tissue at full strength [1/mm]."""
    bone: float


class _Anchors(Look, frozen=True):
    soft_tissue: float
    bone: float


class _Tissue(Look, frozen=True):
    soft_tissue: float
    bone: float
    strongest_soft: float
    weakest_soft: float
    edge_share: float
    stops: tuple[Stop, ...]


class _Modes(Look, frozen=True):
    few_voxels: float
    first_tissue: float
    densities: dict[str, float]
    windows: dict[str, tuple[float, float | None]]
    slabs: dict[str, float]


class _Ground(Look, frozen=True):
    centre: str
    edge: str


class _Framing(Look, frozen=True):
    """All but ``air`` as camera.ts has it; tests hold both together."""

    field_degrees: float
    filled: float
    first_turn: Pair
    air: float


class _Resting(Look, frozen=True):
    steps_per_voxel: float
    passes: int


class Looks(Look, frozen=True):
    """All of ``looks.json``; viewer/src/core/appearance/looks.ts says what each number is."""

    anchors: _Anchors
    presets: tuple[Preset, ...]
    tissue: _Tissue
    modes: _Modes
    lighting: dict[str, float]
    ground: _Ground
    framing: _Framing
    qualities: dict[Quality, _Resting]
    """As quality.ts has them; tests hold both together."""


@cache
def looks() -> Looks:
    """Returns what ``looks.json`` says."""
    text = files("palpate.pictures").joinpath("looks.json").read_bytes()
    return msgspec.json.decode(text, type=Looks)


def preset_called(name: str) -> Preset | None:
    """Returns a preset by its name, whatever its case; None for ``ANATOMY``.

    Raises:
        OptionError: There is none of this name.
    """
    known = {preset.name.casefold(): preset for preset in looks().presets}
    wanted = str(name).casefold().replace(" ", "-")
    if wanted == ANATOMY:
        return None
    if wanted not in known:
        names = (ANATOMY, *known)
        raise OptionError(
            f"preset {name!r} given{perhaps(wanted, names)}; allowed: {', '.join(names)}"
        )
    return known[wanted]
