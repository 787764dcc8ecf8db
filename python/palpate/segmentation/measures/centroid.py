"""The centroid of a mask."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from palpate.volumes.volume import Volume

__all__ = ["centroid_of"]


def centroid_of(
    mask: NDArray[np.bool_], grid: Volume, *, low: tuple[int, int, int] = (0, 0, 0)
) -> tuple[float, float, float]:
    """Returns the mean of the centres of voxels, patient, LPS [mm].

    Args:
        mask: Not empty, of a part of the grid, shape [depth, height, width].
        grid: The grid.
        low: Its voxel at which the mask begins, x, y, z.
    """
    in_grid = []
    for axis, first in zip((2, 1, 0), low, strict=True):
        counts = np.count_nonzero(mask, axis=tuple({0, 1, 2} - {axis}))
        along = np.arange(len(counts)) + first + 0.5
        in_grid.append(float(counts @ along) / float(counts.sum()))
    x, y, z, _ = (grid.patient_from_grid @ [*in_grid, 1.0]).tolist()
    return x, y, z
