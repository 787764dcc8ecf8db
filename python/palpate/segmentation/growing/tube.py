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
from collections.abc import Callable, Iterator

import numpy as np

from palpate.base.simpleitk import simpleitk
from palpate.segmentation.growing.basins import Basins, basins_of
from palpate.segmentation.growing.cells import Box, Cells, blurred, connected, eroded, grown_by
from palpate.segmentation.growing.choice import (
    Found,
    Region,
    in_box,
    measured,
    seed_value,
    slopes_of,
    span_of,
    without_holes,
)
from palpate.segmentation.mask_shape import Mask, box_of
from palpate.segmentation.side_by_side import side_by_side

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


def _reached(pieces: Basins, start: int, neck: float) -> Mask:
    """Returns what is one tube with a piece."""
    ways = pieces.ways
    less = np.minimum(pieces.depths[ways.first], pieces.depths[ways.second])
    more = np.maximum(pieces.depths[ways.first], pieces.depths[ways.second])
    is_open = (ways.depths >= neck * less) & (more <= WIDER * less)
    beside: dict[int, list[int]] = defaultdict(list)
    for one, other in zip(ways.first[is_open], ways.second[is_open], strict=True):
        beside[int(one)].append(int(other))
        beside[int(other)].append(int(one))
    found, left = {start}, [start]
    while left:
        new = [other for other in beside[left.pop()] if other not in found]
        found.update(new)
        left += new
    is_one = np.zeros(len(pieces.depths), bool)
    is_one[list(found)] = True
    mask: Mask = is_one[pieces.numbers]
    return mask


def tubes(
    cells: Cells, *, most: int, told: Callable[[float], None] = lambda _: None
) -> list[Region]:
    """Returns the tubes of all ranges and necks that hold the seeds, of so many cells at most."""
    middle = seed_value(cells)
    span = span_of(cells, middle)

    def follow(half: float) -> list[Found]:
        tried = _masks(cells, middle - half, middle + half)
        found = [Found(mask, box, half) for mask, box in tried]
        return [one for one in found if one.count <= most]

    halves = [share * span for share in HALVES]
    found = [one for some in side_by_side(follow, halves, told=told) for one in some]
    slopes = slopes_of(cells.values, [one.box for one in found])
    return [measured(one, slopes) for one in found]


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
        mask = _without_films(_reached(pieces, int(pieces.numbers[seeds[0]]), neck), seeds)
        if all(mask[seed] for seed in seeds):
            yield in_box(mask, box)


def _without_films(mask: Mask, seeds: list[tuple[int, ...]]) -> Mask:
    """Returns a mask without what is no more than two cells thick, such as rims of other bodies."""
    fits = eroded(mask, 0)
    return grown_by(connected(fits, seeds), 0) & mask


def is_tube(region: Region) -> bool:
    """Returns whether a region is long for its width."""
    return region.count >= LONG * math.pi * region.depth**3


def _pieces(mask: Mask) -> Basins:
    """Returns the pieces of a mask, each about as wide throughout."""
    sitk = simpleitk()
    padded = np.pad(mask, 1)
    depth = sitk.SignedMaurerDistanceMap(
        sitk.GetImageFromArray(padded.view(np.uint8)), insideIsPositive=True, squaredDistance=False
    )
    depths = blurred(sitk.GetArrayFromImage(depth), BLUR**2, most_error=0.02)
    inner = depths[1:-1, 1:-1, 1:-1] + np.float32(0.5 + BLURRED)
    return basins_of(np.maximum(inner, np.float32(0.5)), mask, same=math.exp(-SAME))
