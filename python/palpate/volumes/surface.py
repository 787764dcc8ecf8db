"""The surface of a segment: triangles in the patient frame, LPS [mm]."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from palpate import _core
from palpate.base.errors import EmptySegmentError, MeshFormatError, OptionError
from palpate.volumes.appearance import SurfaceSource as Source
from palpate.volumes.surface_report import SurfaceReport, thin_summary

if TYPE_CHECKING:
    from palpate.volumes.segment import Segment
    from palpate.volumes.volume import Volume

__all__ = ["Mesh", "Source", "Surface", "drawn_surface", "voxelise"]


@dataclass(frozen=True)
class Mesh:
    """Triangles with shared vertices, in the patient frame, LPS [mm]."""

    vertices: NDArray[np.float64]
    """Positions [mm], shape [vertex_count, 3]."""
    normals: NDArray[np.float32]
    """Unit normals pointing outward, shape [vertex_count, 3]."""
    triangles: NDArray[np.uint32]
    """Vertices of each triangle, counter-clockwise seen from outside, shape [triangle_count, 3]."""


class Surface:
    """The surface of a segment, smoothed without shrinking."""

    def __init__(
        self,
        segment: Segment,
        *,
        step: int | None = None,
        smoothing: int | None = None,
        mode: Literal["global", "local"] = "global",
        source: Source | None = None,
    ) -> None:
        """Extracts the whole surface.

        Args:
            segment: The segment.
            step: Edge of a cell [voxels]: 1, 2 or 4.
            smoothing: Degree of smoothing, 0 to 12; 0 from bits is the voxels as they are, face by
                face.
            mode: "global" smooths across patches, "local" each patch on its own.
            source: "intensities" takes the scan's values where a threshold made the segment, else
                its voxels; "bits" takes its voxels only. Where voxels were edited, both are the
                same. By default intensities, and bits where the smoothing is 0.

        Raises:
            OptionError: A setting is not allowed.
        """
        volume = segment.volume
        if source is not None and source not in get_args(Source):
            allowed = ", ".join(get_args(Source))
            raise OptionError(f"source {source!r} given; allowed: {allowed}")
        if source is None:
            source = "bits" if smoothing == 0 else "intensities"
        self._segment = segment
        try:
            self._internal = _core.KeptSurface(
                segment._internal,  # noqa: SLF001
                volume.spacing,
                volume.origin,
                direction_of(volume),
                step,
                smoothing,
                mode == "local",
                _values_of(segment) if source == "intensities" else None,
            )
        except (ValueError, OverflowError) as error:
            raise OptionError(str(error)) from None

    def mesh(self) -> Mesh:
        """Returns the whole surface as one mesh.

        Raises:
            EmptySegmentError: The segment has no voxels, or none fill a cell of the step by half.
        """
        vertices, normals, triangles = self._internal.mesh()
        if len(triangles) == 0:
            raise EmptySegmentError(self._why_empty())
        return Mesh(vertices, normals, triangles)

    def _why_empty(self) -> str:
        name, count = self._segment.name, self._segment.voxel_count
        if count == 0:
            return f"segment {name!r} has no voxels, so no surface; allowed: a segment with voxels"
        return (
            f"segment {name!r} is too thin for this step: none of its {count} voxels are left; "
            "allowed: step 1"
        )

    @property
    def triangle_count(self) -> int:
        """Number of triangles."""
        return self._internal.triangle_count

    @property
    def area(self) -> float:
        """Area of all triangles [mm²]."""
        return self._internal.area()

    @property
    def volume(self) -> float:
        """Enclosed volume [mm³]."""
        return self._internal.volume()

    @property
    def body_count(self) -> int:
        """Number of parts that hang together; cavities are none."""
        return self._internal.bodies

    def report(self) -> SurfaceReport:
        """Returns what the surface keeps of the segment's voxels."""
        internal = self._internal
        return SurfaceReport(
            segment=self._segment.name,
            triangles=self.triangle_count,
            area=self.area,
            volume=self.volume,
            bodies=internal.bodies,
            voxel_volume=internal.voxel_volume,
            expected_volume=internal.expected_volume(),
            halfway=internal.is_halfway,
            thin=thin_summary(*internal.thin_parts()),
            voxel_bodies=internal.voxel_bodies,
            touching_edges=internal.touching_edges,
        )


def drawn_surface(segment: Segment, *, smoothing: int, source: Source) -> _core.Surface:
    """Returns the triangles of a segment as a session shows them.

    Args:
        segment: The segment.
        smoothing: Degree of smoothing, 0 to 12.
        source: What it is made from; as for ``Surface``.
    """
    volume = segment.volume
    return _core.Surface(
        segment._internal,  # noqa: SLF001
        volume.spacing,
        volume.origin,
        direction_of(volume),
        1,
        smoothing,
        False,  # noqa: FBT003
        _values_of(segment) if source == "intensities" else None,
    )


def _values_of(segment: Segment) -> tuple[_core.Volume, tuple[float, float]] | None:
    """Returns the scan and the threshold that made a segment, if any: they locate its surface."""
    if segment.made_by is None:
        return None
    volume, (low, high) = segment.volume, segment.made_by
    lowest, highest = volume.range
    # an end that no value is beyond limits nothing
    limits = (-math.inf if low <= lowest else low, math.inf if high >= highest else high)
    if limits[0] == limits[1]:
        return None
    return volume._internal, limits  # noqa: SLF001


def voxelise(mesh: Mesh, volume: Volume, *, name: str, as_shell: bool = False) -> Segment:
    """Returns the voxels of a scan that a mesh encloses; parts outside of the scan are cut off.

    Args:
        mesh: A closed mesh; only its shell is taken where it is open.
        volume: The scan that provides the grid.
        name: Name of the segment.
        as_shell: Take only voxels that triangles intersect.

    Raises:
        MeshFormatError: Vertices are not finite, or triangles refer to missing vertices.
        EmptySegmentError: No voxel lies in the mesh.
    """
    from palpate.volumes.segment import Segment

    try:
        internal = _core.voxelise_mesh(
            np.ascontiguousarray(mesh.vertices, dtype=np.float64),
            np.ascontiguousarray(mesh.triangles, dtype=np.uint32),
            volume.dimensions,
            volume.spacing,
            volume.origin,
            direction_of(volume),
            as_shell,
        )
    except ValueError as error:
        raise MeshFormatError(str(error)) from None
    if internal.voxel_count == 0:
        raise EmptySegmentError(
            f"mesh {name!r} encloses no voxel of {volume.name!r}; allowed: a mesh within the scan, "
            "thicker than a voxel (or as a shell)"
        )
    return Segment(internal, name=name, volume=volume, range=None)


def direction_of(volume: Volume) -> tuple[float, ...]:
    """Returns the direction of a scan, row by row, nine numbers."""
    return tuple(float(cosine) for cosine in volume.direction.ravel())
