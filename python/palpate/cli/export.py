"""The command ``palpate export``: a scan's segments, or the scan, as files for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.base.console import Display, quiet_libraries, warn
from palpate.cli.options import Resample, Segments
from palpate.cli.reading_options import Reading, with_reading

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
    from palpate.cli.export_run import check_target, saved_scene, tell_export
    from palpate.cli.scenes import wanted_scene
    from palpate.export.export import export_scene
    from palpate.saved.opening import is_scene

    bounds = parse_threshold(threshold)
    saved = is_scene(path)
    if saved and (reading != Reading() or segments is not None or bounds is not None):
        raise OptionError(f"{path} is a scene: options of scans are allowed with scans only")
    has_segments = saved or segments is not None or bounds is not None
    known = check_target(out, kind, has_segments=has_segments, keep_identity=keep_identity)
    with quiet_libraries(), Display() as display:
        if saved:
            scene = saved_scene(path, display)
        else:
            volume = reading.read(path, display)
            for warning in volume.warnings:
                warn(warning)
            scene = wanted_scene(
                volume, bounds=bounds, label_map=segments, resample=resample, progress=display
            )
        told = export_scene(
            scene, out, kind=known, only=only, keep_identity=keep_identity, progress=display
        )
    tell_export(scene, out, told)


export.__doc__ = EXAMPLES
