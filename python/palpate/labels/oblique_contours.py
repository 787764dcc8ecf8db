"""Contours whose planes lie aslant to the slices of a scan: filled there, looked up from the scan.

Each voxel of the scan takes what is at its centre. Between planes that is a shape between theirs
(``contour_stack``), in steps of the smallest voxel's edge.

Frame: contours in LPS [mm]; ``across``, ``down`` and ``height`` are lengths along two directions in
their planes and from plane to plane [mm].
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from palpate.labels.contour_fill import fill_contours
from palpate.labels.contour_stack import MOST_SLICES, ContourStack, planes_of
from palpate.labels.filled import Filled
from palpate.volumes.volume import Volume

__all__ = ["NotFlatError", "filled_aslant"]

FLAT = 0.1
"""By how much a contour may leave its plane [smallest voxel's edge]."""
ONE_PLANE = 0.02
"""Contours nearer than this lie in one plane [smallest voxel's edge]."""

Polygon = NDArray[np.float64]
"""Corners, shape [corners, 3]."""


class NotFlatError(ValueError):
    """A contour lies in no plane, or not in one that is parallel to the others'."""


def filled_aslant(polygons: list[Polygon], volume: Volume, *, exclusive: bool = False) -> Filled:
    """Fills the voxels whose middles contours enclose.

    Raises:
        NotFlatError: They lie in no parallel planes.
    """
    pixel = min(volume.spacing)
    planes_from_patient = _planes_from_patient(polygons)
    placed = [corners @ planes_from_patient.T for corners in polygons]
    if max(np.ptp(corners[:, 2]) for corners in placed) > FLAT * pixel:
        raise NotFlatError
    heights = np.array([corners[:, 2].mean() for corners in placed])
    planes, of_plane = planes_of(heights, least=ONE_PLANE * pixel)

    # what contours enclose, plane by plane, as far as the scan may reach
    scan = planes_from_patient @ volume.patient_from_grid[:3]
    low, high = _extent(placed, scan, volume)
    columns, rows = (int(length) for length in np.ceil((high - low) / pixel) + 1)
    sheets = np.stack(
        [
            fill_contours(
                [(placed[one][:, :2] - low) / pixel for one in np.flatnonzero(of_plane == number)],
                (rows, columns),
                exclusive=exclusive,
            )
            for number in range(len(planes))
        ]
    )
    widest = MOST_SLICES * max(volume.spacing)
    stack = ContourStack(planes, sheets, pixel=(pixel, pixel), thickness=pixel, widest=widest)
    mask = _looked_up(stack, low, volume, scan=scan, box=_box(polygons, volume, stack))
    bridged, left = stack.missing()
    return Filled(mask=mask, bridged=bridged, left=left)


def _looked_up(
    stack: ContourStack,
    low: NDArray[np.float64],
    volume: Volume,
    *,
    scan: NDArray[np.float64],
    box: list[slice],
) -> NDArray[np.uint8]:
    """Returns what is at the middles of the scan's voxels.

    Args:
        stack: What contours enclose.
        low: Across and down, where the stack's sheets begin [mm].
        volume: The scan.
        scan: From its grid to across, down and height, shape [3, 4].
        box: Where contours reach in it, along x, y, z.
    """
    pixel = stack.pixel[0]
    bottom, top = stack.ends
    layers = max(1, math.ceil((top - bottom) / pixel))
    thick = (top - bottom) / layers
    empty = np.zeros(stack.sheets.shape[1:], np.uint8)
    found = (stack.at(bottom + (layer + 0.5) * thick) for layer in range(layers))
    sheets = np.stack([empty if sheet is None else sheet for sheet in found])

    mask = np.zeros(volume.shape, np.uint8)
    _, rows, columns = sheets.shape
    x, y = (np.arange(side.start, side.stop) + 0.5 for side in box[:2])
    for z in range(box[2].start, box[2].stop):
        across, down, height = (
            row[0] * x[None, :] + row[1] * y[:, None] + row[2] * (z + 0.5) + row[3] for row in scan
        )
        layer = np.floor((height - bottom) / thick).astype(int)
        column = np.rint((across - low[0]) / pixel).astype(int)
        row_ = np.rint((down - low[1]) / pixel).astype(int)
        there = (layer >= 0) & (layer < layers)
        there &= (column >= 0) & (column < columns) & (row_ >= 0) & (row_ < rows)
        slab = mask[z, box[1], box[0]]
        slab[there] = sheets[layer[there], row_[there], column[there]]
    return mask


def _extent(
    placed: list[Polygon], scan: NDArray[np.float64], volume: Volume
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns where contours begin and end across and down, as far as the scan may reach [mm]."""
    corners = np.concatenate(placed)[:, :2]
    ends = np.array(np.meshgrid(*([0.0, float(count)] for count in volume.dimensions)))
    reach = (scan[:2, :3] @ ends.reshape(3, -1) + scan[:2, 3:]).T
    low = np.clip(corners.min(axis=0), reach.min(axis=0), reach.max(axis=0))
    high = np.clip(corners.max(axis=0), low, reach.max(axis=0))
    return low, high


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


def _box(polygons: list[Polygon], volume: Volume, stack: ContourStack) -> list[slice]:
    """Returns where contours reach in the scan, along x, y, z."""
    low, high = stack.ends
    reach = max(stack.planes[0] - low, high - stack.planes[-1])
    grid_from_patient = np.linalg.inv(volume.patient_from_grid)
    corners = np.concatenate(polygons) @ grid_from_patient[:3, :3].T + grid_from_patient[:3, 3]
    margin = reach / np.array(volume.spacing) + 1.0
    ends = zip(corners.min(axis=0) - margin, corners.max(axis=0) + margin, strict=True)
    return [
        slice(*(int(end) for end in np.clip((np.floor(first), np.ceil(last)), 0, count)))
        for (first, last), count in zip(ends, volume.dimensions, strict=True)
    ]
