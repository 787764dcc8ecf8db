"""Growing a region from seeds: what has values like theirs and hangs together with them.

Organs touch others of nearly the same values. So the region does not go where a ball of a certain
size does not fit through: the values in range are eroded by the ball's radius, followed from the
seed, and grown back. Which range and which ball is found by trying many on coarse cells
(``choice.py``); the border is then found at the scan's voxels (``border.py``).

Where a person gives the range, the spread or the passage, these count. Then, where the region
becomes larger than what is allowed, a larger ball is tried.

Frames: see ``volumes/volume.py``; arrays are [z, y, x].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import EmptySegmentError, OptionError
from palpate.base.progress import Progress, silent
from palpate.base.simpleitk import simpleitk
from palpate.segmentation.growing.by_choice import grown_by_choice
from palpate.segmentation.growing.cells import Box
from palpate.segmentation.growing.levels import USUAL, Levels, alone
from palpate.segmentation.lengths_in_voxels import most_voxels, whole_voxels, within
from palpate.segmentation.mask_shape import (
    Mask,
    box_of,
    closed,
    filled,
    margin,
    squared_distance_to,
)
from palpate.volumes.volume import Volume

__all__ = ["Growing", "grow", "grow_levels"]

SMOOTHING = 1.5
"""Standard deviation of the Gaussian that takes noise away before values are compared [mm]."""

BORDER = 3.0
"""How far smoothing may have moved the border of the values in range [mm]."""

NEIGHBOURHOOD = 6.0
"""Values of the seed are those within this distance of it [mm]."""

SPREAD = 2.5
"""Half of the range where only a passage is given, in standard deviations around the seeds."""

PASSAGE = 10.0
"""Passages that are not entered where only a range or a spread is given [mm]."""

LEAST_SPREAD = 0.012
"""Half of the range at least, as a share of the scan's values without the outermost ones."""

STEP = 1.25
"""By how much the ball grows where the region became too large."""

LARGEST_PASSAGE = 40.0
"""Wider passages than this are not closed [mm]."""

ROOM = 2.0
"""How far from the seed the region may reach, in radii of the ball of its largest volume."""


@dataclass(frozen=True, kw_only=True)
class Growing:
    """How a region grows."""

    range: tuple[float, float] | None = None
    """Values that belong to it [unit of the scan]; by default those around the seeds."""
    spread: float | None = None
    """Half of that range, in standard deviations of the values around the seeds; by default that
    whose region ends best at an edge of values."""
    passage: float | None = None
    """Passages narrower than this are not entered [mm]; found as the spread is."""
    most_ml: float = 2500.0
    """Larger than this it does not become."""
    fill: bool = True
    """Whether holes are filled and small dents closed at the end."""

    def check(self) -> None:
        """Refuses what is out of range.

        Raises:
            OptionError: A value is.
        """
        if self.range is not None and not (
            np.isfinite(self.range).all() and self.range[0] <= self.range[1]
        ):
            low, high = self.range
            raise OptionError(f"range {low:g} to {high:g} given; allowed: the lower value first")
        for name, low, high in (
            ("spread", 0.1, 20.0),
            ("passage", 0.0, LARGEST_PASSAGE),
            ("most_ml", 0.001, 100_000.0),
        ):
            value = getattr(self, name)
            if value is not None and not low <= value <= high:
                raise OptionError(f"{name} {value:g} given; allowed: {low:g} to {high:g}")


def grow(
    volume: Volume,
    seeds: Sequence[Sequence[float]],
    *,
    growing: Growing | None = None,
    progress: Progress = silent,
) -> Mask:
    """Returns the region that grows from seeds, shape as the scan's.

    Args:
        volume: The scan.
        seeds: Points in the patient [mm], shape [count, 3]; the region holds all that can be held.
        growing: How it grows.
        progress: Told what is being done.

    Raises:
        OptionError: A seed lies outside of the scan, or an option is out of range.
        EmptySegmentError: No voxel at the seeds is in range.
    """
    how = growing or Growing()
    how.check()
    levels = _levels(volume, seeds, how=how, progress=progress)
    mask = np.zeros(volume.shape, bool)
    mask[levels.box] = levels.mask(USUAL)
    return mask


def grow_levels(
    volume: Volume,
    seed: Sequence[float],
    *,
    growing: Growing | None = None,
    progress: Progress = silent,
) -> Levels:
    """Returns the region that grows from a seed, with those of narrower and wider ranges.

    Where a person gives the range, the spread or the passage, there is one only.

    Args:
        volume: The scan.
        seed: Point in the patient [mm].
        growing: How it grows.
        progress: Told what is being done.

    Raises:
        OptionError: The seed lies outside of the scan, or an option is out of range.
        EmptySegmentError: No voxel at the seed is in range.
    """
    how = growing or Growing()
    how.check()
    return _levels(volume, [seed], how=how, progress=progress)


def _levels(
    volume: Volume, seeds: Sequence[Sequence[float]], *, how: Growing, progress: Progress
) -> Levels:
    """Returns the levels of the region that grows from seeds."""
    places = _places(volume, seeds)
    if how.range is None and how.spread is None and how.passage is None:
        return grown_by_choice(
            volume, places, most_ml=how.most_ml, fill=how.fill, progress=progress
        )
    return alone(*_by_hand(volume, seeds, places, how=how, progress=progress))


def _by_hand(
    volume: Volume,
    seeds: Sequence[Sequence[float]],
    places: list[NDArray[np.int64]],
    *,
    how: Growing,
    progress: Progress,
) -> tuple[Box, Mask, list[tuple[int, ...]]]:
    """Returns the region of the range, spread or passage that a person gives, in a box.

    Also returns voxels of it at the seeds, which may lie beside it.
    """
    box = _box(volume, places, how.most_ml)
    inside = [_shifted(place, box, -1) for place in places]
    progress("smoothing values", None)
    in_range, ends, needed = _in_range(volume, seeds, inside, box=box, how=how)
    progress("finding narrow passages", None)
    # what does not hang together with the seeds has no say
    near = [_near(seed, volume.spacing) for seed in inside]
    there = _connected(in_range, [place for one in near for place in _voxels_of(in_range, one)])
    part = box_of(there)
    core, starts = _follow(
        in_range[part],
        [_shifted(seed, part, -1) for seed in inside],
        volume=volume,
        how=how,
        progress=progress,
    )
    if not starts:
        raise EmptySegmentError(f"nothing{needed}")
    progress("finding the border", None)
    region = np.zeros_like(in_range)
    region[part] = core
    tight = box_of(region, BORDER + 2.0 * max(volume.spacing), volume.spacing)
    at = _joined(box, tight)
    found = _to_border(region[tight], volume.between(*ends, at), volume.spacing, fill=how.fill)
    return at, found, [_shifted(_shifted(start, part, 1), tight, -1) for start in starts]


def _shifted(place: Sequence[int] | NDArray[np.int64], box: Box, by: int) -> tuple[int, ...]:
    """Returns a voxel of what a box is cut from in the box (by -1), or the reverse (by 1)."""
    return tuple(int(c) + by * side.start for c, side in zip(place, box, strict=True))


def _joined(box: Box, inner: Box) -> Box:
    """Returns a box within a box, in what that is cut from."""
    first, second, third = (
        slice(whole.start + own.start, min(whole.start + own.stop, whole.stop))
        for whole, own in zip(box, inner, strict=True)
    )
    return first, second, third


def _voxels_of(mask: Mask, box: tuple[slice, ...]) -> list[tuple[int, ...]]:
    low = [side.start for side in box]
    return [tuple(map(int, place)) for place in np.argwhere(mask[box]) + low]


def _in_range(
    volume: Volume,
    seeds: Sequence[Sequence[float]],
    inside: list[tuple[int, ...]],
    *,
    box: Box,
    how: Growing,
) -> tuple[Mask, tuple[float, float], str]:
    """Returns which voxels of a box are in range without their noise, and enclosed ones.

    Also returns the range with it, and the end of a sentence on what seeds may be.

    Raises:
        EmptySegmentError: No voxel at a seed is in range.
    """
    spread = SPREAD if how.spread is None else how.spread
    raw, values = _values(volume, box)
    low, high = how.range or _range(values, inside, spacing=volume.spacing, spread=spread)
    needed = _needed(low, high, volume, how=how)
    in_range = (values >= low) & (values <= high)
    for seed, place in zip(seeds, inside, strict=True):
        if not in_range[_near(place, volume.spacing)].any():
            told = f"values around seed {_mm(seed)} are about {values[place]:.3g}"
            raise EmptySegmentError(f"{told}{needed}")
    ends = how.range or _range(raw, inside, spacing=volume.spacing, spread=spread)
    return filled(in_range), ends, needed


def _mm(seed: Sequence[float]) -> str:
    return f"{', '.join(f'{c:g}' for c in seed)} mm"


def _needed(low: float, high: float, volume: Volume, *, how: Growing) -> str:
    """Says in which unit values are, and which ones seeds may have."""
    unit = f" {volume.unit}" if volume.unit else ""
    other = "another spread, or seeds in the same tissue" if how.range is None else "another range"
    return f"{unit}; allowed: values of {low:.4g} to {high:.4g}{unit}, or {other}"


def _extent(volume: Volume) -> str:
    """Says where a scan lies in the patient, in whole mm."""
    corners = np.array(list(product(*((0.0, float(edge)) for edge in volume.dimensions))))
    places = corners @ volume.patient_from_grid[:3, :3].T + volume.patient_from_grid[:3, 3]
    ends = zip("xyz", places.min(axis=0), places.max(axis=0), strict=True)
    return ", ".join(f"{axis} from {low:.0f} to {high:.0f}" for axis, low, high in ends)


def _places(volume: Volume, seeds: Sequence[Sequence[float]]) -> list[NDArray[np.int64]]:
    """Returns the voxels of seeds, z, y, x."""
    if not seeds:
        raise OptionError("no seed given; allowed: one or more points of the scan")
    grid_from_patient = np.linalg.inv(volume.patient_from_grid)
    places = []
    for seed in seeds:
        grid = grid_from_patient[:3, :3] @ np.asarray(seed, np.float64) + grid_from_patient[:3, 3]
        if not ((grid >= 0.0) & (grid < volume.dimensions)).all():
            raise OptionError(
                f"seed {_mm(seed)} lies outside of {volume.name}; allowed: points in it, "
                f"{_extent(volume)}"
            )
        places.append(np.floor(grid[::-1]).astype(np.int64))
    return places


def _box(
    volume: Volume, places: list[NDArray[np.int64]], most_ml: float
) -> tuple[slice, slice, slice]:
    """Returns the part of the scan that a region of so much volume may reach."""
    reach = ROOM * (0.75 / np.pi * most_ml * 1000.0) ** (1.0 / 3.0)
    room = np.ceil(reach / np.array(volume.spacing[::-1])).astype(np.int64)
    low = np.maximum(np.min(places, axis=0) - room, 0)
    high = np.minimum(np.max(places, axis=0) + room + 1, volume.shape)
    first, second, third = (
        slice(int(begin), int(end)) for begin, end in zip(low, high, strict=True)
    )
    return first, second, third


def _values(
    volume: Volume, box: tuple[slice, slice, slice]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Returns a part of the scan, and the same without its noise [unit of the scan]."""
    sitk = simpleitk()
    raw = volume.intensities(box)
    image = sitk.GetImageFromArray(raw)
    image.SetSpacing(volume.spacing)
    image = sitk.DiscreteGaussian(
        image,
        variance=SMOOTHING**2,
        maximumKernelWidth=64,
        maximumError=0.02,
        useImageSpacing=True,
    )
    return raw, sitk.GetArrayFromImage(image)


def _range(
    values: NDArray[np.float32],
    seeds: list[tuple[int, ...]],
    *,
    spacing: Sequence[float],
    spread: float,
) -> tuple[float, float]:
    """Returns the range of values around the seeds, by median and median deviation."""
    near = np.concatenate([_ball(values, seed, spacing) for seed in seeds])
    middle = float(np.median(near))
    deviation = 1.4826 * float(np.median(np.abs(near - middle)))
    first, last = np.percentile(values[::4, ::4, ::4], (1.0, 99.0))
    half = max(spread * deviation, LEAST_SPREAD * float(last - first))
    return middle - half, middle + half


def _ball(
    values: NDArray[np.float32], seed: tuple[int, ...], spacing: Sequence[float]
) -> NDArray[np.float32]:
    """Returns the values around a seed."""
    sides = [whole_voxels(NEIGHBOURHOOD, edge) for edge in reversed(spacing)]
    box = tuple(
        slice(max(0, place - side), min(length, place + side + 1))
        for place, side, length in zip(seed, sides, values.shape, strict=True)
    )
    axes = np.ogrid[box]
    off = sum(
        ((axis - place) * edge) ** 2
        for axis, place, edge in zip(axes, seed, reversed(spacing), strict=True)
    )
    found: NDArray[np.float32] = values[box][within(np.asarray(off), NEIGHBOURHOOD)]
    return found


def _follow(
    in_range: Mask,
    seeds: list[tuple[int, ...]],
    *,
    volume: Volume,
    how: Growing,
    progress: Progress,
) -> tuple[Mask, list[tuple[int, ...]]]:
    """Returns the part of what is in range that belongs to the seeds, and its voxels at them."""
    spacing = volume.spacing
    room = squared_distance_to(~in_range, spacing)
    starts = [_deepest(room, seed, spacing) for seed in seeds]
    widest = float(np.sqrt(max(room[start] for start in starts)))
    if widest == 0.0:
        return np.zeros_like(in_range), []
    # in a thin structure the ball must fit where the seed is
    passage = PASSAGE if how.passage is None else how.passage
    radius = min(0.5 * passage, 0.7 * widest)
    most = most_voxels(how.most_ml, volume.voxel_volume)
    while True:
        progress("following values from the seed", None)
        fits = ~within(room, radius)
        core = _connected(fits, [start for start in starts if fits[start]])
        if np.count_nonzero(core) <= most:
            region = in_range & margin(core, spacing, radius)
            if np.count_nonzero(region) <= most:
                break
        radius = max(radius * STEP, min(spacing))
        if 2.0 * radius > LARGEST_PASSAGE or radius >= widest:
            raise OptionError(
                f"the region becomes larger than {how.most_ml:g} ml; allowed: a smaller spread, "
                "wider passages that are not entered, or a larger volume"
            )
    return region, [start for start in starts if region[start]]


def _to_border(region: Mask, in_range: Mask, spacing: Sequence[float], *, fill: bool) -> Mask:
    """Adds what smoothing took from the border: unsmoothed values in range beside the region."""
    grown = region | (margin(region, spacing, BORDER) & in_range)
    return filled(closed(grown, spacing, max(spacing))) if fill else grown


def _deepest(
    room: NDArray[np.float32], seed: tuple[int, ...], spacing: Sequence[float]
) -> tuple[int, ...]:
    """Returns the voxel near a seed that is deepest in range."""
    box = _near(seed, spacing)
    part = room[box]
    found = np.unravel_index(int(part.argmax()), part.shape)
    return tuple(int(side.start + place) for side, place in zip(box, found, strict=True))


def _near(seed: tuple[int, ...], spacing: Sequence[float]) -> tuple[slice, ...]:
    """Returns the voxels that count as those of a seed, which may lie at a border."""
    sides = [whole_voxels(0.5 * NEIGHBOURHOOD, edge) for edge in reversed(spacing)]
    return tuple(
        slice(max(0, place - side), place + side + 1)
        for place, side in zip(seed, sides, strict=True)
    )


def _connected(mask: Mask, starts: list[tuple[int, ...]]) -> Mask:
    """Returns what of a mask hangs together with some of its voxels, over faces."""
    sitk = simpleitk()
    there = sitk.ConnectedThreshold(
        sitk.GetImageFromArray(mask.view(np.uint8)),
        seedList=[[int(c) for c in reversed(start)] for start in starts],
        lower=1,
        upper=1,
    )
    found: Mask = sitk.GetArrayFromImage(there) != 0
    return found
