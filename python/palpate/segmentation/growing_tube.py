"""Tubes around a seed, such as the aorta: what goes on from the seed without a neck or a chamber.

Where a vessel opens into a chamber, or touches another vessel, no edge of values ends it, but its
width changes. Depths in what is in range have a maximum in each piece that is about as wide
throughout; the basins of a watershed of them are these pieces (Beucher and Meyer 1993). From the
seed's piece the tube goes on into a neighbour where the way there is not narrower than the
narrower one, nor the wider one much wider: so fronts that explode are stopped where airways and
vessels are traced (Mori et al., "Automated anatomical labeling of the bronchial branch", 2000;
Schlathölter et al., "Simultaneous segmentation and tree reconstruction of the airways", 2002).

Arrays are [z, y, x] of cells.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.base.simpleitk import simpleitk
from palpate.segmentation.growing_cells import Box, Cells, connected, eroded, grown_by
from palpate.segmentation.growing_choice import (
    Region,
    in_box,
    measured,
    seed_value,
    slopes_of,
    span_of,
    without_holes,
)
from palpate.segmentation.mask_shape import Mask, box_of

__all__ = ["is_tube", "tubes"]

HALVES = (0.043, 0.067, 0.107)
"""Halves of ranges that are tried, as shares of the scan's values without the outermost ones.

Narrower ones lose a tube's border and its far parts, where contrast agent is thinner.
"""
NECKS = (0.65, 0.7, 0.75, 0.8)
"""Depth between two pieces by that of the less deep one, from which they are one tube."""
WIDER = 1.6
"""Depth of a piece by that of its neighbour, above which it is a chamber, or a branch."""
SAME = 0.05
"""Pieces whose depths lie so near to that between them, as a logarithm, are one."""
BLUR = 0.7
"""Standard deviation of the Gaussian that takes the steps of cells from depths, in cells."""
BLURRED = 1.25 * BLUR
"""What the Gaussian takes from the depth on a tube's axis [cells]: the mean distance from it."""
LONG = 8.0
"""Length of a tube by its radius, at least."""


@dataclass(frozen=True)
class _Pieces:
    """Pieces of a mask, each about as wide throughout, and the ways between them."""

    numbers: NDArray[np.int64]
    """Of the piece that a cell is in; 0 is none."""
    depths: NDArray[np.float64]
    """Of pieces, by number [cells]."""
    first: NDArray[np.int64]
    second: NDArray[np.int64]
    """Pieces beside each other."""
    ways: NDArray[np.float64]
    """Depths of the ways between them [cells]."""

    def reached(self, start: int, neck: float) -> Mask:
        """Returns what of the mask is one tube with a piece."""
        less = np.minimum(self.depths[self.first], self.depths[self.second])
        more = np.maximum(self.depths[self.first], self.depths[self.second])
        open_ways = (self.ways >= neck * less) & (more <= WIDER * less)
        beside: dict[int, list[int]] = defaultdict(list)
        for one, other in zip(self.first[open_ways], self.second[open_ways], strict=True):
            beside[int(one)].append(int(other))
            beside[int(other)].append(int(one))
        found, left = {start}, [start]
        while left:
            new = [other for other in beside[left.pop()] if other not in found]
            found.update(new)
            left += new
        return np.isin(self.numbers, sorted(found))


def tubes(cells: Cells, *, most: int) -> list[Region]:
    """Returns the tubes of all ranges and necks that hold the seeds, of so many cells at most."""
    middle = seed_value(cells)
    span = span_of(cells, middle)
    found = [
        (mask, box, half)
        for half in (share * span for share in HALVES)
        for mask, box in _masks(cells, middle - half, middle + half)
        if np.count_nonzero(mask) <= most
    ]
    slopes = slopes_of(cells.values, [box for _, box, _ in found])
    return [measured(mask, box, slopes, half=half) for mask, box, half in found]


def _masks(cells: Cells, low: float, high: float) -> Iterator[tuple[Mask, Box]]:
    """Yields the tubes of a range of values that hold the seeds, for all necks, in their boxes."""
    there = connected((cells.values >= low) & (cells.values <= high), list(cells.seeds))
    if not all(there[seed] for seed in cells.seeds):
        return
    box = box_of(there)
    pieces = _pieces(without_holes(there[box]))
    seeds = [
        tuple(place - side.start for place, side in zip(seed, box, strict=True))
        for seed in cells.seeds
    ]
    for neck in NECKS:
        mask = _without_films(pieces.reached(int(pieces.numbers[seeds[0]]), neck), seeds)
        if all(mask[seed] for seed in seeds):
            yield in_box(mask, box)


def _without_films(mask: Mask, seeds: list[tuple[int, ...]]) -> Mask:
    """Returns a mask without what is no more than two cells thick, such as rims of other bodies."""
    fits = eroded(mask, 0)
    return grown_by(connected(fits, seeds), 0) & mask


def is_tube(region: Region) -> bool:
    """Returns whether a region is long for its width."""
    return region.count >= LONG * math.pi * region.depth**3


def _pieces(mask: Mask) -> _Pieces:
    """Returns the pieces of a mask."""
    sitk = simpleitk()
    padded = np.pad(mask, 1)
    depth = sitk.DiscreteGaussian(
        sitk.SignedMaurerDistanceMap(
            sitk.GetImageFromArray(padded.view(np.uint8)),
            insideIsPositive=True,
            squaredDistance=False,
        ),
        [BLUR**2] * 3,
        32,
        [0.02] * 3,
    )
    depths = sitk.GetArrayFromImage(depth) + (0.5 + BLURRED)
    heights = np.where(padded, -np.log(np.maximum(depths, 0.5)), 1.0).astype(np.float32)
    basins = sitk.GetArrayFromImage(
        sitk.MorphologicalWatershed(sitk.GetImageFromArray(heights), SAME, False, False)  # noqa: FBT003
    )
    inner = (slice(1, -1),) * 3
    numbers = np.where(mask, basins[inner], 0).astype(np.int64)
    depths = depths[inner]
    of_pieces = np.zeros(int(numbers.max()) + 1)
    np.maximum.at(of_pieces, numbers[mask], depths[mask])
    return _Pieces(numbers, of_pieces, *_ways(numbers, depths))


def _ways(
    numbers: NDArray[np.int64], depths: NDArray[np.float32]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
    """Returns pieces beside each other, and the greatest depths of their common faces."""
    count = int(numbers.max()) + 1
    pairs, faces = [], []
    for axis in range(3):
        own, its = (np.moveaxis(numbers, axis, 0)[part] for part in (np.s_[:-1], np.s_[1:]))
        here, there = (np.moveaxis(depths, axis, 0)[part] for part in (np.s_[:-1], np.s_[1:]))
        meet = (own != its) & (own > 0) & (its > 0)
        pairs.append(np.minimum(own, its)[meet] * count + np.maximum(own, its)[meet])
        faces.append(np.minimum(here, there)[meet])
    keys, places = np.unique(np.concatenate(pairs), return_inverse=True)
    ways = np.zeros(len(keys))
    np.maximum.at(ways, places, np.concatenate(faces))
    return keys // count, keys % count, ways
