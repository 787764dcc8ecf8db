"""The live wire: the cheapest path from one point of a slice to another, which runs along edges.

Source: E. N. Mortensen and W. A. Barrett, "Intelligent scissors for image composition", 1995: a
step between neighbours costs what its end lacks of an edge (zero-crossing of the Laplacian, size of
the gradient) and what its direction deviates from those of the edge at both ends; Dijkstra's
algorithm finds the path (SciPy). Ours: costs count per mm, so that voxels need not be square.

Frame: patient [mm]; places in a slice as in ``scan_slice.py``.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.volumes.scan_slice import Point, ScanSlice
from palpate.volumes.volume import Volume

__all__ = ["LiveWire", "live_wire"]

ZERO_CROSSING, DIRECTION, GRADIENT = 0.43, 0.43, 0.14
"""Shares of a step's cost."""
LEAST = 0.01
"""Of a step on a perfect edge, so that a detour along it costs something too."""
STRONG = 0.99
"""Share of voxels in the window below the gradient that costs nothing."""
SNAP = 2
"""A point stands for the steepest voxel so near [voxels]."""
AROUND = 40
"""Voxels around both ends that a path may use."""
LARGEST = 512
"""Voxels along a side of the window, at most."""

Image = NDArray[np.float64]
Voxel = tuple[int, int]
"""Row and column."""


def live_wire(
    volume: Volume,
    points: Sequence[Point],
    *,
    normal: Sequence[float],
    closed: bool = True,
    smoothing: float | None = None,
) -> NDArray[np.float64]:
    """Returns the path along edges through points of a slice, shape [count, 3] [patient].

    Args:
        volume: The scan.
        points: Two or more, near the edge; the first one says which slice.
        normal: Of the slice, along an axis of the scan.
        closed: Whether the path goes back to the first point.
        smoothing: Standard deviation of the Gaussian under which edges are looked for [mm]; by
            default a voxel's shorter side.

    Raises:
        OptionError: There are fewer points, one is not in the scan, too far from the one before,
            or the slice lies along no axis of the scan.
    """
    if len(points) < 2:
        raise OptionError(f"{len(points)} points given; allowed: two or more")
    where = ScanSlice.through(volume, points[0], normal=normal)
    ends = [*points, points[0]] if closed else list(points)
    pieces = [LiveWire(where, begin, smoothing=smoothing).to(end) for begin, end in pairwise(ends)]
    return np.concatenate([pieces[0], *(piece[1:] for piece in pieces[1:])])


class LiveWire:
    """All cheapest paths from one point of a slice: those to other points are found at once."""

    def __init__(self, where: ScanSlice, begin: Point, *, smoothing: float | None = None) -> None:
        """Begins at a point, which stands for the steepest voxel beside it.

        Raises:
            OptionError: The smoothing is out of range, or the point is not in the scan.
        """
        self.where = where
        self._smoothing = min(where.edges) if smoothing is None else smoothing
        if not 0.0 < self._smoothing <= 20.0:
            raise OptionError(
                f"smoothing of {self._smoothing:g} mm given; allowed: more than 0, up to 20 mm"
            )
        self._first = self._voxel(begin)
        self._window = (slice(0, 0), slice(0, 0))
        self._before = np.zeros(0, np.int32)
        self._steepness: Image = np.zeros((0, 0))

    def to(self, end: Point) -> NDArray[np.float64]:
        """Returns the path to a point, shape [count, 3] [patient].

        Raises:
            OptionError: It is not in the scan, or too far away.
        """
        last = self._voxel(end)
        if not self._holds(last):
            self._look_around(last)
        rows, columns = self._window
        low = np.array([rows.start, columns.start])
        width = columns.stop - columns.start
        first, place = (
            int(np.ravel_multi_index(tuple(self._snapped(voxel) - low), self._steepness.shape))
            for voxel in (self._first, last)
        )
        path = [place]
        while place != first:
            place = int(self._before[place])
            path.append(place)
        at = np.array([divmod(place, width) for place in reversed(path)]) + low
        return self.where.points(at[:, ::-1])

    def _voxel(self, point: Point) -> Voxel:
        column, row = np.floor(self.where.places([point])[0] + 0.5).astype(int)
        rows, columns = self.where.shape
        if not (0 <= row < rows and 0 <= column < columns):
            raise OptionError(f"point {tuple(point)} given; allowed: a point in the scan")
        return int(row), int(column)

    def _holds(self, voxel: Voxel) -> bool:
        sides = zip(voxel, self._window, self.where.shape, strict=True)
        return all(
            side.start <= max(0, c - SNAP) and min(count, c + SNAP + 1) <= side.stop
            for c, side, count in sides
        )

    def _look_around(self, last: Voxel) -> None:
        """Finds all paths from the first voxel in a window that holds another one."""
        from scipy.sparse.csgraph import dijkstra

        low = np.maximum(np.minimum(self._first, last) - AROUND, 0)
        high = np.minimum(np.maximum(self._first, last) + AROUND + 1, self.where.shape)
        if (high - low).max() > LARGEST:
            raise OptionError(
                f"points {np.abs(np.subtract(last, self._first)).max()} voxels apart given; "
                f"allowed: up to {LARGEST - 2 * AROUND}: set one between them"
            )
        self._window = (slice(low[0], high[0]), slice(low[1], high[1]))
        image = self._smoothed()
        edges = self.where.edges
        slope = [np.gradient(image, edge, axis=axis) for axis, edge in enumerate(edges)]
        self._steepness = np.hypot(*slope)
        costs = _costs(image, slope, edges)
        first = np.ravel_multi_index(tuple(self._snapped(self._first) - low), self._steepness.shape)
        _, self._before = dijkstra(costs, indices=int(first), return_predecessors=True)

    def _smoothed(self) -> Image:
        """Returns the window under a Gaussian, as wide as it has voxels."""
        from scipy.ndimage import gaussian_filter

        values = self.where.values[self._window].astype(np.float64)
        image: Image = gaussian_filter(
            values, [self._smoothing / edge for edge in self.where.edges], mode="nearest"
        )
        return image

    def _snapped(self, voxel: Voxel) -> NDArray[np.int64]:
        """Returns the steepest voxel near one that the window holds."""
        low = np.array([side.start for side in self._window])
        from_row, from_column = np.maximum(np.array(voxel) - low - SNAP, 0)
        row, column = np.array(voxel) - low + SNAP + 1
        near = self._steepness[from_row:row, from_column:column]
        steepest = np.unravel_index(int(near.argmax()), near.shape)
        snapped: NDArray[np.int64] = np.add(steepest, (from_row, from_column)) + low
        return snapped


def _costs(image: Image, slope: Sequence[Image], edges: Sequence[float]) -> object:
    """Returns what each step between neighbours of an image costs, as a sparse matrix."""
    from scipy.sparse import coo_array

    size = np.hypot(*slope)
    strong = max(float(np.quantile(size, STRONG)), np.finfo(float).tiny)
    lacks = ZERO_CROSSING * ~_crossings(image, edges) + GRADIENT * (
        1.0 - np.minimum(size / strong, 1.0)
    )
    # along the edge: across the gradient, in mm along rows and columns
    along = np.stack([slope[1], -slope[0]]) / np.maximum(size, np.finfo(float).tiny)
    number = np.arange(image.size, dtype=np.int32).reshape(image.shape)
    begins, ends, costs = [], [], []
    for step in ((0, 1), (1, 0), (1, 1), (1, -1)):
        for here, there in (_pair(step, image.shape), _pair(step, image.shape)[::-1]):
            way = np.array(step) * edges
            length = float(np.linalg.norm(way))
            cosine = np.tensordot(way / length, along, axes=1)
            # the link is turned so that it goes with the edge where it begins
            turned = np.where(cosine[here] < 0.0, -1.0, 1.0)
            angles = np.arccos(np.clip([turned * cosine[here], turned * cosine[there]], -1.0, 1.0))
            begins.append(number[here].ravel())
            ends.append(number[there].ravel())
            cost = LEAST + lacks[there] + DIRECTION * angles.sum(axis=0) / np.pi
            costs.append((length * cost).ravel())
    joined = np.concatenate(costs), (np.concatenate(begins), np.concatenate(ends))
    return coo_array(joined, shape=(image.size, image.size)).tocsr()


def _pair(step: Voxel, shape: tuple[int, ...]) -> tuple[tuple[slice, slice], tuple[slice, slice]]:
    """Returns the voxels that have a neighbour a step further, and those neighbours."""
    here, there = [], []
    for by, count in zip(step, shape, strict=True):
        here.append(slice(max(0, -by), count - max(0, by)))
        there.append(slice(max(0, by), count + min(0, by)))
    return (here[0], here[1]), (there[0], there[1])


def _crossings(image: Image, edges: Sequence[float]) -> NDArray[np.bool_]:
    """Returns where the Laplacian changes its sign, at the voxel that is nearer to 0."""
    padded = np.pad(image, 1, mode="edge")
    middle = padded[1:-1, 1:-1]
    laplacian = (padded[2:, 1:-1] + padded[:-2, 1:-1] - 2.0 * middle) / edges[0] ** 2
    laplacian += (padded[1:-1, 2:] + padded[1:-1, :-2] - 2.0 * middle) / edges[1] ** 2
    found = np.zeros(image.shape, bool)
    for step in ((0, 1), (1, 0)):
        here, there = _pair(step, image.shape)
        changes = laplacian[here] * laplacian[there] < 0.0
        nearer = np.abs(laplacian[here]) <= np.abs(laplacian[there])
        found[here] |= changes & nearer
        found[there] |= changes & ~nearer
    return found
