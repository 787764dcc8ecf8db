"""Segments out of scans and of other segments: by growing, and by changing their shape.

Lengths [mm], volumes [ml].
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np

from palpate.base.errors import OptionError
from palpate.base.progress import Progress, silent
from palpate.segmentation import mask_shape
from palpate.segmentation.growing.levels import Levels
from palpate.segmentation.growing.region_growing import Growing, grow, grow_levels
from palpate.segmentation.joint_smoothing import smooth_together
from palpate.segmentation.lengths_in_voxels import least_voxels, whole_voxels
from palpate.segmentation.mask_shape import Mask
from palpate.segmentation.multi_otsu import otsu
from palpate.segmentation.slice_interpolation import between_slices
from palpate.segmentation.told_of_shape import told_of_shape
from palpate.segmentation.watershed import grown_from_seeds
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume

__all__ = [
    "Growing",
    "Levels",
    "ShapeKind",
    "changed_shape",
    "grow_levels",
    "grown",
    "grown_from_seeds",
    "otsu",
    "smoothed_together",
    "with_mask",
]

ShapeKind = Literal[
    "keep-largest",
    "drop-small",
    "fill-holes",
    "between-slices",
    "grow",
    "shrink",
    "smooth",
    "median",
    "joint",
    "open",
    "close",
    "hollow-inside",
    "hollow-outside",
    "unite",
    "subtract",
    "intersect",
]
"""How the shape of a segment is changed."""

LOGIC: dict[str, Callable[[Mask, Mask], Mask]] = {
    "unite": np.logical_or,
    "subtract": lambda own, other: own & ~other,
    "intersect": np.logical_and,
}
"""What is done with another segment."""

LENGTHS: dict[str, Callable[[Mask, Sequence[float], float], Mask]] = {
    "grow": mask_shape.margin,
    "shrink": lambda mask, spacing, by: mask_shape.margin(mask, spacing, -by),
    "smooth": mask_shape.smooth,
    "median": mask_shape.median,
    "open": mask_shape.opened,
    "close": mask_shape.closed,
    "hollow-inside": mask_shape.hollow,
    "hollow-outside": lambda mask, spacing, by: mask_shape.hollow(mask, spacing, -by),
}
"""What takes a length [mm]."""

LONGEST = 100.0
"""Largest length that is taken [mm]."""


def grown(
    volume: Volume,
    seeds: Sequence[Sequence[float]],
    *,
    name: str = "region",
    growing: Growing | None = None,
    progress: Progress = silent,
) -> Segment:
    """Returns the segment that grows from seeds; see ``region_growing.grow``."""
    return volume.segment(grow(volume, seeds, growing=growing, progress=progress), name=name)


def changed_shape(
    segment: Segment,
    kind: ShapeKind,
    *,
    amount: float = 0.0,
    other: Segment | None = None,
) -> Segment:
    """Returns a segment of another shape, on the same grid and under the same name.

    Its ``warnings`` say what the grid cannot express of the change, such as a margin that is less
    than a voxel along an axis.

    Args:
        segment: What is changed.
        kind: How.
        amount: ``keep-largest``: how many islands; ``drop-small``: the volume from which on they
            stay [ml]; where a length is taken, that length [mm].
        other: The segment that is united, subtracted or intersected.

    Raises:
        OptionError: The amount is out of range, or the other segment is missing or stands on
            another grid.
    """
    volume = segment.volume
    mask = segment.mask() != 0
    if kind in LOGIC:
        changed = LOGIC[kind](mask, _mask_of(other, segment))
    elif kind in LENGTHS:
        _check_length(amount)
        if kind.startswith("hollow"):
            _check_shell(amount, volume.spacing)
        changed = LENGTHS[kind](mask, volume.spacing, amount)
    elif kind == "joint":
        return smoothed_together([segment], deviation=amount)[0]
    elif kind == "fill-holes":
        changed = mask_shape.filled(mask)
    elif kind == "between-slices":
        changed = between_slices(mask, volume.spacing)
    elif kind == "drop-small":
        if amount < 0.0:
            raise OptionError(f"{amount:g} ml given; allowed: 0 or more")
        changed = mask_shape.drop_small(mask, least_voxels(amount, volume.voxel_volume))
    else:
        if not 1.0 <= amount <= 1000.0:
            raise OptionError(f"{amount:g} islands given; allowed: 1 to 1000")
        changed = mask_shape.keep_largest(mask, int(amount))
    result = with_mask(segment, changed)
    told = told_of_shape(kind, amount, volume.spacing, masks=(mask, changed))
    result.warnings = (*segment.warnings, *told)
    return result


def with_mask(segment: Segment, mask: Mask, *, name: str | None = None) -> Segment:
    """Returns a segment of other voxels on the grid of ``segment``, by default under its name."""
    made = segment.volume.segment(mask, name=name or segment.name)
    return made.as_object() if segment.has_own_grid else made


def smoothed_together(segments: Sequence[Segment], *, deviation: float) -> list[Segment]:
    """Returns segments smoothed together, so that neighbours still meet; names stay.

    Args:
        segments: On one grid, without common voxels.
        deviation: Of the Gaussian [mm].

    Raises:
        OptionError: The deviation is out of range, two share voxels or stand on different grids.
    """
    _check_length(deviation)
    first = segments[0]
    masks = [first.mask() != 0, *(_mask_of(other, first) for other in segments[1:])]
    smoothed = [
        with_mask(first, mask, name=segment.name)
        for mask, segment in zip(
            smooth_together(masks, first.volume.spacing, deviation), segments, strict=True
        )
    ]
    for each, segment in zip(smoothed, segments, strict=True):
        each.warnings = segment.warnings
    return smoothed


def _check_length(amount: float) -> None:
    if not 0.0 < amount <= LONGEST:
        raise OptionError(f"{amount:g} mm given; allowed: more than 0, up to {LONGEST:g} mm")


def _check_shell(thickness: float, spacing: Sequence[float]) -> None:
    least = min(spacing)
    if whole_voxels(thickness, least) < 1:
        raise OptionError(
            f"a shell of {thickness:g} mm given; allowed: a voxel's smallest side at least, "
            f"{least:g} mm"
        )


def _mask_of(other: Segment | None, segment: Segment) -> Mask:
    if other is None:
        raise OptionError("no other segment given; allowed: one on the same grid")
    same = other.volume.shape == segment.volume.shape and np.allclose(
        other.volume.patient_from_grid, segment.volume.patient_from_grid
    )
    if not same:
        raise OptionError(
            f"{other.name!r} stands on another grid than {segment.name!r}; allowed: segments "
            "with the same voxels"
        )
    mask: Mask = other.mask() != 0
    return mask
