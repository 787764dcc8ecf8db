"""Distances between the borders of two masks on one grid.

The border of a mask is its voxels with a face neighbour outside of it; beyond the grid is outside.
Distances run from each centre of a border voxel to the nearest one of the other border, exactly, by
a k-d tree: borders of organs are thousands of times fewer than voxels of a distance map.

Arrays are [z, y, x]. Source: Maier-Hein, Reinke et al., "Metrics reloaded: recommendations for
image analysis validation", Nature Methods 21 (2024): HD95 and ASSD.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from palpate.segmentation.mask_shape import box_of

__all__ = ["border_voxels", "surface_distances"]

Mask = NDArray[np.bool_]
Indices = NDArray[np.int64]


def surface_distances(
    first: Mask, second: Mask, spacing: Sequence[float]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns distances from the border of each mask to that of the other one [mm].

    Args:
        first: Not empty, shape [depth, height, width].
        second: Of the same grid, not empty.
        spacing: Edges of voxels along x, y, z [mm].
    """
    from scipy.spatial import cKDTree

    edges = np.asarray(spacing, np.float64)
    ends = tuple(border_voxels(mask) * edges for mask in (first, second))
    trees = cKDTree(ends[0]), cKDTree(ends[1])
    to_second, _ = trees[1].query(ends[0])
    to_first, _ = trees[0].query(ends[1])
    return to_second, to_first


def border_voxels(mask: Mask) -> Indices:
    """Returns the indices x, y, z of the border voxels of a mask, shape [count, 3]."""
    from scipy.ndimage import binary_erosion

    box = box_of(mask)
    inside = mask[box]
    # beyond the box and the grid is outside
    border = inside & ~binary_erosion(inside)
    return np.asarray((np.argwhere(border) + [part.start for part in box])[:, ::-1], np.int64)
