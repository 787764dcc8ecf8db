"""Writing of meshes (STL, PLY, OBJ, GLB) in the patient frame, LPS [mm].

Files state frame and unit where they can: ``SPACE=LPS`` and ``UNIT=mm`` in the header. GLB has a
frame of its own, metres with y up, into which its one node transforms the mesh. A file appears
under its name only once it is complete.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np

from palpate.base.errors import OptionError
from palpate.base.whole_file import whole_file
from palpate.volumes.surface import Mesh

__all__ = ["GLTF_FROM_PATIENT", "SUFFIXES", "write_mesh"]

HEADER = "SPACE=LPS UNIT=mm"

GLTF_FROM_PATIENT = np.array(
    [[1e-3, 0.0, 0.0, 0.0], [0.0, 0.0, 1e-3, 0.0], [0.0, -1e-3, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
)
"""From patient LPS [mm] to glTF: left, superior, anterior [m]."""

_STL_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])
_PLY_VERTEX = np.dtype([("position", "<f4", 3), ("normal", "<f4", 3)])
_PLY_FACE = np.dtype([("count", "u1"), ("corners", "<i4", 3)])


def write_mesh(mesh: Mesh, path: Path) -> None:
    """Writes a mesh in the format of the file name's extension.

    Raises:
        OptionError: The extension is not one of the formats.
        OSError: The file cannot be written; nothing is left behind then.
    """
    encode = _ENCODERS.get(path.suffix.lower())
    if encode is None:
        raise OptionError(f"{path.name!r} given; allowed: a name with {', '.join(SUFFIXES)}")
    content = encode(mesh)
    with whole_file(path) as unfinished:
        unfinished.write_bytes(content)


def _stl(mesh: Mesh) -> bytes:
    corners = mesh.vertices[mesh.triangles]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(faces, axis=1, keepdims=True)
    rows = np.zeros(len(corners), _STL_TRIANGLE)
    rows["normal"] = faces / np.where(lengths > 0.0, lengths, 1.0)
    rows["corners"] = corners
    header = HEADER.encode().ljust(80)
    return header + np.uint32(len(rows)).tobytes() + rows.tobytes()


def _ply(mesh: Mesh) -> bytes:
    header = "\n".join(
        (
            "ply",
            "format binary_little_endian 1.0",
            f"comment {HEADER}",
            f"element vertex {len(mesh.vertices)}",
            *(f"property float {name}" for name in ("x", "y", "z", "nx", "ny", "nz")),
            f"element face {len(mesh.triangles)}",
            "property list uchar int vertex_indices",
            "end_header\n",
        )
    )
    vertices = np.empty(len(mesh.vertices), _PLY_VERTEX)
    vertices["position"], vertices["normal"] = mesh.vertices, mesh.normals
    faces = np.empty(len(mesh.triangles), _PLY_FACE)
    faces["count"], faces["corners"] = 3, mesh.triangles
    return header.encode() + vertices.tobytes() + faces.tobytes()


def _obj(mesh: Mesh) -> bytes:
    lines = [f"# {HEADER}"]
    lines += [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in mesh.vertices.tolist()]
    lines += [f"vn {x:.4f} {y:.4f} {z:.4f}" for x, y, z in mesh.normals.tolist()]
    lines += [
        f"f {a}//{a} {b}//{b} {c}//{c}" for a, b, c in (mesh.triangles.astype(int) + 1).tolist()
    ]
    return ("\n".join(lines) + "\n").encode()


def _glb(mesh: Mesh) -> bytes:
    parts = [
        mesh.vertices.astype("<f4"),
        mesh.normals.astype("<f4"),
        mesh.triangles.astype("<u4").ravel(),
    ]
    starts = np.cumsum([0, *(part.nbytes for part in parts)]).tolist()
    floats, integers = 5126, 5125  # as glTF numbers its types
    document = {
        "asset": {"version": "2.0", "generator": "palpate", "extras": {"NODE_SPACE": HEADER}},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "matrix": GLTF_FROM_PATIENT.T.ravel().tolist()}],
        "meshes": [
            {"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2}]}
        ],
        "buffers": [{"byteLength": starts[-1]}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": start, "byteLength": part.nbytes}
            for start, part in zip(starts[:-1], parts, strict=True)
        ],
        "accessors": [
            {
                "bufferView": 0, "componentType": floats, "type": "VEC3", "count": len(parts[0]),
                "min": parts[0].min(axis=0).tolist(), "max": parts[0].max(axis=0).tolist(),
            },
            {"bufferView": 1, "componentType": floats, "type": "VEC3", "count": len(parts[1])},
            {"bufferView": 2, "componentType": integers, "type": "SCALAR", "count": len(parts[2])},
        ],
    }  # fmt: skip
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body = b"".join(part.tobytes() for part in parts)
    chunks = _chunk(b"JSON", text) + _chunk(b"BIN\0", body)
    return b"glTF" + np.array([2, 12 + len(chunks)], "<u4").tobytes() + chunks


def _chunk(kind: bytes, content: bytes) -> bytes:
    return np.uint32(len(content)).tobytes() + kind + content


_ENCODERS: dict[str, Callable[[Mesh], bytes]] = {
    ".stl": _stl,
    ".ply": _ply,
    ".obj": _obj,
    ".glb": _glb,
}
SUFFIXES = tuple(_ENCODERS)
"""File name extensions of the formats."""
