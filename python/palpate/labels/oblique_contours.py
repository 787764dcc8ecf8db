"""Contours whose planes lie aslant to the slices of a scan: filled there, looked up from the scan.

Each voxel of the scan takes what is at its centre: inside or outside of the contours in the nearest
plane, as long as planes are as far apart as they usually are.

Frame: contours in LPS [mm]; ``across``, ``down`` and ``height`` are lengths along two directions in
their planes and from plane to plane [mm].
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from palpate.volumes.polygon_fill import fill_polygons
from palpate.volumes.volume import Volume

__all__ = ["NotFlatError", "filled_aslant"]

FLAT = 0.1
"""By how much a contour may leave its plane [smallest voxel's edge]."""
DIGITS = 2
"""After the point, to which heights [mm] are the same."""

Polygon = NDArray[np.float64]
"""Corners, shape [corners, 3]."""


class NotFlatError(ValueError):
    """A contour lies in no plane, or not in one that is parallel to the others'."""


def filled_aslant(polygons: list[Polygon], volume: Volume) -> NDArray[np.uint8]:
    """Returns 1 for the voxels whose middles contours enclose, shape as the scan's.

    Raises:
        NotFlatError: They lie in no parallel planes.
    """
    pixel = min(volume.spacing)
    planes_from_patient = _planes_from_patient(polygons)
    placed = [corners @ planes_from_patient.T for corners in polygons]
    if max(np.ptp(corners[:, 2]) for corners in placed) > FLAT * pixel:
        raise NotFlatError
    heights = np.array([corners[:, 2].mean() for corners in placed])
    planes, of_plane = np.unique(np.round(heights, DIGITS), return_inverse=True)
    step = float(np.median(np.diff(planes))) if len(planes) > 1 else 0.0
    reach = 0.5 * max(step, pixel)

    # what contours enclose, plane by plane
    corners = np.concatenate(placed)[:, :2]
    low = corners.min(axis=0)
    columns, rows = (np.ceil(np.ptp(corners, axis=0) / pixel) + 1).astype(int)
    sheets = np.stack(
        [
            fill_polygons(
                [(placed[one][:, :2] - low) / pixel for one in np.flatnonzero(of_plane == number)],
                (rows, columns),
            )
            for number in range(len(planes))
        ]
    )

    # what is at the middles of the scan's voxels
    mask = np.zeros(volume.shape, np.uint8)
    matrix = planes_from_patient @ volume.patient_from_grid[:3]
    box = _box(polygons, volume, reach)
    x, y = (np.arange(side.start, side.stop) + 0.5 for side in box[:2])
    halves = 0.5 * (planes[1:] + planes[:-1])
    for z in range(box[2].start, box[2].stop):
        across, down, height = (
            row[0] * x[None, :] + row[1] * y[:, None] + row[2] * (z + 0.5) + row[3]
            for row in matrix
        )
        # half-way between two planes belongs to both: the first counts
        nearest = np.searchsorted(halves, height)
        column = np.rint((across - low[0]) / pixel).astype(int)
        row_ = np.rint((down - low[1]) / pixel).astype(int)
        there = np.abs(height - planes[nearest]) <= reach + 1e-6
        there &= (column >= 0) & (column < columns) & (row_ >= 0) & (row_ < rows)
        slab = mask[z, box[1], box[0]]
        slab[there] = sheets[nearest[there], row_[there], column[there]]
    return mask


def _planes_from_patient(polygons: list[Polygon]) -> NDArray[np.float64]:
    """Returns the directions across, down and from plane to plane of contours, shape [3, 3]."""
    # twice the area of each, along its normal (Newell)
    areas = [
        np.cross(corners - corners[0], np.roll(corners, -1, axis=0) - corners[0]).sum(axis=0)
        for corners in polygons
    ]
    largest = max(areas, key=lambda area: float(np.linalg.norm(area)))
    size = float(np.linalg.norm(largest))
    if size == 0.0:
        raise NotFlatError
    normal = largest / size
    across = np.cross(np.eye(3)[int(np.argmin(np.abs(normal)))], normal)
    across /= np.linalg.norm(across)
    return np.stack([across, np.cross(normal, across), normal])


def _box(polygons: list[Polygon], volume: Volume, reach: float) -> list[slice]:
    """Returns where contours reach in the scan, along x, y, z."""
    grid_from_patient = np.linalg.inv(volume.patient_from_grid)
    corners = np.concatenate(polygons) @ grid_from_patient[:3, :3].T + grid_from_patient[:3, 3]
    margin = reach / np.array(volume.spacing) + 1.0
    ends = zip(corners.min(axis=0) - margin, corners.max(axis=0) + margin, strict=True)
    return [
        slice(*(int(end) for end in np.clip((np.floor(low), np.ceil(high)), 0, count)))
        for (low, high), count in zip(ends, volume.dimensions, strict=True)
    ]
