"""Where the table of names of a label map lies: beside it, one for each file.

``pat.1.nii.gz`` has ``pat.1.csv``, or ``pat.1.nii.gz.csv`` where another image is called
``pat.1`` too, or ``pat.1.csv`` is something else. Version 0.1 wrote ``pat.csv``; that is read where
no other image may mean it.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator
from pathlib import Path

__all__ = ["ENDINGS", "NAMES", "NUMBERS", "table_beside", "tables_beside"]

ENDINGS = (".nii.gz", ".nii", ".nrrd", ".mha", ".mhd", ".mnc", ".mgz", ".mgh")
"""Of images that may be label maps."""
NAMES = ("structure", "name", "label", "segment")
NUMBERS = ("id", "value", "index", "number")
"""Columns of a table."""
COMMON = "structures.csv"
"""The names of all label maps of a folder."""


def table_beside(image: Path, *, planned: Iterable[Path] = ()) -> Path:
    """Returns the table to write for an image; it replaces no file but the image's own table.

    Args:
        image: The image, which need not be there yet.
        planned: Other files that will be there by then.
    """
    whole = image.with_name(f"{image.name}.csv")
    own = image.with_name(f"{_stem(image.name)}.csv")
    folder = image.parent.resolve()
    there = [*folder.iterdir(), *(path for path in planned if path.resolve().parent == folder)]
    shared = any(_means(other, own) for other in there if other.name != image.name)
    if shared or whole.exists() or own.name == COMMON:
        return whole
    if own.exists() and not (image.exists() and _holds_names(own)):
        return whole
    return own


def tables_beside(image: Path) -> Iterator[Path]:
    """Lists the tables that may hold an image's names, its own ones first."""
    stem, first = _stem(image.name), image.name.split(".")[0]
    yield image.with_name(f"{image.name}.csv")
    yield image.with_name(f"{stem}.csv")
    if stem != first and not _shared(image, first):
        yield image.with_name(f"{first}.csv")
    yield image.with_name(COMMON)


def _stem(name: str) -> str:
    """Returns a name without the ending of its format."""
    for ending in ENDINGS:
        if name.lower().endswith(ending):
            return name[: -len(ending)]
    return name


def _means(image: Path, table: Path) -> bool:
    """Says whether a table may hold the names of an image, by their names."""
    tables = (f"{image.name}.csv", f"{_stem(image.name)}.csv")
    return image.name.lower().endswith(ENDINGS) and table.name in tables


def _holds_names(table: Path) -> bool:
    with table.open(encoding="utf-8-sig", errors="replace", newline="") as file:
        try:
            head = {cell.strip().lower() for cell in next(csv.reader(file), [])}
        except csv.Error:
            return False
    return not head.isdisjoint(NUMBERS) and not head.isdisjoint(NAMES)


def _shared(image: Path, first: str) -> bool:
    """Says whether other images have the same first part of their name."""
    return any(
        other != image and other.name.lower().endswith(ENDINGS)
        for other in image.parent.iterdir()
        if other.name.split(".")[0] == first
    )
