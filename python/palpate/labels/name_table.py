"""Where the table of names of a label map lies: beside it, one for each file.

``pat.1.nii.gz`` has ``pat.1.csv``, or ``pat.1.nii.gz.csv`` where another image is called
``pat.1`` too. Version 0.1 wrote ``pat.csv``; that is read where no other image may mean it.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

__all__ = ["ENDINGS", "table_beside", "tables_beside"]

ENDINGS = (".nii.gz", ".nii", ".nrrd", ".mha", ".mhd", ".mnc", ".mgz", ".mgh")
"""Of images that may be label maps."""


def table_beside(image: Path) -> Path:
    """Returns the table to write for an image."""
    whole = image.with_name(f"{image.name}.csv")
    stem = _stem(image.name)
    others = (image.with_name(stem + ending) for ending in ENDINGS)
    if whole.exists() or any(other != image and other.exists() for other in others):
        return whole
    return image.with_name(f"{stem}.csv")


def tables_beside(image: Path) -> Iterator[Path]:
    """Lists the tables that may hold an image's names, its own ones first."""
    stem, first = _stem(image.name), image.name.split(".")[0]
    yield image.with_name(f"{image.name}.csv")
    yield image.with_name(f"{stem}.csv")
    if stem != first and not _shared(image, first):
        yield image.with_name(f"{first}.csv")
    yield image.with_name("structures.csv")


def _stem(name: str) -> str:
    """Returns a name without the ending of its format."""
    for ending in ENDINGS:
        if name.lower().endswith(ending):
            return name[: -len(ending)]
    return name


def _shared(image: Path, first: str) -> bool:
    """Says whether other images have the same first part of their name."""
    return any(
        other != image and other.name.lower().endswith(ENDINGS)
        for other in image.parent.iterdir()
        if other.name.split(".")[0] == first
    )
