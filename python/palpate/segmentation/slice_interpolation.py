"""What lies between painted slices, from their shapes.

Source: S. P. Raya and J. K. Udupa, "Shape-based interpolation of multidimensional objects", 1990.
In each painted slice every voxel has its distance to the border, below 0 inside; between two of
them distances are weighed by how near each is, and what comes out below 0 is solid.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from palpate.segmentation.lengths_in_voxels import SAME
from palpate.segmentation.mask_shape import Mask, box_of, distance_to

__all__ = ["between_slices"]


def between_slices(mask: Mask, spacing: Sequence[float]) -> Mask:
    """Fills empty slices between painted ones; painted ones stay as they are.

    Slices lie across the axis that has most empty ones between its first and last painted one.

    Args:
        mask: What was painted, shape [z, y, x].
        spacing: Along x, y, z [mm].
    """
    box = box_of(mask)
    filled = mask.copy()
    part = filled[box]
    if part.size == 0:
        return filled
    axis = max(range(3), key=lambda each: len(_gaps(part, each)))
    edges = [edge for other, edge in enumerate(reversed(spacing)) if other != axis]
    slices = np.moveaxis(part, axis, 0)
    painted = _painted(part, axis)
    distances = {k: _signed(slices[k], edges) for k in painted}
    smallest = min(edges)
    for low, high in pairwise(painted):
        for k in range(low + 1, high):
            # whole shares of double precision: both sides of a middle slice are treated alike
            weighed = (high - k) * distances[low] + (k - low) * distances[high]
            slices[k] = weighed < -SAME * (high - low) * smallest
    return filled


def _painted(part: Mask, axis: int) -> list[int]:
    """Returns which slices across an axis hold something."""
    others = tuple(other for other in range(3) if other != axis)
    return [int(k) for k in np.flatnonzero(part.any(axis=others))]


def _gaps(part: Mask, axis: int) -> set[int]:
    """Returns which slices across an axis are empty between painted ones."""
    painted = _painted(part, axis)
    return set(range(painted[0], painted[-1])) - set(painted)


def _signed(drawn: Mask, edges: Sequence[float]) -> NDArray[np.float64]:
    """Returns the distance of each voxel of a slice to the border, below 0 inside [mm].

    ``edges`` are its voxels' sides along its rows and columns.
    """
    # what lies beyond the part is free, so that there is a border in any case
    layer = np.pad(drawn, 1)[None]
    spacing = (edges[1], edges[0], 1.0)
    outside, inside = (distance_to(one, spacing) for one in (layer, ~layer))
    signed = outside.astype(np.float64) - inside
    return signed[0, 1:-1, 1:-1]
