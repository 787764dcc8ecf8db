"""Files that pages download: segments and scan for other programs, as ``palpate export`` writes."""

from __future__ import annotations

import shutil
from pathlib import Path

import msgspec
import numpy as np
from numpy.typing import NDArray
from starlette.responses import Response

from palpate.export.export import export_scene
from palpate.export.kinds import Kind
from palpate.server.download import file_name, file_response
from palpate.server.messages.segment_list import SegmentList

__all__ = ["MOST_EXPORT_BYTES", "export_response"]

MOST_EXPORT_BYTES = 1 << 18
"""Bytes of an export request."""

ENDINGS: dict[Kind, str] = {
    "seg-nrrd": ".seg.nrrd",
    "labels": "",
    "scan": ".nii.gz",
    "dicom-seg": ".seg.dcm",
    "dicom-labelmap": ".labelmap.dcm",
    "rtstruct": ".rtstruct.dcm",
    "dicom": "",
}
"""Endings of names; exports of several files come as an archive and have none."""


class ExportRequest(msgspec.Struct, frozen=True):
    """The export that a page asks for."""

    kind: Kind
    keep_identity: bool = False
    pixels_checked: bool = False
    """Whether the person has looked for text in the pixels."""
    names: dict[int, str] = {}
    """Other names for segments, by their numbers."""


def export_response(segments: SegmentList, values: NDArray[np.int16], body: bytes) -> Response:
    """Writes what a page asks for and answers with the file, or with why it was not written."""

    def write(wanted: ExportRequest, folder: Path) -> tuple[Path, list[str]]:
        return _write(segments, values, wanted, folder=folder)

    return file_response(body, ExportRequest, write, most_bytes=MOST_EXPORT_BYTES, called="export")


def _write(
    segments: SegmentList, values: NDArray[np.int16], wanted: ExportRequest, *, folder: Path
) -> tuple[Path, list[str]]:
    scene, notes = segments.scene(values, names=wanted.names)
    shared = wanted.kind == "dicom" and not wanted.keep_identity
    name = "shared" if shared else file_name(scene.volume.name)
    ending = ENDINGS[wanted.kind]
    target = folder / f"{name}{ending}"
    if wanted.kind == "labels":
        target = folder / name / "labels.nii.gz"
        target.parent.mkdir()
    notes += export_scene(
        scene,
        target,
        kind=wanted.kind,
        keep_identity=wanted.keep_identity or bool(ending),
        pixels_checked=wanted.pixels_checked,
    )
    if ending:
        return target, notes
    packed = shutil.make_archive(str(folder / name), "zip", folder / name)
    return Path(packed), notes
