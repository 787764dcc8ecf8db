"""The command ``palpate import``: what files or a server hold, and a scan of them in one file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import msgspec
import typer

from palpate.base.console import Display, quiet_libraries
from palpate.cli.options import AnotherPatient, Resample
from palpate.cli.request_options import with_requests
from palpate.cli.written_files import WRITES
from palpate.io.request import ReadRequest

if TYPE_CHECKING:
    from palpate.cli.import_scan_run import Writing
    from palpate.io.dicomweb.address import WebAddress
    from palpate.io.dicomweb.series import RemoteSeries
    from palpate.volumes.volume import Volume

__all__ = ["EXAMPLES", "import_scan"]

EXAMPLES = """\b
Examples:
  palpate import ct/                                (lists the scans)
  palpate import study.zip --series 2 -o ct.nii.gz
  palpate import slices/*.dcm -o ct.nrrd
  palpate import ct/ --segments seg.dcm -o ct.nrrd  (and ct.seg.nrrd)
  palpate import ct/ --segments seg.dcm -o ct.palpate
  palpate import raw/ --raw 256x256,int16,big --voxel-size 1,1,2 -o h.mha
  palpate import --dicomweb http://127.0.0.1:8042/dicom-web
  palpate import --dicomweb http://host/dicom-web --series 2 -o ct.nii.gz
  palpate import --dicomweb https://name:password@host/dicom-web -o ct
  palpate import --dicomweb 'https://host/dicom-web/studies?PatientID=12345'

Without --output it lists the scans, or describes a single one: its size, and what was resampled,
missing or left out. An output file appears only when it is complete.
"""


@with_requests
def import_scan(  # noqa: PLR0913  # one per option of the command line
    paths: Annotated[
        list[Path] | None,
        typer.Argument(
            help="DICOM folder, files or zip archive; NIfTI, NRRD, MetaImage or MINC file; "
            "folder of PNG or TIFF slices.",
            metavar="PATH",
        ),
    ] = None,
    *,
    dicomweb: Annotated[
        str | None,
        typer.Option(
            help="Address of a DICOMweb server; may include /studies/UID/series/UID or "
            "search terms.",
            metavar="URL",
        ),
    ] = None,
    study: Annotated[str | None, typer.Option(help="UID of the study, with --dicomweb.")] = None,
    volume: Annotated[
        str | None,
        typer.Option(
            help="Number of the volume, with --dicomweb, if a series holds several, such "
            "as time points."
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "--out",
            "-o",
            help="Output: .nii.gz, .nii, .nrrd or .mha file; a .palpate scene that "
            "contains the scan; with --dicomweb also a new folder for the DICOM "
            "files.",
            metavar="OUT",
        ),
        WRITES,
    ] = None,
    segments: Annotated[
        Path | None,
        typer.Option(
            help="Segments: label map, .seg.nrrd, DICOM SEG, RTSTRUCT, or a folder of "
            "masks. Stored in the scene, or next to the scan as .seg.nrrd."
        ),
    ] = None,
    resample: Resample = False,
    another_patient: AnotherPatient = False,
    reading: ReadRequest,
    every: Annotated[
        bool, typer.Option("--all", help="List every volume of a series that holds many.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """List the scans in files or on a DICOMweb server, and convert or download one."""
    from palpate.base.errors import OptionError
    from palpate.cli.import_scan_run import Writing, check_target
    from palpate.io.dicomweb.address import WebAddress

    given = paths or []
    if (dicomweb is None) == (not given):
        what = "no place" if dicomweb is None else "a path and --dicomweb"
        raise OptionError(f"{what} given; allowed: PATH…, or --dicomweb URL")
    if dicomweb is None and not study is volume is None:
        raise OptionError("--study or --volume given; allowed: with --dicomweb only")
    if segments is not None and not segments.exists():
        raise FileNotFoundError(f"{segments} does not exist; allowed: a file with segments")
    target = None if output is None else check_target(output, paths=given, segments=segments)
    if segments is not None and target in {None, "folder"}:
        raise OptionError("--segments given; allowed: with --output FILE")
    series = None if reading.series is None else str(reading.series)
    if dicomweb is not None:
        # it chooses among those of the server; of what is brought, the volume
        reading = msgspec.structs.replace(reading, series=volume)
    writing = None
    if output is not None and target is not None:
        writing = Writing(
            out=output,
            target=target,
            segments=segments,
            resample=resample,
            another_patient=another_patient,
        )
    if dicomweb is None:
        _import_files(given, reading, writing, every=every, as_json=as_json)
        return
    if target in {None, "folder"} and reading != ReadRequest():
        raise OptionError("options of reading given; allowed: with --output FILE")
    address = WebAddress.of(dicomweb, study=study)
    if writing is not None and writing.target == "folder":
        _import_folder(address, series, writing.out, as_json=as_json)
    else:
        _import_remote(address, series, reading=reading, writing=writing, as_json=as_json)


def _import_files(
    paths: list[Path],
    reading: ReadRequest,
    writing: Writing | None,
    *,
    every: bool,
    as_json: bool,
) -> None:
    from palpate.cli.import_scan_run import read_or_list, write_import
    from palpate.cli.series import of_choices

    files: list[dict[str, Any]] = []
    with quiet_libraries(), Display() as display:
        found = read_or_list(paths, reading, choose=writing is not None, progress=display)
        if writing is not None and not isinstance(found, list):
            files = write_import(found, writing, progress=display)
    if isinstance(found, list):
        rows = of_choices(found)
        _tell_list(rows, parts=None if every else [one.part for one in found], as_json=as_json)
    else:
        _tell_scan(found, files, as_json=as_json)


def _import_remote(
    address: WebAddress,
    series: str | None,
    *,
    reading: ReadRequest,
    writing: Writing | None,
    as_json: bool,
) -> None:
    from palpate.cli.import_scan_run import read_remote, write_import
    from palpate.io.dicomweb.series import choose_remote, remote_series

    with quiet_libraries(), Display() as display:
        listed = remote_series(address, progress=display)
        if writing is not None or series is not None:
            listed = [choose_remote(address, listed, series)]
        if writing is not None:
            volume = read_remote(address, listed[0], reading, progress=display)
            files = write_import(volume, writing, progress=display)
    if writing is None:
        _tell_list([_of_remote(*each) for each in enumerate(listed, 1)], as_json=as_json)
    else:
        _tell_scan(volume, files, as_json=as_json)


def _import_folder(address: WebAddress, series: str | None, out: Path, *, as_json: bool) -> None:
    from palpate.cli.import_scan_run import bring
    from palpate.io.dicomweb.series import choose_remote, remote_series

    with quiet_libraries(), Display() as display:
        listed = remote_series(address, progress=display)
        one = choose_remote(address, listed, series)
        brought = bring(address, one, out, progress=display)
    if as_json:
        _print_json(brought)
        return
    then = f"palpate open {out} shows them"
    if brought["volumes"] > 1:
        then = f"palpate import {out} lists their {brought['volumes']} volumes"
    size = brought["bytes"] / 2**20
    typer.echo(f"{brought['files']} files, {size:.1f} MiB, are in {out}: {then}")


# --- what is said -----------------------------------------------------------------------


def _tell_list(
    rows: list[dict[str, Any]], *, as_json: bool, parts: list[str] | None = None
) -> None:
    from palpate.cli.series import folded, print_series

    if as_json:
        _print_json(rows)
    else:
        print_series(rows if parts is None else folded(rows, parts))


def _tell_scan(volume: Volume, files: list[dict[str, Any]], *, as_json: bool) -> None:
    from palpate.cli.info import describe, print_table

    if as_json:
        _print_json(describe(volume) | {"written": files})
        return
    print_table(volume)
    for file in files:
        typer.echo(f"{file['file']}: {file['bytes'] / 2**20:.1f} MiB, {file['holds']}")


def _of_remote(number: int, one: RemoteSeries) -> dict[str, Any]:
    columns, rows, slices = one.size or (None, None, None)
    return {
        "number": number,
        "patient": one.patient,
        "study": one.study_told,
        "series": one.description,
        "modality": one.modality,
        "slices": slices,
        "columns": columns,
        "rows": rows,
        "files": one.files,
        "bytes": one.bytes,
        "study_uid": one.study,
        "uid": one.uid,
    }


def _print_json(content: object) -> None:
    import json

    typer.echo(json.dumps(content, indent=2))
