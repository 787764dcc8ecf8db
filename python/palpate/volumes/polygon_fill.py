"""Voxels of a slice whose centres polygons enclose."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ["fill_polygons"]


def fill_polygons(
    polygons: Sequence[NDArray[np.float64]], shape: tuple[int, ...]
) -> NDArray[np.uint8]:
    """Fills polygons by the even-odd rule: a polygon inside another one is a hole.

    Args:
        polygons: Corners as (column, row), integers at the centres of voxels, shape [corners, 2].
        shape: Shape of the slice, [rows, columns].
    """
    rows, columns = shape
    toggles = np.zeros((rows, columns + 1), np.uint8)
    for corners in polygons:
        x0, y0 = corners.T
        x1, y1 = np.roll(corners, -1, axis=0).T
        # rows whose middles each edge passes: its lower end counts, its upper does not
        first = np.clip(np.ceil(np.minimum(y0, y1)), 0, rows).astype(int)
        count = np.clip(np.ceil(np.maximum(y0, y1)), 0, rows).astype(int) - first
        edge = np.repeat(np.arange(len(corners)), count)
        crossed = first[edge] + np.arange(len(edge)) - (np.cumsum(count) - count)[edge]
        share = (crossed - y0[edge]) / (y1 - y0)[edge]
        crossings = x0[edge] + share * (x1 - x0)[edge]
        # the first column whose middle lies beyond
        beyond = np.clip(np.ceil(crossings), 0, columns).astype(int)
        np.bitwise_xor.at(toggles, (crossed, beyond), 1)
    inside: NDArray[np.uint8] = np.bitwise_xor.accumulate(toggles, axis=1)[:, :columns]
    return inside
