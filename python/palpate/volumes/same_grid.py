"""How far the same voxels of two grids lie apart."""

from __future__ import annotations

import numpy as np

from palpate.volumes.volume import Volume

__all__ = ["distance_of_grids", "lie_together"]

ROUNDED = 0.01
"""Up to which part of a voxel grids count as the same: headers are rounded."""


def distance_of_grids(first: Volume, second: Volume) -> float:
    """Returns how far the corners of two grids of the same size lie apart, at most [mm]."""
    ends = np.array(np.meshgrid(*([0.0, float(count)] for count in first.dimensions)))
    corners = np.vstack([ends.reshape(3, -1), np.ones(8)])
    apart = (first.patient_from_grid - second.patient_from_grid) @ corners
    return float(np.linalg.norm(apart[:3], axis=0).max())


def lie_together(first: Volume, second: Volume) -> bool:
    """Says whether two grids are the same, but for the rounding of headers."""
    if first.dimensions != second.dimensions:
        return False
    return distance_of_grids(first, second) <= ROUNDED * min(first.spacing)
