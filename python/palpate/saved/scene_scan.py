"""Scans of scene files: linked, by their path, or copied, as their stored values.

A link holds the path of the scan, absolute and relative to the scene file, the options with which
it was read, and a hash of it. A copied scan has no path and no options: whoever has the file needs
neither, and they may name a patient, or the person whose folder it was.
"""

from __future__ import annotations

import os
import zipfile
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import PalpateError, SceneFormatError
from palpate.base.progress import Progress
from palpate.io.reading import read
from palpate.saved.scene_archive import check_size, member
from palpate.volumes.scan_hash import scan_hash
from palpate.volumes.volume import Volume, VolumeTraits

__all__ = [
    "SavedScan",
    "check_same",
    "copied_scan",
    "exact_member",
    "linked_scan",
    "places_of",
    "saved_scan",
]

EXACT_TYPES = ("|u1", "|i1", "<u2", "<i2", "<u4", "<i4", "<u8", "<i8", "<f4", "<f8")
"""Types of the values that are kept beside stored ones."""


class SavedGrid(msgspec.Struct, frozen=True, omit_defaults=True):
    """Geometry of a copied scan, and the meaning of its numbers."""

    dimensions: tuple[int, int, int]
    spacing: tuple[float, float, float]
    origin: tuple[float, float, float]
    direction: list[list[float]]
    slope: float
    intercept: float
    modality: str
    unit: str
    orientation_known: bool
    exact: str = ""
    """Type of the values that are kept as they were read, as NumPy names it; "" without any."""


class SavedScan(msgspec.Struct, frozen=True):
    """Reference to a scan in a scene file."""

    name: str
    hash: str
    path: str | None
    beside: str | None
    """Path relative to the scene file."""
    options: dict[str, Any]
    """Options of ``palpate.read`` with which it was read, of any of the types that it takes."""
    grid: SavedGrid
    copied: bool


def saved_scan(volume: Volume, path: Path, *, copied: bool) -> SavedScan:
    """Returns a file's reference to a scan, ``copied`` where the file contains its values."""
    source = None if copied else volume.source
    return SavedScan(
        name=volume.name,
        hash=scan_hash(volume).hex(),
        path=None if source is None else str(source.path),
        beside=None if source is None else _seen_from(path.parent, source.path),
        options={} if source is None else dict(source.options),
        grid=SavedGrid(
            dimensions=volume.dimensions,
            spacing=volume.spacing,
            origin=volume.origin,
            direction=volume.direction.tolist(),
            slope=volume.slope,
            intercept=volume.intercept,
            modality=volume.modality,
            unit=volume.unit,
            orientation_known=volume.traits.orientation_known,
            exact="" if volume.exact is None else volume.exact.dtype.newbyteorder("<").str,
        ),
        copied=copied,
    )


def copied_scan(path: Path, archive: zipfile.ZipFile, scan: SavedScan, *, values: str) -> Volume:
    """Returns a scan whose ``values`` are a member of the archive at ``path``.

    Raises:
        SceneFormatError: The member is damaged.
    """
    grid = scan.grid
    stored = _array(path, archive, grid, name=values, kind="<i2")
    kept = None
    if grid.exact:
        if grid.exact not in EXACT_TYPES:
            raise SceneFormatError(
                f"{path}: values of type {grid.exact!r} given; allowed: {', '.join(EXACT_TYPES)}"
            )
        kept = _array(path, archive, grid, name=exact_member(values), kind=grid.exact)
    try:
        return Volume(
            stored,
            spacing=grid.spacing,
            origin=grid.origin,
            direction=grid.direction,
            slope=grid.slope,
            intercept=grid.intercept,
            exact=kept,
            traits=VolumeTraits(
                name=scan.name,
                modality=grid.modality,
                unit=grid.unit,
                orientation_known=grid.orientation_known,
            ),
        )
    except PalpateError as error:
        raise SceneFormatError(f"{path}: {error}") from None


def exact_member(values: str) -> str:
    """Returns the name of the member with the values that a scan's stored ones are rounded from."""
    return f"{values.partition('.')[0]}.exact"


def _array(
    path: Path, archive: zipfile.ZipFile, grid: SavedGrid, *, name: str, kind: str
) -> NDArray[Any]:
    """Returns the numbers of a member, on the grid and in the machine's order of bytes."""
    width, height, depth = grid.dimensions
    check_size(path, archive, name, exact=np.dtype(kind).itemsize * width * height * depth)
    array = np.frombuffer(member(path, archive, name), kind).reshape(depth, height, width)
    return array.astype(array.dtype.newbyteorder("="), copy=False)


def places_of(path: Path, scan: SavedScan) -> list[Path]:
    """Returns possible paths of the scan of the file at ``path``, the relative one first.

    Scan and file may have been moved together.
    """
    places = [path.resolve().parent / scan.beside] if scan.beside is not None else []
    return places + ([Path(scan.path)] if scan.path is not None else [])


def linked_scan(path: Path, scan: SavedScan, progress: Progress) -> Volume:
    """Reads a linked scan.

    Raises:
        SceneFormatError: The scan is at neither path.
        PalpateError: The scan cannot be read.
    """
    places = places_of(path, scan)
    for place in places:
        if place.exists():
            return read(place, **scan.options, progress=progress)
    looked = " and ".join(str(place) for place in places) or "nowhere"
    raise SceneFormatError(
        f"{path}: the scan {scan.name!r} is not there any more (looked at {looked}); allowed: "
        "put it back, or save scenes with their scan"
    )


def check_same(path: Path, volume: Volume, scan: SavedScan) -> None:
    """Refuses a scan that has changed.

    Raises:
        SceneFormatError: The scan has changed.
    """
    if scan_hash(volume).hex() != scan.hash:
        raise SceneFormatError(
            f"{path}: the scan {scan.name!r} is not as it was when the scene was saved; "
            "allowed: the same scan, or a scene that was saved with its scan"
        )


def _seen_from(folder: Path, place: Path) -> str | None:
    try:
        return Path(os.path.relpath(place, folder.resolve())).as_posix()
    except ValueError:
        # another drive
        return None
