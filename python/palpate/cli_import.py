"""The command ``palpate import``: scans of a DICOMweb server, listed and brought here."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from palpate.console import Display, quiet_libraries

if TYPE_CHECKING:
    from palpate.io_dicomweb import RemoteSeries

__all__ = ["EXAMPLES", "import_scan"]

EXAMPLES = """\b
Examples:
  palpate import --dicomweb http://127.0.0.1:8042/dicom-web
  palpate import --dicomweb http://127.0.0.1:8042/dicom-web --series 2 -o ct
  palpate import --dicomweb https://name:password@host/dicom-web --study 1.2.3
  palpate import --dicomweb 'https://host/dicom-web/studies?PatientID=12345'
  palpate open ct
"""


def import_scan(
    *,
    dicomweb: Annotated[
        str,
        typer.Option(
            help="Address of the service; it may go on with /studies/UID/series/UID, or with what "
            "is searched for.",
            metavar="URL",
        ),
    ],
    study: Annotated[str | None, typer.Option(help="UID of the study.")] = None,
    series: Annotated[
        str | None, typer.Option(help="The series: its UID, description or number in the list.")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "-o",
            help="New folder for its files; without it series are listed.",
            metavar="FOLDER",
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """List the scans of a DICOMweb server, or bring one here."""
    from palpate.io_dicomweb import choose_remote, fetch_series, remote_series
    from palpate.io_dicomweb_address import WebAddress
    from palpate.whole_file import whole_folder

    address = WebAddress.of(dicomweb, study=study)
    with quiet_libraries(), Display() as display:
        listed = remote_series(address, progress=display)
        chosen = None if out is None and series is None else choose_remote(address, listed, series)
        files = 0
        if chosen is not None and out is not None:
            with whole_folder(out) as folder:
                files = fetch_series(address, chosen, folder, progress=display)
    if chosen is None or out is None:
        _tell_list(listed if chosen is None else [chosen], as_json=as_json)
    else:
        _tell_fetched(chosen, out, files, as_json=as_json)


def _tell_list(listed: list[RemoteSeries], *, as_json: bool) -> None:
    from palpate.cli_series import print_series

    found = [_described(number, one) for number, one in enumerate(listed, 1)]
    if as_json:
        _print_json(found)
    else:
        print_series(found)


def _tell_fetched(one: RemoteSeries, out: Path, files: int, *, as_json: bool) -> None:
    size = sum(path.stat().st_size for path in out.iterdir())
    if as_json:
        _print_json({"folder": str(out), "uid": one.uid, "files": files, "bytes": size})
    else:
        typer.echo(
            f"{files} files, {size / 2**20:.1f} MiB, are in {out}: palpate open {out} shows them"
        )


def _described(number: int, one: RemoteSeries) -> dict[str, Any]:
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
