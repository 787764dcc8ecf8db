"""The command ``palpate export``: a scan's segments, or the scan, as files for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from palpate.base.console import Display, quiet_libraries, warn
from palpate.cli.options import AnotherPatient, Resample, ScanOrScene, Segments
from palpate.cli.request_options import with_requests
from palpate.export.request import ExportRequest
from palpate.io.request import ReadRequest

if TYPE_CHECKING:
    from palpate.export.kinds import Kind
    from palpate.volumes.scene import Scene

__all__ = ["export"]

EXAMPLES = """Export segments, or a scan with its edits, for other programs.

The name of the output decides the format, unless --as overrides it:

\b
  palpate export scan.nii.gz --segments organs.seg.nrrd -o labels.nii.gz
  palpate export work.palpate -o work.seg.nrrd     (a saved scene)
  palpate export work.palpate --as scan -o drilled.nii.gz
  palpate export ct/ --threshold 250 -o shared     (a new folder)
  palpate export ct/ --threshold 250 --keep-identity -o seg.dcm
  palpate export ct/ --threshold 250 --keep-identity --as rtstruct -o rt.dcm

A folder receives scan and segments as DICOM, de-identified together so that
references stay valid. Use --keep-identity for the archive that holds the scan.
"""


@with_requests
def export(
    path: ScanOrScene,
    *,
    request: ExportRequest,
    segments: Segments = None,
    resample: Resample = False,
    another_patient: AnotherPatient = False,
    threshold: Annotated[
        str | None,
        typer.Option(help="Make a segment of the values from LOW to HIGH.", metavar="LOW[,HIGH]"),
    ] = None,
    reading: ReadRequest,
) -> None:
    """Writes what was asked for and says what it is."""
    from palpate.base.early_imports import DICOM_WRITING, IMAGE_WRITING, import_early
    from palpate.base.errors import OptionError
    from palpate.base.replacing import check_replaceable
    from palpate.base.typed_numbers import parse_threshold
    from palpate.cli.scenes import scene_at
    from palpate.export.kinds import FROM_DICOM
    from palpate.saved.ending import is_scene

    bounds = parse_threshold(threshold)
    has_segments = is_scene(path) or segments is not None or bounds is not None
    kind = request.kind_for(has_segments=has_segments)
    if not has_segments and kind not in {"scan", "dicom"}:
        raise OptionError(
            "no segments given; allowed: --segments FILE or --threshold LOW,HIGH, or a saved scene"
        )
    if kind == "labels" and (table := request.table(())) is not None:
        check_replaceable(table)
    import_early(DICOM_WRITING if kind in FROM_DICOM else IMAGE_WRITING)
    with quiet_libraries(), Display() as display:
        scene = scene_at(
            path,
            reading,
            bounds=bounds,
            label_map=segments,
            resample=resample,
            another_patient=another_patient,
            progress=display,
        )
        from palpate.export.export import export_scene

        notes = export_scene(
            scene,
            request.out,
            kind=kind,
            only=request.only,
            keep_identity=request.keep_identity,
            pixels_checked=request.pixels_checked,
            progress=display,
        )
    _print_result(scene, request.out, notes, written=_written(scene, kind, request.only))


export.__doc__ = EXAMPLES


def _written(scene: Scene, kind: Kind, only: list[str] | None) -> list[str]:
    """Returns the names of the segments that were written."""
    from palpate.export.masks import written_segments

    if kind == "scan" or len(scene) == 0:
        return []
    return [one.name for one in written_segments(scene, only)[0]]


def _print_result(scene: Scene, out: Path, notes: list[str], *, written: list[str]) -> None:
    """Says what was written, and of how many segments."""
    for note in notes:
        warn(note)
    files = sum(1 for file in out.rglob("*") if file.is_file()) if out.is_dir() else 1
    what = f"{files} files" if files > 1 else f"{out.stat().st_size / 2**20:.1f} MiB"
    some = 0 < len(written) < len(scene)
    which = f"{len(written)} of {len(scene)} segments"
    which += f" ({', '.join(written)})" if some else ""
    typer.echo(f"{out}: {what}, {which} in {scene.volume.name}")
