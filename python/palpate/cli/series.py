"""``palpate series``: which scans a DICOM folder or archive holds, or volumes an image file."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from palpate.base.console import Display, quiet_libraries
from palpate.base.harmless_text import terminal

if TYPE_CHECKING:
    from palpate.io.browse import Choice
    from palpate.io.dicom.header import Series

__all__ = ["describe", "folded", "of_choices", "print_series", "series"]


def series(
    path: Annotated[
        Path,
        typer.Argument(
            help="DICOM folder or zip archive; image file of several volumes.", metavar="PATH"
        ),
    ],
    *,
    every: Annotated[
        bool, typer.Option("--all", help="List every volume of a series that holds many.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print a JSON list.")] = False,
) -> None:
    """List the series of a DICOM folder, or the volumes of an image file, as --frame takes them."""
    from palpate.base.errors import VolumeFormatError
    from palpate.io.archive import is_archive
    from palpate.io.browse import browsed
    from palpate.io.reading import list_series

    listed: Sequence[Series | Choice]
    with quiet_libraries(), Display() as display:
        if path.is_file() and not is_archive(path):
            with browsed(path, progress=display) as choices:
                if choices[0].refused is not None:
                    raise VolumeFormatError(choices[0].refused)
                listed, found = choices, of_choices(choices)
        else:
            listed = list_series(path, progress=display)
            found = [describe(number, one) for number, one in enumerate(listed, 1)]
    if as_json:
        import json

        typer.echo(json.dumps(found, indent=2))
    else:
        print_series(found if every else folded(found, [one.part for one in listed]))


def describe(number: int, one: Series) -> dict[str, Any]:
    """Returns what is known of a series, ready for JSON."""
    first = one.headers[0]
    return {
        "number": number,
        "patient": first.patient,
        "study": first.study_told,
        "series": one.description,
        "modality": one.modality,
        "slices": one.slices,
        "columns": first.columns,
        "rows": first.rows,
        "uid": one.uid,
    }


def of_choices(choices: Sequence[Choice]) -> list[dict[str, Any]]:
    """Returns what is known of scans, ready for JSON; volumes of one image file share a number."""
    rows: list[dict[str, Any]] = []
    number = 0
    for one in choices:
        number += one.frame in (None, 1)
        columns, lines, slices = one.size or (None, None, None)
        row = {
            "number": number,
            "patient": one.patient,
            "study": one.study,
            "series": one.name,
            "modality": one.modality,
            "slices": slices,
            "columns": columns,
            "rows": lines,
            "spacing_mm": None if one.spacing is None else list(one.spacing),
            "bytes": 2 * math.prod(one.size) if one.size else None,
            "uid": one.uid,
            "refused": one.refused,
        }
        rows.append(row if one.frame is None else row | {"frame": one.frame})
    return rows


def folded(found: list[dict[str, Any]], parts: Sequence[str]) -> list[dict[str, Any]]:
    """Returns rows of a list with many volumes of one series as one, by the ``parts`` they are."""
    from palpate.io.dicom.series_folds import folds

    wholes = [one["series"].removesuffix(part) for one, part in zip(found, parts, strict=True)]
    keys = [
        (one["uid"], whole) if part else None
        for one, whole, part in zip(found, wholes, parts, strict=True)
    ]
    rows = []
    for places in folds(keys):
        row = found[places[0]]
        if len(places) > 1:
            first, last = parts[places[0]], parts[places[-1]]
            numbers = f"{places[0] + 1} to {places[-1] + 1}"
            row = row | {
                "number": row["number"] if "frame" in row else numbers,
                "series": f"{wholes[places[0]]}{len(places)} volumes: {first} to {last}",
            }
        rows.append(row)
    return rows


def print_series(found: list[dict[str, Any]]) -> None:
    """Prints series as a table; a size that is not known is left out.

    A series that is ``refused`` says why below it.
    """
    from rich.table import Table

    table = Table(box=None, padding=(0, 2, 0, 0))
    for name in ("number", "patient", "study", "series", "modality", "size"):
        table.add_column(name, justify="right" if name == "number" else "left")
    for one in found:
        edges = one["columns"], one["rows"], one["slices"]
        size = "" if None in edges else " x ".join(map(str, edges))
        cells = (one["number"], one["patient"], one["study"], one["series"], one["modality"], size)
        table.add_row(*map(str, cells))
    console = terminal()
    console.print(table)
    for one in found:
        if one.get("refused"):
            said = f"{one['number']} cannot be read: {one['refused']}"
            console.print(said)
