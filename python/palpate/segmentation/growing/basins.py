"""Basins of depths in a mask: each cell belongs to the summit that is reached by going deeper.

A watershed (Beucher and Meyer 1993) by steepest ascent, cell by cell over faces. Summits whose
depth is nearly that of the way to a deeper one are no summits of their own (their dynamics, Najman
and Schmitt, "Geodesic saliency of watershed contours", 1996).

Arrays are [z, y, x] of cells.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from palpate.segmentation.mask_shape import Mask

__all__ = ["Basins", "basins_of"]


class Ways(NamedTuple):
    """Pairs of basins beside each other."""

    first: NDArray[np.int64]
    second: NDArray[np.int64]
    """Their numbers, the second ones larger."""
    depths: NDArray[np.float64]
    """The greatest depth of a face between them."""


@dataclass(frozen=True)
class Basins:
    """Basins of a mask, and the ways between them."""

    numbers: NDArray[np.int32]
    """Of the basin that a cell is in, from 1 on; 0 is none."""
    depths: NDArray[np.float64]
    """Of summits, by number."""
    ways: Ways


def basins_of(depths: NDArray[np.float32], mask: Mask, *, same: float) -> Basins:
    """Returns the basins of depths above 0 in a mask.

    Basins are one where the way between them is at least ``same`` of the less deep one.
    """
    numbers, heights = _ascents(depths, mask)
    ways = _ways(numbers, depths, len(heights))
    roots, new = np.unique(_joined(heights, ways, same=same), return_inverse=True)
    numbers = np.where(mask, new[numbers], 0).astype(np.int32)
    ways = _once(Ways(new[ways.first], new[ways.second], ways.depths), len(roots))
    return Basins(numbers, heights[roots], ways)


def _ascents(
    depths: NDArray[np.float32], mask: Mask
) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """Returns the summit that steepest ascent leads to, and depths of summits, from 1 on."""
    cells = np.flatnonzero(mask)
    compact = np.zeros(mask.size, np.int32)
    compact[cells] = np.arange(1, cells.size + 1, dtype=np.int32)
    inside = np.where(mask, depths, np.float32(-np.inf))
    best, leads = inside.copy(), compact.reshape(mask.shape).copy()
    own = leads.copy()
    for axis in range(3):
        for ahead in (slice(None, -1), slice(1, None)):
            beside = slice(1, None) if ahead.start is None else slice(None, -1)
            here, there = ((slice(None),) * axis + (part,) for part in (ahead, beside))
            deeper = inside[there] > best[here]
            if ahead.start is None:
                # of equal ones the next counts, so that a plateau has one summit along an axis
                deeper |= (inside[there] == best[here]) & (leads[here] == own[here]) & mask[here]
            best[here][deeper] = inside[there][deeper]
            leads[here][deeper] = own[there][deeper]
    parents = np.concatenate([[0], leads.ravel()[cells]])
    while True:
        further = parents[parents]
        if np.array_equal(further, parents):
            break
        parents = further
    summits, numbers = np.unique(parents, return_inverse=True)
    heights = np.concatenate([[0.0], depths.ravel()[cells][summits[1:] - 1]])
    found = np.zeros(mask.size, np.int32)
    found[cells] = numbers[1:]
    return found.reshape(mask.shape), heights


def _ways(numbers: NDArray[np.int32], depths: NDArray[np.float32], count: int) -> Ways:
    """Returns the ways between basins, whose numbers are below ``count``."""
    parts = []
    for axis in range(3):
        one, other = ((slice(None),) * axis + (part,) for part in (slice(None, -1), slice(1, None)))
        own, its = numbers[one], numbers[other]
        meet = (own != its) & (own > 0) & (its > 0)
        parts.append((own[meet], its[meet], np.minimum(depths[one][meet], depths[other][meet])))
    first, second, faces = (np.concatenate(each) for each in zip(*parts, strict=True))
    return _once(Ways(first.astype(np.int64), second.astype(np.int64), faces), count)


def _once(ways: Ways, count: int) -> Ways:
    """Returns each pair of different basins once, with the deepest of its ways."""
    low, high = np.minimum(ways.first, ways.second), np.maximum(ways.first, ways.second)
    keys = low * count + high
    order = np.lexsort((-ways.depths, keys))
    order = order[low[order] != high[order]]
    keys = keys[order]
    kept = np.flatnonzero(np.diff(keys, prepend=-1))
    return Ways(keys[kept] // count, keys[kept] % count, ways.depths[order][kept].astype(float))


def _joined(heights: NDArray[np.float64], ways: Ways, *, same: float) -> NDArray[np.int64]:
    """Returns for each summit the one that it is one with: the deepest, over the deepest ways."""
    roots = list(range(len(heights)))
    tops = heights.tolist()

    def root(one: int) -> int:
        while roots[one] != one:
            roots[one] = roots[roots[one]]
            one = roots[one]
        return one

    # summits of joined basins only become deeper
    least = same * np.minimum(heights[ways.first], heights[ways.second])
    near = np.flatnonzero(ways.depths >= least)
    for place in near[np.argsort(-ways.depths[near], kind="stable")].tolist():
        one, other = root(int(ways.first[place])), root(int(ways.second[place]))
        less, more = sorted((one, other), key=lambda number: (tops[number], number))
        if less != more and ways.depths[place] >= same * tops[less]:
            roots[less] = more
    return np.array([root(one) for one in range(len(roots))], np.int64)
