"""Heights of a grown region: how far values must be let in for it to reach a voxel.

The region that a click has found is one of a family: with a narrower range of values it is less,
with a wider one more. Each voxel has the least range, by that of the region, that reaches it from
the seed where a ball as large as the region's fits through passages. So each range is a threshold
of heights, which are computed once: the least of the highest ones on all ways from the seed, by
reconstruction (Vincent, "Morphological grayscale reconstruction in image analysis", 1993).

Heights are stored as levels 0 to 255, ``USUAL`` for the region itself; arrays are [z, y, x].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from palpate.base.simpleitk import simpleitk
from palpate.segmentation.growing.cells import Box, Cells, connected
from palpate.segmentation.growing.choice import Region, seed_value
from palpate.segmentation.mask_shape import Mask

__all__ = ["MOST", "USUAL", "Levels", "alone", "levels_of"]

USUAL = 128
"""Level of the region itself."""
MOST = 254
"""Level of the widest range; higher is never reached."""
PER_DOUBLE = 84
"""Levels from a range to one twice as wide."""
AROUND = 12
"""How far wider regions may reach [cells]."""


@dataclass(frozen=True)
class Levels:
    """Levels of voxels in a box of the scan."""

    box: Box
    levels: NDArray[np.uint8]
    """Least level at which a voxel belongs to the region, where it hangs together with the seed."""
    seeds: Sequence[tuple[int, ...]]
    """In the box."""
    most: int
    """Voxels of the largest region."""

    @cached_property
    def ends(self) -> tuple[int, int]:
        """The lowest and the highest level that can be chosen."""
        counts = np.cumsum(np.bincount(self.levels.ravel(), minlength=256))
        changes = np.flatnonzero(np.diff(counts, prepend=0)[: MOST + 1])
        fit = int(np.searchsorted(counts, self.most, side="right")) - 1
        least = max(int(changes[0]), *(int(self.levels[seed]) for seed in self.seeds))
        return min(least, USUAL), max(min(int(changes[-1]), fit), USUAL)

    def mask(self, level: int) -> Mask:
        """Returns the region of a level in the box, which hangs together over faces."""
        return connected(self.levels <= level, self.seeds)


def alone(box: Box, region: Mask, seeds: Sequence[tuple[int, ...]]) -> Levels:
    """Returns the levels of a region that is the only one."""
    levels = np.where(region, np.uint8(USUAL), np.uint8(MOST + 1))
    return Levels(box, levels, seeds, int(np.count_nonzero(region)))


def levels_of(
    cells: Cells,
    region: Region,
    found: tuple[Box, Mask],
    *,
    seeds: list[NDArray[np.int64]],
    edges: NDArray[np.float64],
    most: int,
) -> Levels:
    """Returns the levels around a region of cells that was found as voxels in a box of the scan.

    Args:
        cells: The cells.
        region: What of them was chosen.
        found: The box, and the region in it.
        seeds: Voxels of the scan that the region holds.
        edges: Sides of a voxel, z, y, x [mm].
        most: Voxels of the largest region.
    """
    near = _around(region.box, cells.values.shape, AROUND)
    mask = np.zeros(cells.values.shape, bool)
    mask[region.box] = region.mask
    starts = [_place(seed, near) for seed in cells.seeds]
    off = cells.values[near] - seed_value(cells)
    ranges = (np.maximum(-off, 0.0) if region.open_above else np.abs(off)) / region.half
    levels = _level_of(ranges)
    own = np.where(mask[near], np.minimum(levels, USUAL), np.maximum(levels, USUAL + 1))
    heights = _heights(own, starts, steps=max(region.steps, 1))
    heights = np.where(mask[near], np.minimum(heights, USUAL), heights)
    # between cells the region's border is the one that was found
    part = Cells(
        heights, cells.side, (), cells.box, cells.first + [side.start * cells.side for side in near]
    )
    first, second, third = (slice(0, length) for length in heights.shape)
    box = _joined(part.voxels_of((first, second, third), 0, edges), found[0])
    # where there are no cells ``at`` gives 0, so levels are taken from the highest
    beyond = 255.0 - part.at(255.0 - np.maximum(heights, USUAL + 1), box, edges)
    at_voxels = np.maximum(beyond, USUAL + 1)
    less = np.minimum(255.0 - part.at(255.0 - np.minimum(heights, USUAL), found[0], edges), USUAL)
    inner = at_voxels[tuple(_within(own, whole) for own, whole in zip(found[0], box, strict=True))]
    inner[found[1]] = less[found[1]]
    places = [_place(seed, box) for seed in seeds]
    return Levels(box, np.ceil(at_voxels).astype(np.uint8), places, most)


def _level_of(ranges: NDArray[np.float32]) -> NDArray[np.float32]:
    """Returns the levels of ranges, which are shares of the region's."""
    with np.errstate(divide="ignore"):
        levels = USUAL + PER_DOUBLE * np.log2(ranges)
    found: NDArray[np.float32] = np.clip(np.ceil(levels), 0.0, 255.0).astype(np.float32)
    return found


def _heights(
    levels: NDArray[np.float32], starts: Sequence[tuple[int, ...]], *, steps: int
) -> NDArray[np.float32]:
    """Returns the least level at which a ball of so many layers brings a seed to each cell."""
    fits = levels
    for step in range(steps):
        fits = _layer(fits, step, highest=True)
    # the ball lies where it fits best of the places that hold the seed
    places = []
    for start in starts:
        near = tuple(slice(max(0, c - steps), c + steps + 1) for c in start)
        best = np.unravel_index(int(fits[near].argmin()), fits[near].shape)
        places.append(tuple(int(c) + side.start for c, side in zip(best, near, strict=True)))
    heights = _reached(fits.astype(np.uint8), places).astype(np.float32)
    for step in reversed(range(steps)):
        heights = np.maximum(_layer(heights, step, highest=False), levels)
    return heights


def _layer(values: NDArray[np.float32], step: int, *, highest: bool) -> NDArray[np.float32]:
    """Returns the highest or lowest value of each cell and those around it, by layers as masks."""
    from scipy.ndimage import generate_binary_structure, maximum_filter, minimum_filter

    work = maximum_filter if highest else minimum_filter
    if step % 2:
        filtered = work(values, size=3, mode="nearest")
    else:
        filtered = work(values, footprint=generate_binary_structure(3, 1), mode="nearest")
    found: NDArray[np.float32] = filtered
    return found


def _reached(levels: NDArray[np.uint8], starts: list[tuple[int, ...]]) -> NDArray[np.uint8]:
    """Returns the least of the highest levels on all ways over faces from places."""
    sitk = simpleitk()
    marker = np.full_like(levels, 255)
    for start in starts:
        marker[start] = levels[start]
    heights = sitk.ReconstructionByErosion(
        sitk.GetImageFromArray(marker), sitk.GetImageFromArray(levels), fullyConnected=False
    )
    found: NDArray[np.uint8] = sitk.GetArrayFromImage(heights)
    return found


def _place(voxel: Sequence[int] | NDArray[np.int64], box: Box) -> tuple[int, ...]:
    return tuple(int(c) - side.start for c, side in zip(voxel, box, strict=True))


def _around(box: Box, shape: tuple[int, ...], by: int) -> Box:
    first, second, third = (
        slice(max(0, side.start - by), min(length, side.stop + by))
        for side, length in zip(box, shape, strict=True)
    )
    return first, second, third


def _joined(one: Box, other: Box) -> Box:
    first, second, third = (
        slice(min(own.start, its.start), max(own.stop, its.stop))
        for own, its in zip(one, other, strict=True)
    )
    return first, second, third


def _within(own: slice, whole: slice) -> slice:
    return slice(own.start - whole.start, own.stop - whole.start)
