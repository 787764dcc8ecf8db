"""How a scene looks in a mode and with a preset, as the page shows it first."""

from __future__ import annotations

from typing import get_args

from palpate.base.errors import OptionError
from palpate.base.nearest import perhaps
from palpate.pictures.appearance import Appearance, Lighting, Mode
from palpate.pictures.looks import ANATOMY, looks, preset_called
from palpate.pictures.shown_segments import ShownBodies
from palpate.pictures.transfer import (
    LEAST_SPAN,
    colour_at,
    transfer_of_preset,
    transfer_of_tissue,
)
from palpate.volumes.histogram import Anchors, Histogram
from palpate.volumes.volume import Volume

__all__ = ["GREY", "appearance_of", "exceeded_by", "require_mode"]

GREY = frozenset({"mip", "minip", "average"})
"""Modes that show one value of each ray, as grey."""

ALL_VALUES = -1e9
"""Inside of a slab all values count, those of lungs too."""


def require_mode(mode: str) -> Mode:
    """Returns a mode by its name.

    Raises:
        OptionError: There is none of this name.
    """
    modes: tuple[Mode, ...] = get_args(Mode)
    for known in modes:
        if known == mode:
            return known
    raise OptionError(f"mode {mode!r} given{perhaps(mode, modes)}; allowed: {', '.join(modes)}")


def appearance_of(
    volume: Volume, bodies: ShownBodies, *, mode: Mode = "shaded", preset: str = ANATOMY
) -> Appearance:
    """Returns the appearance of a scan and its segments (optics.ts, appearance_control.svelte.ts).

    Args:
        volume: The scan.
        bodies: Its segments.
        mode: How the values along a ray become one colour.
        preset: Name of the transfer function.

    Raises:
        OptionError: There is no such preset.
    """
    found, anchors, modes = preset_called(preset), volume.anchors, looks().modes
    brightest = exceeded_by(volume.histogram, modes.few_voxels)
    transfer = (
        transfer_of_tissue(anchors)
        if found is None
        else transfer_of_preset(found, anchors, (volume.range[0], brightest))
    )
    span = max(abs(anchors.bone - anchors.soft_tissue), LEAST_SPAN)
    slab = modes.slabs.get(mode, 0.0)
    return Appearance(
        mode=mode,
        density=modes.densities.get(mode, 1.0),
        transfer=transfer,
        edge_gradient=looks().tissue.edge_share * span,
        window=_window(mode if mode in GREY else "average", anchors, brightest),
        iso_value=anchors.bone,
        iso_colour=colour_at(transfer, anchors.bone),
        tissue_from=ALL_VALUES if slab > 0.0 else _value_at(modes.first_tissue, anchors),
        slab=slab if slab > 0.0 else None,
        lighting=Lighting(**looks().lighting),
        segments=bodies.shown,
        surfaces=bodies.surfaces,
    )


def _window(mode: str, anchors: Anchors, brightest: float) -> tuple[float, float]:
    """Returns width and middle of the window of a mode of grey."""
    black, white = looks().modes.windows[mode]
    low = _value_at(black, anchors)
    high = max(brightest, anchors.bone) if white is None else _value_at(white, anchors)
    return max(high - low, LEAST_SPAN), (low + high) / 2.0


def _value_at(place: float, anchors: Anchors) -> float:
    """Returns the value at a place in tissue units: 0 at soft tissue, 1 at bone."""
    return anchors.soft_tissue + place * (anchors.bone - anchors.soft_tissue)


def exceeded_by(histogram: Histogram, share: float) -> float:
    """Returns the value that no more than a fraction of the voxels exceeds, to a bin."""
    counts = histogram.counts[::-1].cumsum()
    above = int((counts <= share * counts[-1]).sum())
    bins = len(counts)
    width = (histogram.high - histogram.low) / max(1, bins)
    return float(histogram.low + width * (bins - above))
