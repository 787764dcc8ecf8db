"""What lies inside of a loop that was drawn on the picture, right through or near the surface.

The loop is extruded along the lines of sight of an eye. A picture without perspective has its eye
far away: 10⁴ times as far as what is seen, so that its lines of sight are parallel but for less
than a hundredth of a millimetre.

A voxel belongs to the loop by its centre. The loop is filled in cells of a fraction of a voxel, so
that centres nearer to its border than half a cell may be taken for either side.

Frames: points are in the scene, LPS [mm]; masks are [z, y, x].
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.segmentation.mask_shape import Mask
from palpate.volumes.polygon_fill import fill_polygons
from palpate.volumes.volume import Volume

__all__ = ["Loop", "in_loop", "near_surface"]

Floats = NDArray[np.float64]
Triple = tuple[float, float, float]

CELLS_OF_A_VOXEL = 4
"""Cells of the filled loop along the smallest side of a voxel in the middle of the scan."""
MOST_CELLS = 4096
"""Cells of the filled loop along each axis."""
SURFACE_CELL = 1.5
"""Cells in which the first surface is looked for, in longest sides of a voxel: wider than gaps."""


@dataclass(frozen=True, kw_only=True)
class Loop:
    """A closed line on the picture seen from an eye, given by points of the scene below it."""

    line: Floats
    """Points in front of the eye, shape [count, 3]; three or more."""
    eye: Triple
    view: Triple
    """Direction of view, of any length but zero."""

    def sight(self, points: Floats) -> tuple[Floats, Floats, Floats]:
        """Returns where points are seen, as tangents across the view, and their depths [mm]."""
        forward = np.asarray(self.view) / np.linalg.norm(self.view)
        least = np.eye(3)[np.argmin(np.abs(forward))]
        across = np.cross(forward, least)
        across /= np.linalg.norm(across)
        offset = points - np.asarray(self.eye)
        depth = offset @ forward
        return offset @ across, offset @ np.cross(forward, across), depth


def in_loop(volume: Volume, loop: Loop) -> Mask:
    """Returns the voxels of a grid that are seen inside of a loop.

    Raises:
        OptionError: The loop has less than three points, or one that is not before the eye.
    """
    u, v, depth = loop.sight(loop.line)
    if len(loop.line) < 3 or not np.all(depth > 0.0):
        raise OptionError("no loop given; allowed: three points or more, all before the eye")
    corners = np.stack([u / depth, v / depth], axis=-1)
    low, size = corners.min(axis=0), np.ptp(corners, axis=0)
    voxel = min(volume.spacing) / _middle_depth(volume, loop)
    cell = max(voxel / CELLS_OF_A_VOXEL, float(size.max()) / MOST_CELLS)
    shape = np.ceil(size / cell).astype(int) + 1
    # a cell's integer place is its middle
    filled = fill_polygons([(corners - low) / cell], (int(shape[1]), int(shape[0])))
    inside = np.zeros(volume.shape, bool)
    for place, (seen_u, seen_v, far) in _slices(volume, loop):
        with np.errstate(divide="ignore", invalid="ignore"):
            column = np.rint((seen_u / far - low[0]) / cell)
            row = np.rint((seen_v / far - low[1]) / cell)
        there = (far > 0.0) & (column >= 0) & (column < shape[0]) & (row >= 0) & (row < shape[1])
        inside[place][there] = filled[row[there].astype(int), column[there].astype(int)] != 0
    return inside


def near_surface(volume: Volume, loop: Loop, matter: Mask, *, depth: float) -> Mask:
    """Returns the voxels that lie less than a depth behind the first matter that is seen there.

    Args:
        volume: The grid.
        loop: Whose eye sees it.
        matter: What has a surface.
        depth: Along the line of sight [mm].
    """
    cell = SURFACE_CELL * max(volume.spacing) / _middle_depth(volume, loop)
    lows, highs = [], []
    for place, (u, v, far) in _slices(volume, loop):
        solid = matter[place] & (far > 0.0)
        if solid.any():
            places = np.stack([u[solid] / far[solid], v[solid] / far[solid]])
            lows.append(places.min(axis=1))
            highs.append(places.max(axis=1))
    near = np.zeros(volume.shape, bool)
    if not lows:
        return near
    low = np.min(lows, axis=0)
    columns, rows = (np.ceil((np.max(highs, axis=0) - low) / cell).astype(int) + 1).tolist()
    nearest = np.full((rows, columns), np.inf)

    def cells(u: Floats, v: Floats, far: Floats) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        return (
            np.clip(np.rint((v / far - low[1]) / cell), 0, rows - 1).astype(int),
            np.clip(np.rint((u / far - low[0]) / cell), 0, columns - 1).astype(int),
        )

    for place, (u, v, far) in _slices(volume, loop):
        solid = matter[place] & (far > 0.0)
        seen = u[solid], v[solid], far[solid]
        np.minimum.at(nearest, cells(*seen), _distance(*seen))
    for place, (u, v, far) in _slices(volume, loop):
        before = far > 0.0
        seen = u[before], v[before], far[before]
        surface = nearest[cells(*seen)]
        near[place][before] = np.isfinite(surface) & (_distance(*seen) < surface + depth)
    return near


def _distance(u: Floats, v: Floats, depth: Floats) -> Floats:
    return np.asarray(np.sqrt(u * u + v * v + depth * depth), np.float64)


def _middle_depth(volume: Volume, loop: Loop) -> float:
    middle = np.append(np.array(volume.dimensions) / 2.0, 1.0)
    away = (volume.patient_from_grid @ middle)[:3] - np.asarray(loop.eye)
    return max(float(np.linalg.norm(away)), min(volume.spacing))


def _slices(volume: Volume, loop: Loop) -> Iterator[tuple[int, tuple[Floats, Floats, Floats]]]:
    """Gives slices of voxel centres: their place along z, and how they are seen, each [y, x]."""
    _, rows, columns = volume.shape
    matrix = volume.patient_from_grid
    ends = np.zeros((4, 3))
    ends[1:] = np.eye(3)
    at_ends = loop.sight((ends + 0.5) @ matrix[:3, :3].T + matrix[:3, 3])
    # sight is linear before the division by depth
    for place in range(volume.shape[0]):
        yield (
            place,
            tuple(
                first
                + (along_x - first) * np.arange(columns)
                + ((along_y - first) * np.arange(rows))[:, None]
                + (along_z - first) * place
                for first, along_x, along_y, along_z in at_ends
            ),
        )
