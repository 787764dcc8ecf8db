"""The gap between two segments."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Gap"]


@dataclass(frozen=True)
class Gap:
    """How far the surface of one segment is from another one, and by how much they overlap."""

    minimum: float
    """Where they are nearest [mm]; 0 where they overlap. Right to half a voxel."""
    mean: float
    """Over the surface of the first, weighted by area [mm]; what lies inside counts as 0."""
    overlap: float
    """Volume of the voxels of the first whose middles lie in the second [mm³]."""
