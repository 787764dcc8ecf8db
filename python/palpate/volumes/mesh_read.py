"""Reading of meshes (STL, PLY, OBJ, GLB), and grids to voxelise them.

Meshes are converted to the patient frame, LPS [mm]. Some files state their frame and unit in the
header (``SPACE=LPS``, as 3D Slicer writes it, ``UNIT=mm``); GLB is in metres with y up by
definition; for all others the caller states them. Equal vertices are merged, degenerate triangles
are removed, and a mesh that is inside out is flipped; ``notes`` report all of that.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from palpate.base.damaged_file import damage_as
from palpate.base.errors import MeshFormatError, OptionError
from palpate.base.plain_file import check_plain
from palpate.base.reader_process import apart
from palpate.volumes.mesh_promises import STL_HEADER, check_promises
from palpate.volumes.mesh_write import GLTF_FROM_PATIENT, SUFFIXES
from palpate.volumes.segment import Segment
from palpate.volumes.surface import Mesh, voxelise
from palpate.volumes.volume import Volume, VolumeTraits

__all__ = [
    "MeshFile",
    "closed",
    "grid_around",
    "hole_count",
    "object_of_mesh",
    "read_mesh",
    "segment_of_mesh",
    "suitable_spacing",
    "with_vertices",
]

Frame = Literal["LPS", "RAS"]
Unit = Literal["mm", "m"]

FRAMES: dict[str, tuple[float, float, float]] = {"LPS": (1.0, 1.0, 1.0), "RAS": (-1.0, -1.0, 1.0)}
UNITS = {"mm": 1.0, "m": 1000.0}

ALLOWED = f"a whole mesh of {', '.join(SUFFIXES)}"
HEAD_BYTES = 4096
"""Bytes of the file that are searched for a header."""
SMALLEST_MM = 3.0
"""A mesh smaller than this, read as mm, is probably in metres [mm]."""
MARGIN = 2
"""Empty voxels around a mesh."""
THICK_IN_VOXELS = 4
"""Thickness of a plate in voxels, where no voxel size is given."""
MOST_VOXELS = 1 << 25
"""Most voxels of a mesh, where no voxel size is given."""
LARGEST = 1e9
"""Coordinate [mm]: a thousand kilometres are no patient."""


@dataclass(frozen=True)
class MeshFile:
    """A mesh read from a file, in the patient frame, LPS [mm]."""

    mesh: Mesh
    name: str
    holes: int
    """Number of open borders; 0 for a closed mesh."""
    notes: tuple[str, ...] = field(default=())
    """Sentences on what was repaired."""


def read_mesh(path: Path, *, frame: Frame | None = None, unit: Unit | None = None) -> MeshFile:
    """Reads a mesh.

    Args:
        path: A .stl, .ply, .obj or .glb file.
        frame: Frame of its vertices, where the file does not state it.
        unit: Unit of its lengths, where the file does not state it.

    Raises:
        MeshFormatError: The file has no mesh, is damaged, or declares a wrong size.
        OptionError: Frame or unit are not known, or contradict the file.
        OSError: The file cannot be read.
    """
    if path.suffix.lower() not in SUFFIXES:
        raise MeshFormatError(f"{path.name!r} given; allowed: a file with {', '.join(SUFFIXES)}")
    check_plain(path)
    check_promises(path)
    vertices, triangles = apart(_load, path, path=path, error=MeshFormatError)
    if path.suffix.lower() == ".glb":
        in_patient = np.linalg.inv(GLTF_FROM_PATIENT)[:3, :3]
        vertices = vertices @ in_patient.T
    else:
        header = _header_of(path)
        turned = FRAMES[_frame_of(path, header.get("SPACE"), frame)]
        vertices = vertices * turned * UNITS[_unit_of(path, header.get("UNIT"), (unit, vertices))]
    return _repaired(path, vertices, triangles)


def hole_count(triangles: NDArray[np.integer[Any]]) -> int:
    """Returns the number of open borders: loops of edges with a triangle on one side only."""
    return len(np.unique(_parts(_open_edges(triangles))))


def closed(file: MeshFile) -> MeshFile:
    """Returns the mesh with each hole closed by triangles around the centre of its border."""
    if file.holes == 0:
        return file
    vertices, triangles = file.mesh.vertices, file.mesh.triangles
    edges = _open_edges(triangles)
    parts = _parts(edges)
    middles = [vertices[np.unique(edges[parts == part])].mean(axis=0) for part in np.unique(parts)]
    _, hole = np.unique(parts, return_inverse=True)
    # along its border a lid turns the other way
    lids = np.column_stack([edges[:, ::-1], len(vertices) + hole])
    vertices = np.vstack([vertices, middles])
    triangles = np.vstack([triangles, lids.astype(np.uint32)])
    mesh = Mesh(vertices, _normals(vertices, triangles.astype(np.int64)), triangles)
    note = f"{file.holes} hole{'s were' if file.holes > 1 else ' was'} closed"
    return MeshFile(mesh, file.name, hole_count(triangles), (*file.notes, note))


def with_vertices(
    file: MeshFile, vertices: NDArray[np.float64], *, mirrored: bool = False
) -> MeshFile:
    """Returns the same triangles between vertices that stand elsewhere, shape [count, 3] [mm].

    Triangles turn about where space is ``mirrored``, so that their outside stays outside.
    """
    triangles = file.mesh.triangles[:, ::-1] if mirrored else file.mesh.triangles
    normals = _normals(vertices, triangles.astype(np.int64))
    mesh = Mesh(vertices, normals, np.ascontiguousarray(triangles))
    return MeshFile(mesh, file.name, file.holes, file.notes)


def grid_around(meshes: Iterable[Mesh], spacing: float, *, name: str = "mesh") -> Volume:
    """Returns an empty scan around meshes, with cubic voxels [mm].

    Raises:
        OptionError: The spacing is not allowed, or gives too many voxels.
    """
    if not (np.isfinite(spacing) and spacing > 0.0):
        raise OptionError(f"spacing {spacing:g} mm given; allowed: more than 0 mm")
    points = [mesh.vertices for mesh in meshes]
    low = np.min([one.min(axis=0) for one in points], axis=0)
    high = np.max([one.max(axis=0) for one in points], axis=0)
    counts = np.ceil((high - low) / spacing) + 2 * MARGIN
    most = 1024**3
    if np.prod(counts) > most:
        x, y, z = counts
        raise OptionError(
            f"spacing {spacing:g} mm gives {x:g} x {y:g} x {z:g} voxels; allowed: {most} in all"
        )
    # a mesh that ends on round numbers should not run through the middles of voxels
    origin = low - (MARGIN - 0.5) * spacing
    values = np.zeros(counts[::-1].astype(int), np.int16)
    traits = VolumeTraits(name=name)
    return Volume(values, spacing=[spacing] * 3, origin=origin.tolist(), traits=traits)


def suitable_spacing(mesh: Mesh, volume: Volume) -> float:
    """Returns an edge of cubic voxels that preserves the mean thickness of a mesh [mm].

    A plate is ``THICK_IN_VOXELS`` voxels thick then. Voxels are never larger than those of the
    scan, nor more than fit into little memory.
    """
    a, b, c = mesh.vertices[mesh.triangles].transpose(1, 0, 2)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0
    enclosed = abs(np.einsum("ij,ij->", a - mesh.vertices[0], np.cross(b - a, c - a))) / 6.0
    thickness = 2.0 * enclosed / area if area > 0.0 else np.inf
    wanted = min(*volume.spacing, thickness / THICK_IN_VOXELS)
    box = np.prod(np.ptp(mesh.vertices, axis=0) + wanted)
    return float(max(wanted, (box / MOST_VOXELS) ** (1.0 / 3.0)))


def object_of_mesh(file: MeshFile, spacing: float) -> Segment:
    """Returns the voxels of a mesh on a grid of its own, with cubic voxels.

    Raises:
        MeshFormatError: The mesh is open.
        OptionError: The spacing is not allowed, or gives too many voxels.
        EmptySegmentError: The mesh is thinner than a voxel everywhere.
    """
    grid = grid_around([file.mesh], spacing, name=Path(file.name).stem)
    return segment_of_mesh(file, grid).as_object()


def segment_of_mesh(file: MeshFile, volume: Volume, *, as_shell: bool = False) -> Segment:
    """Returns the voxels of a mesh on the grid of a scan.

    Raises:
        MeshFormatError: The mesh is open, and its inside is requested.
        EmptySegmentError: No voxel lies inside.
    """
    if file.holes and not as_shell:
        raise MeshFormatError(
            f"{file.name!r} has {file.holes} hole{'s' if file.holes > 1 else ''}, so no inside; "
            "allowed: a closed mesh, `close=True` to close them, or `as_shell=True` for its "
            "surface alone"
        )
    return voxelise(file.mesh, volume, name=Path(file.name).stem, as_shell=as_shell)


# --- what a file says ----------------------------------------------------------------------


def _load(path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Returns vertices and triangles of a file, with equal vertices merged."""
    try:
        trimesh = import_module("trimesh")
    except ImportError:
        raise OptionError("trimesh is not installed; allowed: pip install trimesh") from None
    broken = f"{path.name!r} is no mesh that can be read"
    with damage_as(MeshFormatError, broken, allowed=ALLOWED):
        # from its bytes alone: materials and textures would be sought in other files
        with path.open("rb") as file:
            kind = path.suffix.lower().removeprefix(".")
            loaded = trimesh.load(file, file_type=kind, force="mesh", process=False)
        vertices = np.array(loaded.vertices, dtype=np.float64)
        triangles = np.array(loaded.faces, dtype=np.int64)
    if len(triangles) == 0 or triangles.ndim != 2:
        raise MeshFormatError(f"{path.name!r} has no triangles; allowed: a mesh of triangles")
    if vertices.ndim != 2 or vertices.shape[1] != 3 or triangles.shape[1] != 3:
        raise MeshFormatError(
            f"{path.name!r} has vertices or triangles without three numbers each; allowed: a mesh "
            "of triangles in space"
        )
    if not (np.abs(vertices) < LARGEST).all():
        raise MeshFormatError(
            f"{path.name!r} has vertices that are no numbers, or far beyond any patient; allowed: "
            f"coordinates below {LARGEST:g}"
        )
    if triangles.min() < 0 or triangles.max() >= len(vertices):
        raise MeshFormatError(
            f"{path.name!r} has triangles of vertices up to {triangles.max()}; allowed: up to "
            f"{len(vertices) - 1}"
        )
    # STL has three vertices for each triangle, others one for each normal
    joined, numbers = np.unique(vertices[triangles.ravel()], axis=0, return_inverse=True)
    return joined, numbers.reshape(triangles.shape)


def _header_of(path: Path) -> dict[str, str]:
    """Returns the NAME=VALUE pairs of the header."""
    with path.open("rb") as file:
        head = file.read(STL_HEADER - 4 if path.suffix.lower() == ".stl" else HEAD_BYTES)
    return dict(re.findall(r"\b(SPACE|UNIT)=(\w+)", head.decode("latin-1")))


def _frame_of(path: Path, stated: str | None, given: Frame | None) -> str:
    if stated is not None and stated not in FRAMES:
        raise MeshFormatError(f"{path.name!r} says SPACE={stated}; allowed: {', '.join(FRAMES)}")
    if stated is not None and given is not None and stated != given:
        raise OptionError(
            f"frame {given} given, and {path.name!r} says {stated}; allowed: {stated}"
        )
    frame = stated or given
    if frame is None:
        raise OptionError(
            f"{path.name!r} does not say in which frame it is; allowed: `frame=LPS` or `frame=RAS`"
        )
    return frame


def _unit_of(path: Path, stated: str | None, given: tuple[Unit | None, NDArray[np.float64]]) -> str:
    unit, vertices = given
    if stated is not None and stated not in UNITS:
        raise MeshFormatError(f"{path.name!r} says UNIT={stated}; allowed: {', '.join(UNITS)}")
    if stated is not None and unit is not None and stated != unit:
        raise OptionError(f"unit {unit} given, and {path.name!r} says {stated}; allowed: {stated}")
    if stated is None and unit is None:
        extent = float(np.ptp(vertices, axis=0).max())
        if extent < SMALLEST_MM:
            raise OptionError(
                f"{path.name!r} is {extent:.3g} long, which is little for mm; allowed: `unit=m` "
                "or `unit=mm`"
            )
    return stated or unit or "mm"


# --- repairs -------------------------------------------------------------------------------


def _repaired(path: Path, vertices: NDArray[np.float64], triangles: NDArray[np.int64]) -> MeshFile:
    notes = []
    a, b, c = triangles.T
    proper = triangles[(a != b) & (b != c) & (c != a)]
    if len(proper) < len(triangles):
        notes.append(f"{len(triangles) - len(proper)} triangles without area were left out")
    if len(proper) == 0:
        raise MeshFormatError(f"{path.name!r} has no triangle with an area; allowed: a mesh")

    holes = hole_count(proper)
    corners = vertices[proper]
    centre = vertices.mean(axis=0)
    x, y, z = (corners - centre).transpose(1, 0, 2)
    if holes == 0 and np.einsum("ij,ij->", x, np.cross(y, z)) < 0.0:
        proper = proper[:, ::-1]
        notes.append("it was inside out and was turned")
    if holes:
        notes.append(f"it has {holes} hole{'s' if holes > 1 else ''}")
    mesh = Mesh(vertices, _normals(vertices, proper), proper.astype(np.uint32))
    return MeshFile(mesh, path.name, holes, tuple(notes))


def _normals(vertices: NDArray[np.float64], triangles: NDArray[np.int64]) -> NDArray[np.float32]:
    """Returns vertex normals: those of the triangles, weighted by area."""
    corners = vertices[triangles]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sums = np.zeros_like(vertices)
    for corner in triangles.T:
        np.add.at(sums, corner, faces)
    lengths = np.linalg.norm(sums, axis=1, keepdims=True)
    upward = np.array([0.0, 0.0, 1.0])
    normals: NDArray[np.float64] = np.where(
        lengths > 0.0, sums / np.where(lengths > 0.0, lengths, 1.0), upward
    )
    return normals.astype(np.float32)


def _open_edges(triangles: NDArray[np.integer[Any]]) -> NDArray[np.int64]:
    """Returns edges with more triangles in one direction than in the other, in that direction."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    edges = edges.astype(np.int64)
    keys, place = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    turns = np.where(edges[:, 0] < edges[:, 1], 1, -1)
    surplus = np.bincount(place.ravel(), turns, len(keys)).astype(np.int64)
    along = np.where(surplus[:, None] > 0, keys, keys[:, ::-1])
    return np.repeat(along, np.abs(surplus), axis=0)


def _parts(edges: NDArray[np.int64]) -> NDArray[np.int64]:
    """Returns a number for each edge that is the same for connected edges."""
    root: dict[int, int] = {}

    def root_of(vertex: int) -> int:
        path = []
        while root.setdefault(vertex, vertex) != vertex:
            path.append(vertex)
            vertex = root[vertex]
        for passed in path:
            root[passed] = vertex
        return vertex

    for a, b in edges.tolist():
        root[root_of(a)] = root_of(b)
    return np.array([root_of(a) for a, _ in edges.tolist()], dtype=np.int64)
