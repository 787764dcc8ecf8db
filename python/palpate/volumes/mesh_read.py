"""Reading of meshes: STL, PLY, OBJ and GLB, and grids to make voxels of them.

A mesh comes into the patient (LPS) [mm]. In which frame and unit it was written stands in the
header of some files (``SPACE=LPS``, as 3D Slicer writes it, ``UNIT=mm``); GLB is in metres with
y up by its own rules; else the person says it. Vertices at one place become one, triangles that
are none are left out, and a mesh turned inside out is turned: all of it is told.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Iterable
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import MeshFormatError, OptionError
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
]

Frame = Literal["LPS", "RAS"]
Unit = Literal["mm", "m"]

FRAMES: dict[str, tuple[float, float, float]] = {"LPS": (1.0, 1.0, 1.0), "RAS": (-1.0, -1.0, 1.0)}
UNITS = {"mm": 1.0, "m": 1000.0}

HEAD_BYTES = 4096
"""In which a header says what it says."""
SMALLEST_MM = 3.0
"""A mesh that is smaller, taken as mm, is more likely one in metres."""
MARGIN = 2
"""Voxels around a mesh."""
THICK_IN_VOXELS = 4
"""How many voxels a plate is thick at least, where nobody says how large they are to be."""
MOST_VOXELS = 1 << 25
"""Voxels of a mesh then, at most."""
STL_HEADER, STL_TRIANGLE = 84, 50

BROKEN = (
    *(ValueError, KeyError, IndexError, TypeError, AttributeError, struct.error, ImportError),
    *(NotImplementedError, EOFError, AssertionError, OverflowError),
)
"""What a reader of meshes says of damaged files."""


@dataclass(frozen=True)
class MeshFile:
    """A mesh from a file, in the patient."""

    mesh: Mesh
    name: str
    holes: int
    """Borders where the surface is open; 0 for a closed one."""
    notes: tuple[str, ...] = field(default=())
    """Sentences on what was repaired."""


def read_mesh(path: Path, *, frame: Frame | None = None, unit: Unit | None = None) -> MeshFile:
    """Reads a mesh.

    Args:
        path: A file that ends with .stl, .ply, .obj or .glb.
        frame: In which it is, where the file does not say so.
        unit: Of its lengths, where the file does not say so.

    Raises:
        MeshFormatError: It holds no mesh, is damaged, or lies about its size.
        OptionError: Its frame or its unit is not known, or not the one that is given.
        OSError: It cannot be read.
    """
    if path.suffix.lower() not in SUFFIXES:
        raise MeshFormatError(f"{path.name!r} given; allowed: a file with {', '.join(SUFFIXES)}")
    _check_size(path)
    vertices, triangles = _load(path)
    if path.suffix.lower() == ".glb":
        in_patient = np.linalg.inv(GLTF_FROM_PATIENT)[:3, :3]
        vertices = vertices @ in_patient.T
    else:
        told = _told_by(path)
        turned = FRAMES[_frame_of(path, told.get("SPACE"), frame)]
        vertices = vertices * turned * UNITS[_unit_of(path, told.get("UNIT"), (unit, vertices))]
    return _repaired(path, vertices, triangles)


def hole_count(triangles: NDArray[np.integer[Any]]) -> int:
    """Returns how many borders a mesh has; edges on a border have a triangle on one side."""
    return len(np.unique(_parts(_open_edges(triangles))))


def closed(file: MeshFile) -> MeshFile:
    """Returns the mesh with each hole closed by triangles around the middle of its border."""
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


def grid_around(meshes: Iterable[Mesh], spacing: float, *, name: str = "mesh") -> Volume:
    """Returns an empty scan of cubes [mm] around meshes.

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
    """Returns the edge of voxels [mm] that keep the thinnest a mesh is in the mean.

    A plate is ``THICK_IN_VOXELS`` thick then; voxels are never larger than those of the scan, and
    so many at most that they take little memory.
    """
    a, b, c = mesh.vertices[mesh.triangles].transpose(1, 0, 2)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0
    enclosed = abs(np.einsum("ij,ij->", a - mesh.vertices[0], np.cross(b - a, c - a))) / 6.0
    thickness = 2.0 * enclosed / area if area > 0.0 else np.inf
    wanted = min(*volume.spacing, thickness / THICK_IN_VOXELS)
    box = np.prod(np.ptp(mesh.vertices, axis=0) + wanted)
    return float(max(wanted, (box / MOST_VOXELS) ** (1.0 / 3.0)))


def object_of_mesh(file: MeshFile, spacing: float) -> Segment:
    """Returns the voxels of a mesh on a grid of its own, cubes of an edge [mm].

    Raises:
        MeshFormatError: It is open.
        OptionError: The spacing is not allowed, or gives too many voxels.
        EmptySegmentError: It is thinner than a voxel everywhere.
    """
    grid = grid_around([file.mesh], spacing, name=Path(file.name).stem)
    return segment_of_mesh(file, grid).as_object()


def segment_of_mesh(file: MeshFile, volume: Volume, *, as_shell: bool = False) -> Segment:
    """Returns the voxels of a mesh on the grid of a scan.

    Raises:
        MeshFormatError: It is open, and its inside is asked for.
        EmptySegmentError: No voxel lies in it.
    """
    if file.holes and not as_shell:
        raise MeshFormatError(
            f"{file.name!r} has {file.holes} hole{'s' if file.holes > 1 else ''}, so no inside; "
            "allowed: a closed mesh, --close to close them, or --shell for its surface alone"
        )
    return voxelise(file.mesh, volume, name=Path(file.name).stem, as_shell=as_shell)


# --- what a file says ----------------------------------------------------------------------


def _check_size(path: Path) -> None:
    """Refuses a binary STL whose count of triangles is not that of its length."""
    length = path.stat().st_size
    if length == 0:
        raise MeshFormatError(f"{path.name!r} is empty; allowed: a mesh")
    if path.suffix.lower() != ".stl":
        return
    with path.open("rb") as file:
        head = file.read(STL_HEADER)
    is_text = head.lstrip().startswith(b"solid") and b"\0" not in head
    if is_text:
        return
    count = int.from_bytes(head[80:84], "little") if len(head) == STL_HEADER else -1
    if length != STL_HEADER + STL_TRIANGLE * count:
        raise MeshFormatError(
            f"{path.name!r} tells of {max(count, 0)} triangles and has {length} bytes; allowed: "
            f"{STL_HEADER} bytes and {STL_TRIANGLE} for each triangle"
        )


def _load(path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Returns vertices as the file has them, equal ones joined, and triangles."""
    try:
        trimesh = import_module("trimesh")
    except ImportError:
        raise OptionError("trimesh is not installed; allowed: pip install trimesh") from None
    try:
        loaded = trimesh.load(path, force="mesh", process=False)
        vertices = np.array(loaded.vertices, dtype=np.float64)
        triangles = np.array(loaded.faces, dtype=np.int64)
    except BROKEN as error:
        raise MeshFormatError(
            f"{path.name!r} is no mesh that can be read ({error}); allowed: {', '.join(SUFFIXES)}"
        ) from None
    if len(triangles) == 0 or triangles.ndim != 2:
        raise MeshFormatError(f"{path.name!r} has no triangles; allowed: a mesh of triangles")
    if not np.isfinite(vertices).all():
        raise MeshFormatError(f"{path.name!r} has vertices that are no numbers; allowed: numbers")
    if triangles.min() < 0 or triangles.max() >= len(vertices):
        raise MeshFormatError(
            f"{path.name!r} has triangles of vertices up to {triangles.max()}; allowed: up to "
            f"{len(vertices) - 1}"
        )
    # STL has three vertices for each triangle, others one for each normal
    joined, numbers = np.unique(vertices[triangles.ravel()], axis=0, return_inverse=True)
    return joined, numbers.reshape(triangles.shape)


def _told_by(path: Path) -> dict[str, str]:
    """Returns what the header says as NAME=VALUE."""
    with path.open("rb") as file:
        head = file.read(STL_HEADER - 4 if path.suffix.lower() == ".stl" else HEAD_BYTES)
    return dict(re.findall(r"\b(SPACE|UNIT)=(\w+)", head.decode("latin-1")))


def _frame_of(path: Path, told: str | None, given: Frame | None) -> str:
    if told is not None and told not in FRAMES:
        raise MeshFormatError(f"{path.name!r} says SPACE={told}; allowed: {', '.join(FRAMES)}")
    if told is not None and given is not None and told != given:
        raise OptionError(f"frame {given} given, and {path.name!r} says {told}; allowed: {told}")
    frame = told or given
    if frame is None:
        raise OptionError(
            f"{path.name!r} does not say in which frame it is; allowed: --frame LPS or --frame RAS"
        )
    return frame


def _unit_of(path: Path, told: str | None, given: tuple[Unit | None, NDArray[np.float64]]) -> str:
    unit, vertices = given
    if told is not None and told not in UNITS:
        raise MeshFormatError(f"{path.name!r} says UNIT={told}; allowed: {', '.join(UNITS)}")
    if told is not None and unit is not None and told != unit:
        raise OptionError(f"unit {unit} given, and {path.name!r} says {told}; allowed: {told}")
    if told is None and unit is None:
        extent = float(np.ptp(vertices, axis=0).max())
        if extent < SMALLEST_MM:
            raise OptionError(
                f"{path.name!r} is {extent:.3g} long, which is little for mm; allowed: --unit m or "
                "--unit mm"
            )
    return told or unit or "mm"


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
    """Returns normals of vertices, those of triangles weighed by area."""
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
    """Returns edges that more triangles run along one way than the other, the way they run."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    edges = edges.astype(np.int64)
    keys, place = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    turns = np.where(edges[:, 0] < edges[:, 1], 1, -1)
    surplus = np.bincount(place.ravel(), turns, len(keys)).astype(np.int64)
    along = np.where(surplus[:, None] > 0, keys, keys[:, ::-1])
    return np.repeat(along, np.abs(surplus), axis=0)


def _parts(edges: NDArray[np.int64]) -> NDArray[np.int64]:
    """Returns for each edge a number that connected ones share."""
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
