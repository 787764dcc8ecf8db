"""Which of many regions around a seed is a body: the one whose border is an edge of values.

Ranges of values around the seed's and balls that must fit through passages are tried; each pair
makes a region of cells. Few of a good region's values differ from those beside them but at its
border, and its border is short for its volume. One that has leaked, or is part of a body, ends in
places where values do not change, or holds edges, or is ragged.

Arrays are [z, y, x] of cells.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import KW_ONLY, dataclass
from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import NDArray

from palpate.base.simpleitk import simpleitk
from palpate.segmentation.growing.cells import Box, Cells, connected
from palpate.segmentation.mask_shape import Mask, box_of
from palpate.segmentation.packed_mask import PackedMask
from palpate.segmentation.side_by_side import side_by_side

__all__ = [
    "Found",
    "Region",
    "in_box",
    "measured",
    "regions",
    "seed_value",
    "slopes_of",
    "span_of",
    "without_holes",
]

HALVES = (0.01, 0.017, 0.027, 0.043, 0.067, 0.107)
"""Halves of ranges that are tried, as shares of the scan's values without the outermost ones."""
STEPS = 6
"""Layers at most that are taken from what is in range, so that passages close."""
DEEPEST = 20
"""Layers at most that are counted."""
BALL = 10.0
"""Border of a smooth body, both sides of it, by its volume's 2/3rd power."""
TUBE = 3.7
"""The same of a tube, where its volume's 3rd root is its depth."""
THIN = 4
"""Thinner tubes are not told from ragged sheets [cells]."""
NOISE = 3.0
"""Half of the narrowest range at least, in standard deviations of the noise of cells."""
SLOPE = 0.7
"""Standard deviation of the Gaussian that slopes are of [cells]."""
FAR = 4
"""How far from a border values do not count for a slope [cells]."""
INNER = 90.0
"""Percentile of the differences within a region above which its border is an edge."""


@dataclass(frozen=True)
class Found:
    """A region of cells, in a box of them that shows its border."""

    mask: Mask
    box: Box
    half: float
    """Of the range of values."""
    open_above: bool = False
    steps: int = 0

    @cached_property
    def count(self) -> int:
        """How many cells it has."""
        return int(np.count_nonzero(self.mask))


@dataclass(frozen=True)
class Region(Found):
    """A region of cells, and how well it ends at an edge."""

    _: KW_ONLY
    edge: float
    """Share of its border at an edge of values, 0 to 1."""
    ragged: float
    """Its border by that of a smooth body as large and as deep; 1 at least."""
    depth: int
    """Of its deepest cell [cells]."""

    @property
    def score(self) -> float:
        """How good it is, 0 to 1."""
        return self.edge / self.ragged


def seed_value(cells: Cells) -> float:
    """Returns the median of the seeds' cells and of those beside them."""
    near = []
    for seed in cells.seeds:
        for axis in range(3):
            for by in (-1, 0, 1):
                place = list(seed)
                place[axis] = min(max(place[axis] + by, 0), cells.values.shape[axis] - 1)
                near.append(cells.values[tuple(place)])
    return float(np.median(near))


def span_of(cells: Cells, value: float) -> float:
    """Returns how far values lie apart without the outermost ones, with one that counts."""
    first, last = np.percentile(cells.values, (1.0, 99.0))
    return float(max(last, value) - min(first, value))


def regions(
    cells: Cells, *, most: int, told: Callable[[float], None] = lambda _: None
) -> list[Region]:
    """Returns the regions of all ranges and passages that hold the seeds, of so many cells at most.

    Ranges are tried side by side; ``told`` takes the share that is done.
    """
    middle = seed_value(cells)
    span, noise = span_of(cells, middle), _noise(cells.values)
    halves = [float(np.hypot(share * span, NOISE * noise)) for share in HALVES]

    def follow(tried: tuple[float, bool]) -> list[Found]:
        half, above = tried
        high = np.inf if above else middle + half
        in_range = (cells.values >= middle - half) & (cells.values <= high)
        found: list[Found] = []
        for steps, mask, box in _followed(in_range, list(cells.seeds), most=most):
            one = Found(*in_box(mask, box), half, above, steps)
            if one.count <= most and not (found and one.count == found[-1].count):
                found.append(one)
        return found

    tried = side_by_side(
        follow,
        product(halves, (False, True)),
        told=lambda share: told(0.8 * share),
    )
    found = [one for some in tried for one in some]
    slopes = slopes_of(cells.values, [one.box for one in found])
    return side_by_side(
        lambda one: measured(one, slopes), found, told=lambda share: told(0.8 + 0.2 * share)
    )


def in_box(mask: Mask, box: Box) -> tuple[Mask, Box]:
    """Returns a mask of a box of cells in the smallest box that shows its border, and that box."""
    tight = box_of(mask)
    first, second, third = (
        slice(whole.start + own.start, whole.start + min(own.stop, length))
        for whole, own, length in zip(box, tight, mask.shape, strict=True)
    )
    return mask[tight], (first, second, third)


def measured(found: Found, slopes: NDArray[np.float32]) -> Region:
    """Returns a region with how well it ends at an edge; slopes are of all cells."""
    edge, ragged, depth = _border(found.mask, slopes[found.box])
    return Region(
        found.mask,
        found.box,
        found.half,
        found.open_above,
        found.steps,
        edge=edge,
        ragged=ragged,
        depth=depth,
    )


def _followed(
    in_range: Mask, seeds: list[tuple[int, ...]], *, most: int
) -> Iterator[tuple[int, Mask, Box]]:
    """Yields what of a range a ball reaches from the seeds, for balls of more and more layers.

    What has more cells than ``most`` may be left out.
    """
    there = connected(in_range, seeds)
    if not there.any():
        return
    box = box_of(there)
    start = np.array([side.start for side in box])
    inside = [tuple(int(c) for c in np.array(seed) - start) for seed in seeds if there[seed]]
    held = PackedMask.of(without_holes(there[box]))
    layer, near = held, _all_of(there[box])
    for steps in range(STEPS + 1):
        fits = layer.mask()
        cores = [_nearest(fits, seed, steps + 1) for seed in inside]
        begins = [core for core in cores if core is not None]
        if not begins:
            return
        core, near = _core(fits, begins, near)
        region = PackedMask.of(core)
        if region.count <= most:
            for step in reversed(range(steps)):
                region = region.grown(step) & held
            mask = region.mask()
            if all(mask[seed] for seed in inside):
                yield steps, mask, box
        layer = layer.eroded(steps)


def _core(mask: Mask, starts: list[tuple[int, ...]], near: Box) -> tuple[Mask, Box]:
    """Returns what of a mask hangs together with some of its voxels, and its box.

    It is looked for in a box where it was before layers were taken from the mask.
    """
    if not all(
        side.start <= c < side.stop for s in starts for c, side in zip(s, near, strict=True)
    ):
        near = _all_of(mask)
    begins = [tuple(c - side.start for c, side in zip(s, near, strict=True)) for s in starts]
    core = connected(mask[near], begins)
    whole = np.zeros(mask.shape, bool)
    whole[near] = core
    return whole, in_box(core, near)[1]


def _all_of(mask: Mask) -> Box:
    first, second, third = (slice(0, length) for length in mask.shape)
    return first, second, third


def _nearest(mask: Mask, seed: tuple[int, ...], reach: int) -> tuple[int, ...] | None:
    """Returns the voxel of a mask that is nearest to a seed, of those near it."""
    if mask[seed]:
        return seed
    low = np.maximum(np.array(seed) - reach, 0)
    box = tuple(slice(int(a), int(c) + reach + 1) for a, c in zip(low, seed, strict=True))
    found = np.argwhere(mask[box])
    if not found.size:
        return None
    off = ((found + low - seed) ** 2).sum(axis=1)
    return tuple(int(c) for c in found[int(off.argmin())] + low)


def without_holes(mask: Mask) -> Mask:
    """Returns a mask with what it encloses."""
    from scipy.ndimage import label

    numbers, count = label(np.pad(~mask, 1, constant_values=True))
    found: Mask = (numbers != numbers[0, 0, 0])[1:-1, 1:-1, 1:-1] if count > 1 else mask
    return found


def _noise(values: NDArray[np.float32]) -> float:
    """Returns the standard deviation of the noise, from differences of cells beside each other."""
    if len(values) < 2:
        return 0.0
    return 1.4826 * float(np.median(np.abs(np.diff(values, axis=0)))) / math.sqrt(2.0)


def slopes_of(
    values: NDArray[np.float32], boxes: Sequence[Box] | None = None
) -> NDArray[np.float32]:
    """Returns how much values change around each cell, or each in some boxes [unit by cell]."""
    sitk = simpleitk()
    box = tuple(slice(0, length) for length in values.shape)
    if boxes is not None:
        box = tuple(
            slice(
                max(0, min((one[axis].start for one in boxes), default=0) - FAR),
                max((one[axis].stop for one in boxes), default=1) + FAR,
            )
            for axis in range(3)
        )
    slopes = np.zeros(values.shape, np.float32)
    slopes[box] = sitk.GetArrayFromImage(
        sitk.GradientMagnitudeRecursiveGaussian(sitk.GetImageFromArray(values[box]), SLOPE)
    )
    return slopes


def _border(mask: Mask, slopes: NDArray[np.float32]) -> tuple[float, float, int]:
    """Returns the share of a region's border at an edge, how smooth it is, and its depth."""
    padded = PackedMask.of(np.pad(mask, 1))
    around = np.pad(slopes, 1, mode="edge")
    rim = (padded.grown(0) & ~padded.eroded(0)).mask()
    inner = padded.eroded(1)
    within = around[(inner if inner.count > 10 else padded).mask()]
    at_border = around[rim]
    edge = float(np.mean(at_border > np.percentile(within, INNER)))
    return edge, *_shape(padded, at_border.size)


def _shape(mask: PackedMask, border: int) -> tuple[float, int]:
    """Returns how ragged a region with so many cells at its border is, and how deep."""
    count, depth, left = mask.count, 0, mask
    while left.count and depth < DEEPEST:
        left = left.eroded(depth)
        depth += 1
    usual = max(BALL, TUBE * count ** (1.0 / 3.0) / max(depth, THIN))
    return max(1.0, border / count ** (2.0 / 3.0) / usual), depth
