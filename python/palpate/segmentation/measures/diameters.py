"""The largest diameters of a mask, exactly: in space, and within its axial slices.

A diameter (Feret, calliper length) is the largest distance between two points of the voxels, which
are boxes: it runs from corner to corner, so a single voxel has that of its diagonal, and a row of n
voxels is at least n voxels long. Between centres, as ITK measures, it is up to one voxel's diagonal
less.

Only voxels at vertices of the convex hull can be ends. A voxel is none where it is none of the hull
of the voxels in some plane through it; what is left after planes in several directions is compared
pair by pair, but for pairs that cannot be longer than one that was found.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ["axial_axis", "largest_diameters"]

Indices = NDArray[np.int64]

PLANES = (
    (0, 1, 0), (0, 0, 1), (1, 1, 0), (1, -1, 0), (1, 0, 1), (1, 0, -1), (0, 1, 1), (0, 1, -1),
    (1, 1, 1), (1, 1, -1), (1, -1, 1), (1, -1, -1),
)  # fmt: skip
"""Normals of planes in which voxels are looked at, beside slices."""

FEW = 500
"""Voxels that are quicker compared than looked at once more."""

CELLS = 16
"""Cells along the longest axis by which voxels are sorted, to compare only those far apart."""


def axial_axis(direction: NDArray[np.float64]) -> int:
    """Returns the axis of arrays [z, y, x] across which slices are nearest to axial.

    Args:
        direction: Axes of the grid in the patient (LPS) as columns, shape [3, 3].
    """
    return 2 - int(np.argmax(np.abs(direction[2])))


def largest_diameters(
    mask: NDArray[np.bool_], spacing: Sequence[float], *, axial: int
) -> tuple[float, float]:
    """Returns the largest diameter in space, and the largest within one axial slice [mm].

    Args:
        mask: Not empty, shape [depth, height, width].
        spacing: Edges of voxels along x, y, z [mm].
        axial: The axis of ``mask`` across which slices are axial.
    """
    slices = np.moveaxis(mask, axial, 0)
    edges = np.array(spacing[::-1])
    edges = np.concatenate([edges[[axial]], np.delete(edges, axial)])
    ends = _row_ends(slices)
    ends = ends[_on_hull(ends[:, 0], ends[:, 1], ends[:, 2])]
    parts = np.split(ends, np.flatnonzero(np.diff(ends[:, 0])) + 1)
    in_slices = max(_longest(part[:, 1:], edges[1:]) for part in parts)
    for normal in PLANES:
        if len(ends) <= FEW:
            break
        ends = _on_hull_in_planes(ends, normal)
    return _longest(ends, edges), in_slices


def _row_ends(mask: NDArray[np.bool_]) -> Indices:
    """Returns the first and the last voxel of each row along the last axis, shape [count, 3]."""
    first = np.argmax(mask, axis=2)
    last = mask.shape[2] - 1 - np.argmax(mask[:, :, ::-1], axis=2)
    slices, rows = np.nonzero(mask.any(axis=2))
    ends = [np.stack([slices, rows, end[slices, rows]], axis=1) for end in (first, last)]
    return np.concatenate(ends).astype(np.int64)


def _on_hull_in_planes(points: Indices, normal: tuple[int, int, int]) -> Indices:
    """Returns those points that are vertices of the hull of those in their plane."""
    # two coordinates tell the points of a plane apart if its normal is not 0 along the third
    left_out = next(axis for axis in (2, 1, 0) if normal[axis] != 0)
    u, v = (axis for axis in range(3) if axis != left_out)
    kept: Indices = points[_on_hull(points @ np.array(normal), points[:, u], points[:, v])]
    return kept


def _on_hull(plane: Indices, u: Indices, v: Indices) -> Indices:
    """Returns which points are vertices of the hull of those in their plane, plane by plane."""
    chains = [_upper_chain(plane, u, v), _upper_chain(plane, u, -v)]
    kept: Indices = np.unique(np.concatenate(chains))
    by_plane: Indices = kept[np.argsort(plane[kept], kind="stable")]
    return by_plane


def _upper_chain(plane: Indices, u: Indices, v: Indices) -> Indices:
    """Returns which points the upper side of the hull turns at, plane by plane."""
    order = np.lexsort((-v, u, plane))
    sorted_plane, sorted_u = plane[order], u[order]
    same = (np.diff(sorted_plane) == 0) & (np.diff(sorted_u) == 0)
    chain: Indices = order[np.concatenate([[True], ~same])]
    while True:
        # a point on or below the line between its neighbours is no vertex; many go at once
        p, x, y = plane[chain], u[chain], v[chain]
        turn = (x[1:-1] - x[:-2]) * (y[2:] - y[:-2]) - (y[1:-1] - y[:-2]) * (x[2:] - x[:-2])
        below = (p[:-2] == p[2:]) & (turn >= 0)
        if not below.any():
            return np.asarray(chain, np.int64)
        chain = chain[np.concatenate([[True], ~below, [True]])]


def _longest(voxels: Indices, edges: NDArray[np.float64]) -> float:
    """Returns the largest distance between corners of voxels [mm].

    Args:
        voxels: Indices, shape [count, axes].
        edges: Edges of voxels along these axes [mm].
    """
    cells = _cells(voxels)
    lows = np.array([cell.min(axis=0) for cell in cells])
    highs = np.array([cell.max(axis=0) for cell in cells])
    longest = 0.0
    # cells whose ends are farther apart than what was found are searched, the farthest first
    reach = sum(
        np.square((np.maximum(high[:, None] - low, high - low[:, None]) + 1) * edge)
        for low, high, edge in zip(lows.T, highs.T, edges, strict=True)
    )
    for index in np.argsort(-reach.max(axis=1)):
        far = np.flatnonzero(reach[index] > longest)
        if far.size:
            others = np.concatenate([cells[other] for other in far])
            longest = max(longest, _longest_square(cells[index], others, edges))
    return float(np.sqrt(longest))


def _cells(voxels: Indices) -> list[Indices]:
    """Returns voxels by the cell of a coarse grid in which they lie."""
    size = 1 + int(np.ptp(voxels, axis=0).max()) // CELLS
    keys = voxels // size
    order = np.lexsort(keys.T)
    borders = np.flatnonzero(np.diff(keys[order], axis=0).any(axis=1)) + 1
    return np.split(voxels[order], borders)


def _longest_square(voxels: Indices, others: Indices, edges: NDArray[np.float64]) -> float:
    """Returns the square of the largest distance between corners of voxels and others [mm²]."""
    squares = np.zeros((len(voxels), len(others)))
    for along, across, edge in zip(voxels.T, others.T, edges, strict=True):
        squares += np.square((np.abs(along[:, None] - across) + 1) * edge)
    return float(squares.max())
