"""The command ``palpate export``: a scan's segments, or the scan, as files for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.base.console import Display, quiet_libraries, warn
from palpate.cli.options import Resample, Segments
from palpate.cli.reading_options import Reading, with_reading

__all__ = ["export"]

EXAMPLES = """Write segments, or a scan with its edits, for other programs.

The name says what is written; --as says so where it does not:

\b
  palpate export scan.nii.gz --segments organs.seg.nrrd -o labels.nii.gz
  palpate export work.palpate -o work.seg.nrrd     (a scene that was saved)
  palpate export work.palpate --as scan -o drilled.nii.gz
  palpate export ct/ --threshold 250 -o shared     (a new folder)
  palpate export ct/ --threshold 250 --keep-identity -o seg.dcm
  palpate export ct/ --threshold 250 --keep-identity --as rtstruct -o rt.dcm

DICOM goes into a folder, scan and segments together, de-identified so that
their references hold. --keep-identity is for the archive that has the scan.
"""


@with_reading
def export(
    path: Annotated[
        Path,
        typer.Argument(
            help="A scan, as for `palpate open`, or a .palpate scene that was saved.",
            metavar="PATH",
        ),
    ],
    *,
    out: Annotated[
        Path,
        typer.Option(
            "--out",
            "-o",
            help=".seg.nrrd, .nii.gz, .nrrd, .mha, .dcm, or a new folder for DICOM.",
            metavar="OUT",
        ),
    ],
    kind: Annotated[
        str | None,
        typer.Option(
            "--as",
            help="seg-nrrd, labels, scan, dicom-seg, dicom-labelmap, rtstruct or dicom (all of "
            "it); by default what the name asks for.",
        ),
    ] = None,
    segments: Segments = None,
    resample: Resample = False,
    threshold: Annotated[
        str | None, typer.Option(help="Values of a segment.", metavar="LOW[,HIGH]")
    ] = None,
    only: Annotated[
        list[str] | None, typer.Option(help="Name of a segment, again for more; by default all.")
    ] = None,
    keep_identity: Annotated[
        bool,
        typer.Option(
            "--keep-identity",
            help="DICOM names the patient and refers to the scan as it is in the archive.",
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
