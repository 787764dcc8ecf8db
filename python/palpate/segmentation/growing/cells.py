"""Cells: means of a scan's values around a seed, on a coarse grid of equal sides.

One cell's middle is the middle of the first seed's voxel, so that what is found does not depend on
where the scan's grid begins. Arrays are [z, y, x], lengths [mm].
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.simpleitk import simpleitk
from palpate.segmentation.mask_shape import Mask
from palpate.segmentation.packed_mask import PackedMask
from palpate.segmentation.side_by_side import side_by_side
from palpate.volumes.volume import Volume

__all__ = ["Box", "Cells", "blurred", "cells_around", "connected", "eroded", "grown_by"]

Box = tuple[slice, slice, slice]

WIDTH = 0.5
"""Standard deviation of the Gaussian that a cell's value is a mean under, in cells."""
SLAB = 24
"""Layers of the scan of which means are taken at once."""
MOST_BLUR = 16
"""How far a Gaussian reaches at most [cells]."""
BLOCK = 0.29
"""The same of a block, in blocks: that of an equal distribution over its length."""


@dataclass(frozen=True)
class Cells:
    """Values of a part of a scan, and where it lies."""

    values: NDArray[np.float32]
    side: float
    """Of a cell [mm]."""
    seeds: tuple[tuple[int, ...], ...]
    """Cells of the seeds, z, y, x."""
    box: Box
    """The part of the scan."""
    first: NDArray[np.float64]
    """Middle of the first cell, seen from the middle of the box's first voxel, z, y, x [mm]."""

    def at(self, field: NDArray[Any], box: Box, edges: NDArray[np.float64]) -> NDArray[np.float32]:
        """Returns a field of the cells at the voxels of a box of the scan, between cells linear."""
        sitk = simpleitk()
        image = sitk.GetImageFromArray(field.astype(np.float32, copy=False))
        image.SetSpacing([self.side] * 3)
        image.SetOrigin(self.first[::-1].tolist())
        offset = [(one.start - own.start) for one, own in zip(box, self.box, strict=True)]
        size = [one.stop - one.start for one in box]
        sampled = sitk.Resample(
            image,
            size[::-1],
            sitk.Transform(),
            sitk.sitkLinear,
            (np.array(offset) * edges)[::-1].tolist(),
            edges[::-1].tolist(),
        )
        found: NDArray[np.float32] = sitk.GetArrayFromImage(sampled)
        return found

    def cut_off(self, box: Box, shape: tuple[int, ...]) -> bool:
        """Returns whether a box of cells ends where the cells end, and the scan goes on."""
        return any(
            (own.start == 0 and whole.start > 0) or (own.stop >= length and whole.stop < most)
            for own, whole, length, most in zip(
                box, self.box, self.values.shape, shape, strict=True
            )
        )

    def voxels_of(self, box: Box, around: int, edges: NDArray[np.float64]) -> Box:
        """Returns the voxels of the scan in a box of cells, with so many cells around."""
        found = []
        for own, whole, first, edge in zip(box, self.box, self.first, edges, strict=True):
            low = (first + (own.start - around) * self.side) / edge
            high = (first + (own.stop - 1 + around) * self.side) / edge
            begin = max(whole.start, whole.start + int(np.floor(low)))
            found.append(slice(begin, min(whole.stop, whole.start + int(np.ceil(high)) + 1)))
        return found[0], found[1], found[2]


def cells_around(
    volume: Volume,
    places: list[NDArray[np.int64]],
    *,
    side: float,
    reach: float,
    told: Callable[[float], None] = lambda _: None,
) -> Cells:
    """Returns the cells of what lies around voxels [z, y, x] at most so far along an axis.

    ``told`` takes the share that is done.
    """
    sitk = simpleitk()
    edges = np.array(volume.spacing[::-1])
    room = np.ceil(reach / edges).astype(np.int64)
    block = np.maximum(1, np.floor(side / edges + 1e-6)).astype(np.int64)
    # the first seed's voxel is in the middle of a block
    low = np.maximum(np.min(places, axis=0) - room, 0)
    low += (places[0] - block // 2 - low) % block
    low = np.where(places[0] < block // 2, 0, low)
    high = np.minimum(np.max(places, axis=0) + room + 1, volume.shape)
    count = np.maximum(1, (high - low) // block)
    high = np.minimum(low + count * block, high)
    box = _box(low, high)
    means = _means(volume, box, block, told=told)
    variance = np.maximum((WIDTH * side) ** 2 - (BLOCK * block * edges) ** 2, 0.0)
    image = sitk.GetImageFromArray(blurred(means, variance / (block * edges) ** 2, most_error=0.02))
    image.SetSpacing((block * edges)[::-1].tolist())
    image.SetOrigin((0.5 * (block - 1) * edges)[::-1].tolist())
    seed = (places[0] - low) * edges
    last = (np.array(means.shape) * block - 1) * edges
    before = np.floor(seed / side + 1e-6).astype(np.int64)
    after = np.floor((last - seed) / side + 1e-6).astype(np.int64)
    first = seed - before * side
    sampled = sitk.Resample(
        _held(image),
        (before + after + 1)[::-1].tolist(),
        sitk.Transform(),
        sitk.sitkLinear,
        first[::-1].tolist(),
        [side] * 3,
    )
    values = sitk.GetArrayFromImage(sampled)
    seeds = [np.rint(((place - low) * edges - first) / side).astype(np.int64) for place in places]
    held = [np.clip(place, 0, np.array(values.shape) - 1) for place in seeds]
    return Cells(values, side, tuple(tuple(map(int, place)) for place in held), box, first)


def connected(mask: Mask, starts: Sequence[tuple[int, ...]]) -> Mask:
    """Returns what of a mask hangs together with some of its voxels, over faces."""
    from scipy.ndimage import label

    numbers = label(mask)[0]
    kept = {int(numbers[start]) for start in starts} - {0}
    if len(kept) == 1:
        found: Mask = numbers == kept.pop()
        return found
    return np.isin(numbers, list(kept))


def eroded(mask: Mask, step: int) -> Mask:
    """Takes a layer of cells away: over faces at even steps, over corners too at odd ones.

    So steps in a row take an octahedron's and a cube's layers in turn, which is nearly a ball.
    Beyond the grid lies what lies at its border.
    """
    return PackedMask.of(mask).eroded(step).mask()


def grown_by(mask: Mask, step: int) -> Mask:
    """Adds a layer of cells, as ``eroded`` takes one."""
    return PackedMask.of(mask).grown(step).mask()


def blurred(
    values: NDArray[np.float32], variance: NDArray[np.float64] | float, *, most_error: float
) -> NDArray[np.float32]:
    """Returns values under a Gaussian, whose variance is given for each axis [cells²].

    The Gaussian is the discrete one (Lindeberg, "Scale-space for discrete signals", 1990), as far
    as its sum lacks no more than ``most_error``; beyond the grid lies what lies at its border.
    """
    from scipy.ndimage import correlate1d
    from scipy.special import ive

    result = values
    for axis, one in enumerate(np.broadcast_to(variance, 3)):
        if one == 0.0:
            continue
        half = ive(np.arange(MOST_BLUR + 1), one)
        sums = 2.0 * np.cumsum(half) - half[0]
        reach = int(np.argmax(sums >= 1.0 - most_error)) if sums[-1] >= 1.0 - most_error else -1
        kept = half[: reach + 1] if reach >= 0 else half
        kernel = np.concatenate([kept[:0:-1], kept])
        result = correlate1d(result, kernel / kernel.sum(), axis=axis, mode="nearest")
    return result


def _box(low: NDArray[np.int64], high: NDArray[np.int64]) -> Box:
    first, second, third = (
        slice(int(begin), int(end)) for begin, end in zip(low, high, strict=True)
    )
    return first, second, third


def _means(
    volume: Volume, box: Box, block: NDArray[np.int64], *, told: Callable[[float], None]
) -> NDArray[np.float32]:
    """Returns the means of blocks of a part of a scan; blocks at the upper end may be cut off."""
    lengths = np.array([side.stop - side.start for side in box])
    block = np.minimum(block, lengths)
    ends = [side.start + int(c) for side, c in zip(box, lengths // block * block, strict=True)]
    thick = int(block[0]) * max(1, SLAB // int(block[0]))

    def work(first: int) -> NDArray[np.float32]:
        part = slice(first, min(first + thick, ends[0]))
        kept = volume.intensities(
            (part, slice(box[1].start, ends[1]), slice(box[2].start, ends[2]))
        )
        for axis, size in enumerate(block.tolist()):
            if size > 1:
                parts = [kept[(slice(None),) * axis + (slice(k, None, size),)] for k in range(size)]
                kept = sum(parts[1:], parts[0]) / np.float32(size)
        return kept

    return np.concatenate(side_by_side(work, range(box[0].start, ends[0], thick), told=told))


def _held(image: Any) -> Any:  # noqa: ANN401  # an image of SimpleITK
    """Returns an image that has the values of its border for one voxel beyond it."""
    return simpleitk().ZeroFluxNeumannPad(image, [1] * 3, [1] * 3)
