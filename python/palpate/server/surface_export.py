"""The surface of a segment as a mesh that pages download, as ``palpate surface export`` writes."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import msgspec
import numpy as np
from numpy.typing import NDArray
from starlette.responses import Response

from palpate.server.download import file_name, file_response
from palpate.server.messages.segment_list import SegmentList
from palpate.volumes.mesh_write import write_mesh
from palpate.volumes.surface import Surface

__all__ = ["MOST_SURFACE_BYTES", "surface_response"]

MOST_SURFACE_BYTES = 1 << 10
"""Bytes of a request."""


class SurfaceRequest(msgspec.Struct, frozen=True):
    """The surface that a page asks for, with the smoothing and the source of the picture."""

    segment: int
    format: Literal["stl", "ply", "obj", "glb"] = "stl"


def surface_response(segments: SegmentList, values: NDArray[np.int16], body: bytes) -> Response:
    """Writes a surface and answers with the file, or with why it was not written.

    The first of its notes says what was written, the others what was lost.
    """

    def write(wanted: SurfaceRequest, folder: Path) -> tuple[Path, list[str]]:
        return _write(segments, values, wanted, folder=folder)

    return file_response(
        body, SurfaceRequest, write, most_bytes=MOST_SURFACE_BYTES, called="surface"
    )


def _write(
    segments: SegmentList, values: NDArray[np.int16], wanted: SurfaceRequest, *, folder: Path
) -> tuple[Path, list[str]]:
    place, look = segments.place_of(wanted.segment), segments.look_of(wanted.segment)
    scene, _ = segments.scene(values)
    segment = list(scene)[place].segment
    surface = Surface(segment, smoothing=look.smoothing, source=look.surface_from)
    path = folder / f"{file_name(look.name, 'surface')}.{wanted.format}"
    write_mesh(surface.mesh(), path)
    report = surface.report()
    return path, [f"{path.name}: {report.of(len(scene))}, LPS", *report.warnings]
