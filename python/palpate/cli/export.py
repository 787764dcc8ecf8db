"""The command ``palpate export``: a scan's segments, or the scan, as files for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from palpate.base.console import Display, quiet_libraries, warn
from palpate.cli.options import AnotherPatient, Resample, Segments
from palpate.cli.reading_options import Reading, with_reading

if TYPE_CHECKING:
    from palpate.export.export import Kind
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


@with_reading
def export(
    path: Annotated[
        Path,
        typer.Argument(
            help="Scan, as for `palpate open`, or a saved .palpate scene.",
            metavar="PATH",
        ),
    ],
    *,
    out: Annotated[
        Path,
        typer.Option(
            "--out",
            "-o",
            help="Output: .seg.nrrd, .nii.gz, .nrrd, .mha or .dcm file, or a new folder for DICOM.",
            metavar="OUT",
        ),
    ],
    kind: Annotated[
        str | None,
        typer.Option(
            "--as",
            help="Format: seg-nrrd, labels, scan, dicom-seg, dicom-labelmap, rtstruct or "
            "dicom (all DICOM objects); by default it follows from the name of the "
            "output.",
        ),
    ] = None,
    segments: Segments = None,
    resample: Resample = False,
    another_patient: AnotherPatient = False,
    threshold: Annotated[
        str | None,
        typer.Option(help="Make a segment of the values from LOW to HIGH.", metavar="LOW[,HIGH]"),
    ] = None,
    only: Annotated[
        list[str] | None, typer.Option(help="Export only the segment with this name; repeatable.")
    ] = None,
    keep_identity: Annotated[
        bool,
        typer.Option(
            "--keep-identity",
            help="Keep the patient's identity in DICOM and refer to the original series.",
        ),
    ] = False,
    reading: Reading,
) -> None:
    """Writes what was asked for and says what it is."""
    from palpate.base.errors import OptionError
    from palpate.base.typed_numbers import parse_threshold
    from palpate.cli.scenes import edited_saved_scene, wanted_scene
    from palpate.export.export import export_scene
    from palpate.saved.opening import is_scene

    bounds = parse_threshold(threshold)
    saved = is_scene(path)
    if saved and (reading != Reading() or segments is not None or bounds is not None):
        raise OptionError(f"{path} is a scene: options of scans are allowed with scans only")
    has_segments = saved or segments is not None or bounds is not None
    known = _check_target(out, kind, has_segments=has_segments, keep_identity=keep_identity)
    with quiet_libraries(), Display() as display:
        if saved:
            scene = edited_saved_scene(path, display)
        else:
            volume = reading.read(path, display)
            for warning in volume.warnings:
                warn(warning)
            scene = wanted_scene(
                volume,
                bounds=bounds,
                label_map=segments,
                resample=resample,
                another_patient=another_patient,
                progress=display,
            )
        notes = export_scene(
            scene, out, kind=known, only=only, keep_identity=keep_identity, progress=display
        )
    _print_result(scene, out, notes)


export.__doc__ = EXAMPLES


def _check_target(out: Path, kind: str | None, *, has_segments: bool, keep_identity: bool) -> Kind:
    """Returns what is to be written; refuses what could not be, before a scan is read.

    Raises:
        OptionError: The kind is not known, or does not fit the name.
    """
    from palpate.base.errors import OptionError
    from palpate.export.export import KINDS, check_export, kind_of

    if kind is not None and kind not in KINDS:
        raise OptionError(f"--as {kind} given; allowed: {', '.join(KINDS)}")
    known = kind_of(out, has_segments=has_segments) if kind is None else kind
    check_export(out, known, keep_identity=keep_identity)
    return known


def _print_result(scene: Scene, out: Path, notes: list[str]) -> None:
    """Says what was written."""
    for note in notes:
        warn(note)
    files = sum(1 for file in out.rglob("*") if file.is_file()) if out.is_dir() else 1
    what = f"{files} files" if files > 1 else f"{out.stat().st_size / 2**20:.1f} MiB"
    typer.echo(f"{out}: {what}, of {len(scene)} segments in {scene.volume.name}")
