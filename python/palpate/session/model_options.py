"""Models by which matter gives way: their names, what each offers to choose, what is chosen.

docs/understand/deformation.md says what the options do.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

from palpate import _core

__all__ = [
    "Boxes",
    "Calibration",
    "Fading",
    "Model",
    "ModelOptions",
    "Motion",
    "Prony",
    "Range",
    "Shares",
    "deformation_models",
    "offered_models",
]


Calibration = Literal["young", "wave-speed"]
"""How the stiffness of particles follows from the material: by E, or by the speed of longitudinal
waves as in the thesis (5.14)."""

Motion = Literal["scaled-time", "fire"]
"""How particles come to rest: they swing in scaled time with friction (thesis 5.17), or FIRE."""


class Prony(NamedTuple):
    """A force that fades while matter is held."""

    share: float
    """Of the force at once, the share that fades."""
    time: float
    """Time constant [s]."""


class ModelOptions(NamedTuple):
    """What is chosen of a model; nothing chosen is as usual.

    Scene files hold them in this order: what is new goes last, with a default.
    """

    edge: int | None = None
    """Nodes or cells along each edge of its box."""
    binding: float | None = None
    """Springs to the initial positions, as a share of a link's stiffness (thesis 5.12)."""
    walls: bool = False
    """Whether particles are kept out of empty voxels (thesis 5.13)."""
    prony: Prony | None = None
    """Force that fades while matter is held; None for elastic matter."""
    yield_strain: float | None = None
    """Strain from which on matter stays as it is pressed; None where it comes back."""
    layers: int | None = None
    """Parts of the work of an answer, from the tool outward (thesis 5.21)."""
    calibration: Calibration | None = None
    motion: Motion | None = None

    @classmethod
    def of_state(cls, state: dict[str, Any]) -> ModelOptions:
        """Returns the options as the engine tells them."""
        prony = state["prony"]
        return cls(**state | {"prony": None if prony is None else Prony(**prony)})


class Boxes(NamedTuple):
    """Boxes that a model can have, by the nodes or cells along each edge; these are odd."""

    least: int
    usual: int
    most: int


class Shares(NamedTuple):
    """Shares that can be chosen."""

    least: float
    usual: float
    most: float


class Range(NamedTuple):
    """Numbers that can be chosen where nothing is usual."""

    least: float
    most: float


class Fading(NamedTuple):
    """How a force can fade."""

    shares: Range
    """Shares of it."""
    times: Range
    """Time constants [s]."""


@dataclass(frozen=True)
class Model:
    """A model, and what it offers to choose."""

    name: str
    title: str
    """Its name, as a person reads it."""
    bonded: bool
    """Whether it is of nodes and bonds that can break; else of particles."""
    boxes: Boxes | None
    """None where it takes all matter."""
    binding: Shares | None
    """None where nothing is bound."""
    walls: bool
    """Whether particles can be kept out of empty voxels."""
    fades: Fading | None
    """How its force can fade; None where it cannot."""
    yields: Range | None
    """Strains from which on its matter stays as it is pressed; None where it comes back."""
    layers: int | None
    """Layers at most, one is usual; None where its work is not parted."""
    calibration: bool
    """Whether calibrations can be chosen."""
    motion: bool
    """Whether motions can be chosen."""


def offered_models() -> list[Model]:
    """Lists the models by which matter gives way."""
    return [
        Model(
            name=each["name"],
            title=each["title"],
            bonded=each["bonded"],
            boxes=None if each["boxes"] is None else Boxes(*each["boxes"]),
            binding=None if each["binding"] is None else Shares(*each["binding"]),
            walls=each["walls"],
            fades=None if each["fades"] is None else Fading(*(Range(*r) for r in each["fades"])),
            yields=None if each["yields"] is None else Range(*each["yields"]),
            layers=each["layers"],
            calibration=each["calibration"],
            motion=each["motion"],
        )
        for each in _core.deformation_models()
    ]


def deformation_models() -> list[str]:
    """Lists the names of the models by which matter gives way."""
    return [model.name for model in offered_models()]
