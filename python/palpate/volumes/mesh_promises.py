"""What headers of mesh files promise, held against the files before a library makes room for it.

Sources: Stanford PLY (G. Turk 1994); glTF 2.0 (Khronos), 3.6 (buffers) and 4.4 (GLB); STL (3D
Systems 1989).
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from palpate.base.errors import MeshFormatError

__all__ = ["STL_HEADER", "check_promises"]

STL_HEADER, STL_TRIANGLE = 84, 50
MOST_HEADER = 1 << 16
"""Of a PLY file [bytes]."""
MOST_NODES = 10_000
"""Of a scene in a GLB file."""
COMPONENT_BYTES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}


def check_promises(path: Path) -> None:
    """Refuses a file that promises more than it can hold, or names others.

    Raises:
        MeshFormatError: It does.
    """
    length = path.stat().st_size
    if length == 0:
        raise MeshFormatError(f"{path.name!r} is empty; allowed: a mesh")
    check = {".stl": _check_stl, ".ply": _check_ply, ".glb": _check_glb}.get(path.suffix.lower())
    if check is not None:
        check(path, length)


def _check_stl(path: Path, length: int) -> None:
    with path.open("rb") as file:
        head = file.read(STL_HEADER)
    is_text = head.lstrip().startswith(b"solid") and b"\0" not in head
    if is_text:
        return
    count = int.from_bytes(head[80:84], "little") if len(head) == STL_HEADER else -1
    if length != STL_HEADER + STL_TRIANGLE * count:
        raise MeshFormatError(
            f"{path.name!r} declares {max(count, 0)} triangles and has {length} bytes; allowed: "
            f"{STL_HEADER} bytes and {STL_TRIANGLE} for each triangle"
        )


def _check_ply(path: Path, length: int) -> None:
    with path.open("rb") as file:
        head = file.read(MOST_HEADER).partition(b"end_header")[0].decode("latin-1")
    for name, told in re.findall(r"(?m)^\s*element\s+(\S+)\s+(\S+)", head):
        # a byte is the least that a point or a triangle takes
        if not re.fullmatch(r"\d{1,18}", told) or int(told) > length:
            raise MeshFormatError(
                f"{path.name!r} declares {told[:40]} {name[:40]} in {length} bytes; allowed: as "
                "many as are there"
            )


def _check_glb(path: Path, length: int) -> None:
    with path.open("rb") as file:
        head = file.read(20)
        size = int.from_bytes(head[12:16], "little")
        if head[:4] != b"glTF" or head[16:20] != b"JSON" or size > length - 20:
            raise MeshFormatError(
                f"{path.name!r} is no mesh that can be read (a part of it is missing); allowed: "
                "a whole GLB file"
            )
        text = file.read(size)
    try:
        scene = json.loads(text)
        _check_scene(path, scene, length)
    except (ValueError, TypeError, AttributeError, LookupError, RecursionError) as error:
        raise MeshFormatError(
            f"{path.name!r} is no mesh that can be read ({error}); allowed: a whole GLB file"
        ) from None


def _check_scene(path: Path, scene: dict[str, Any], length: int) -> None:
    places = [str(one.get("uri", "data:")) for one in scene.get("buffers") or []]
    if not all(place.startswith("data:") for place in places):
        raise MeshFormatError(
            f"{path.name!r} names other files; allowed: all of a mesh in one file"
        )
    for one in scene.get("accessors") or []:
        held = COMPONENT_BYTES[one["componentType"]] * COMPONENTS[one["type"]]
        count = one["count"]
        if not isinstance(count, int) or not 0 <= count * held <= length:
            raise MeshFormatError(
                f"{path.name!r} declares {str(count)[:40]} numbers in {length} bytes; allowed: as "
                "many as are there"
            )
    nodes = scene.get("nodes") or []
    if len(nodes) > MOST_NODES:
        raise MeshFormatError(
            f"{path.name!r} has {len(nodes)} nodes; allowed: at most {MOST_NODES}"
        )
    # a node with two parents is drawn twice, and in a chain of them more often than can be
    children = [child for node in nodes for child in node.get("children") or []]
    if len(children) != len(set(children)):
        raise MeshFormatError(f"{path.name!r} has nodes with two parents; allowed: a tree of nodes")
