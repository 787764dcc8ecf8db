"""Files that pages download: segments and scan for other programs, as ``palpate export`` writes."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from tempfile import TemporaryDirectory
from urllib.parse import quote

import msgspec
import numpy as np
from numpy.typing import NDArray
from starlette.background import BackgroundTask
from starlette.responses import FileResponse, PlainTextResponse, Response

from palpate.errors import PalpateError
from palpate.export import Kind, export_scene
from palpate.server_segments import ShownSegments

__all__ = ["MOST_EXPORT_BYTES", "export_response", "file_name"]

MOST_EXPORT_BYTES = 1 << 12
"""Of what a page asks for."""

ENDINGS: dict[Kind, str] = {
    "seg-nrrd": ".seg.nrrd",
    "labels": "",
    "scan": ".nii.gz",
    "dicom-seg": ".seg.dcm",
    "dicom-labelmap": ".labelmap.dcm",
    "rtstruct": ".rtstruct.dcm",
    "dicom": "",
}
"""Of names; those of several files, which come as an archive, have none."""


class WantedExport(msgspec.Struct, frozen=True):
    """What a page asks for."""

    kind: Kind
    keep_identity: bool = False


def export_response(segments: ShownSegments, values: NDArray[np.int16], body: bytes) -> Response:
    """Writes what a page asks for and answers with the file, or with why it was not written.

    What was left out or lost stands in the header ``X-Palpate-Notes``, a line each, in percent
    encoding.
    """
    if len(body) > MOST_EXPORT_BYTES:
        return _refusal(f"{len(body)} bytes given; allowed: {MOST_EXPORT_BYTES}")
    try:
        wanted = msgspec.json.decode(body, type=WantedExport)
    except msgspec.DecodeError as error:
        return _refusal(f"this is no export: {error}")
    folder = TemporaryDirectory(prefix="palpate-")
    try:
        path, notes = _write(segments, values, wanted, folder=Path(folder.name))
    except (PalpateError, OSError, RuntimeError, MemoryError) as error:
        folder.cleanup()
        return _refusal(str(error) or "not enough memory")
    return FileResponse(
        path,
        media_type="application/octet-stream",
        filename=path.name,
        headers={"X-Palpate-Notes": quote("\n".join(notes)[:1000])},
        background=BackgroundTask(folder.cleanup),
    )


def _write(
    segments: ShownSegments, values: NDArray[np.int16], wanted: WantedExport, *, folder: Path
) -> tuple[Path, list[str]]:
    scene, notes = segments.scene(values)
    shared = wanted.kind == "dicom" and not wanted.keep_identity
    name = "shared" if shared else file_name(scene.volume.name)
    ending = ENDINGS[wanted.kind]
    target = folder / f"{name}{ending}"
    if wanted.kind == "labels":
        target = folder / name / "labels.nii.gz"
        target.parent.mkdir()
    notes += export_scene(
        scene, target, kind=wanted.kind, keep_identity=wanted.keep_identity or bool(ending)
    )
    if ending:
        return target, notes
    packed = shutil.make_archive(str(folder / name), "zip", folder / name)
    return Path(packed), notes


def file_name(scan: str) -> str:
    """Returns a name for a file of a scan; that of a scan may name the patient."""
    plain = re.sub(r"[^\w.-]+", "-", scan, flags=re.ASCII).strip("-.")[:60]
    return plain or "shared"


def _refusal(reason: str) -> Response:
    return PlainTextResponse(reason, status_code=400)
