"""Changes of the picture, as ``_core.Session`` returns them: typed dictionaries.

Places count voxels, or patches, along x, y, z; numbers are packed little-endian.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypedDict

__all__ = [
    "DisplacedField",
    "PictureChange",
    "SurfaceChange",
    "SurfacePatch",
    "VoxelChange",
]

Triple = tuple[float, float, float]
Place = tuple[int, int, int]


class VoxelChange(TypedDict):
    """Changed voxels: a box from ``low`` up to, but without, ``high``, x fastest."""

    low: Place
    high: Place
    stored: bytes | None
    """New stored values, int16; None where they did not change."""
    labels: bytes | None
    """New labels, uint8; None where they did not change."""


class SurfacePatch(TypedDict):
    """A piece of a surface; packed as in ``protocol.SurfacePatch``."""

    index: Place
    origin: Triple
    size: Triple
    vertices: bytes
    normals: bytes
    triangles: bytes


class SurfaceChange(TypedDict):
    """Changed patches of the surface of one segment."""

    id: int
    whole: bool
    """Whether ``patches`` replace the whole surface."""
    dropped: list[Place]
    """Indices of patches that no longer exist."""
    patches: list[SurfacePatch]


class DisplacedField(TypedDict):
    """Displacement of tissue from its voxels on a box of nodes; as ``protocol.Displaced``."""

    origin: Triple
    """First node [grid]."""
    step: Triple
    """Distance of nodes [voxels]."""
    size: Sequence[int]
    """Nodes along x, y, z."""
    moved: bytes
    """x, y, z [mm] along the axes of the grid and a zero, float16, for each node, x fastest."""


class PictureChange(TypedDict):
    """One change of voxels and surfaces: the fields of ``protocol.Changed``."""

    edit: int
    applied: float | None
    """When it was made [s since 1970]; None where no edit made it."""
    voxels: list[VoxelChange]
    surfaces: list[SurfaceChange]
    displaced: list[DisplacedField] | None
    """Displacements that add up: of what is pressed, and of the body behind; none where nothing is
    displaced. None where it did not change."""
