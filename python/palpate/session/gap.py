"""The gap between two segments."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Gap"]


@dataclass(frozen=True)
class Gap:
    """Distance of the surface of one segment from another segment, and their overlap."""

    minimum: float
    """Smallest distance [mm], accurate to half a voxel; 0 where they overlap."""
    mean: float
    """Mean distance over the surface of the first, weighted by area [mm]; points inside the other
    count as 0."""
    overlap: float
    """Volume of the voxels of the first whose centres lie in the other [mm³]."""
