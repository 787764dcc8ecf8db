"""Basins of depths in a mask: each cell belongs to the summit that is reached by going deeper.

A watershed (Beucher and Meyer 1993) by steepest ascent, cell by cell over faces; summits whose depth
is nearly that of the way to a deeper one are no summits of their own (Najman and Schmitt, "Geodesic
saliency of watershed contours", 1996, whose dynamics these are).

Arrays are [z, y, x] of cells.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.segmentation.mask_shape import Mask

__all__ = ["Basins", "basins_of"]


@dataclass(frozen=True)
class Basins:
    """Basins of a mask, and the ways between them."""

    numbers: NDArray[np.int32]
    """Of the basin that a cell is in, from 1 on; 0 is none."""
    depths: NDArray[np.float64]
    """Of summits, by number."""
    first: NDArray[np.int64]
    second: NDArray[np.int64]
    """Basins beside each other."""
    ways: NDArray[np.float64]
    """Depths of the ways between them."""


def basins_of(depths: NDArray[np.float32], mask: Mask, *, same: float) -> Basins:
    """Returns the basins of depths above 0 in a mask.

    Basins are one where the way between them is at least ``same`` of the less deep one.
    """
    numbers, heights = _ascents(depths, mask)
    first, second, ways = _ways(numbers, depths, len(heights))
    joined = _joined(heights, first, second, ways, same=same)
    roots, new = np.unique(joined, return_inverse=True)
    numbers = np.where(mask, new[numbers], 0).astype(np.int32)
    first, second, ways = _ways_of(new[first], new[second], ways, len(roots))
    return Basins(numbers, heights[roots], first, second, ways)


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


def _ways(
    numbers: NDArray[np.int32], depths: NDArray[np.float32], count: int
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
    """Returns basins beside each other, and the greatest depths of their common faces."""
    firsts, seconds, faces = [], [], []
    for axis in range(3):
        one, other = ((slice(None),) * axis + (part,) for part in (slice(None, -1), slice(1, None)))
        own, its = numbers[one], numbers[other]
        meet = np.flatnonzero((own != its) & (own > 0) & (its > 0))
        firsts.append(own.reshape(-1)[meet])
        seconds.append(its.reshape(-1)[meet])
        faces.append(
            np.minimum(depths[one].reshape(-1)[meet], depths[other].reshape(-1)[meet])
        )
    return _ways_of(np.concatenate(firsts), np.concatenate(seconds), np.concatenate(faces), count)


def _ways_of(
    firsts: NDArray[np.int64], seconds: NDArray[np.int64], faces: NDArray[np.float64], count: int
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
    """Returns pairs of different basins once, with the greatest depths between them."""
    low, high = np.minimum(firsts, seconds), np.maximum(firsts, seconds)
    keys = low.astype(np.int64) * count + high
    order = np.lexsort((-faces, keys))
    order = order[low[order] != high[order]]
    keys = keys[order]
    kept = np.flatnonzero(np.diff(keys, prepend=-1))
    keys = keys[kept]
    return keys // count, keys % count, faces[order][kept].astype(np.float64)


def _joined(
    heights: NDArray[np.float64],
    first: NDArray[np.int64],
    second: NDArray[np.int64],
    ways: NDArray[np.float64],
    *,
    same: float,
) -> NDArray[np.int64]:
    """Returns for each summit the one that it is one with: the deepest, over the deepest ways."""
    roots = list(range(len(heights)))
    tops = heights.tolist()

    def root(one: int) -> int:
        while roots[one] != one:
            roots[one] = roots[roots[one]]
            one = roots[one]
        return one

    # summits of joined basins only become deeper
    near = np.flatnonzero(ways >= same * np.minimum(heights[first], heights[second]))
    for place in near[np.argsort(-ways[near], kind="stable")].tolist():
        one, other = root(int(first[place])), root(int(second[place]))
        less, more = sorted((one, other), key=lambda number: (tops[number], number))
        if less != more and ways[place] >= same * tops[less]:
            roots[less] = more
    return np.array([root(one) for one in range(len(roots))], np.int64)
