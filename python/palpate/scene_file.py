"""Scene files: a scan, what was made in it, and how it is looked at, as one ``.palpate`` file.

A zip archive with

- ``scene.json``: which scan, what segments are called and look like, of what they are, the model by
  which matter gives way, and the page's view;
- ``segments.journal``: voxels of segments, edits of the scan, poses, feel, as the head of a journal
  (``crates/tools/src/journal_file.rs``);
- ``scan.i16``: the scan's stored values, x fastest, where the file is to stand alone.

Else the scan is a link: the place it was read from, as it is and seen from the file, and a hash.
"""

from __future__ import annotations

import os
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import msgspec
import numpy as np

from palpate.errors import PalpateError, SceneFormatError
from palpate.io import read
from palpate.journal import journal_place, scan_hash
from palpate.material import Material
from palpate.package_version import package_version
from palpate.progress import Progress, silent
from palpate.session import Session
from palpate.volume import Volume, VolumeTraits
from palpate.whole_file import whole_file

__all__ = ["ENDING", "SavedScene", "kept_changes", "open_scene", "save_scene"]

ENDING = ".palpate"
FORMAT = "palpate-scene-1"
MOST_JSON_BYTES = 1 << 24
"""Of ``scene.json``: 255 segments take some 100 kB."""
MOST_SEGMENTS_BYTES = 1 << 31
"""Of ``segments.journal``: all bones of a CT of the trunk take some 10 MB."""

ABOUT, SEGMENTS, SCAN = "scene.json", "segments.journal", "scan.i16"


class _Grid(msgspec.Struct, frozen=True):
    """Where a copied scan stands and what its numbers mean."""

    dimensions: tuple[int, int, int]
    spacing: tuple[float, float, float]
    origin: tuple[float, float, float]
    direction: list[list[float]]
    slope: float
    intercept: float
    modality: str
    unit: str
    orientation_known: bool


class _Scan(msgspec.Struct, frozen=True):
    name: str
    hash: str
    path: str | None
    beside: str | None
    """The same place, seen from the file."""
    options: dict[str, Any]
    """With which it was read."""
    grid: _Grid
    copied: bool


class _Material(msgspec.Struct, frozen=True):
    segment: int
    preset: str | None
    constants: list[float | None] | None
    """Fields of ``Material``; None is infinite."""


class _About(msgspec.Struct, frozen=True):
    format: str
    version: str
    scan: _Scan
    looks: msgspec.Raw
    materials: list[_Material]
    model: str | None
    edge: int | None
    view: dict[str, Any] | None


@dataclass(frozen=True)
class SavedScene:
    """A scene that was opened: its scan, and what is still to be brought into a session."""

    path: Path
    volume: Volume
    view: Mapping[str, Any] | None
    """What the page has kept of its view."""
    looks: bytes
    """Names and colours, as pages keep them."""
    about: _About

    def restore(self, session: Session) -> None:
        """Brings segments, edits and materials into a session of the scan that has none yet.

        Raises:
            SceneFormatError: The file is damaged.
        """
        with TemporaryDirectory(prefix="palpate-") as folder:
            journal = Path(folder) / SEGMENTS
            with _opened(self.path) as archive:
                journal.write_bytes(_member(self.path, archive, SEGMENTS))
            # else nobody would be told of the scan's own edits
            session.picture_changes()
            try:
                _, lost, _ = session.recover_journal(journal, scan_hash(self.volume))
            except (PalpateError, OSError) as error:
                raise SceneFormatError(f"{self.path}: {SEGMENTS} is damaged: {error}") from None
            session.end_journal()
        if lost:
            raise SceneFormatError(f"{self.path}: {SEGMENTS} is damaged: {lost} bytes are missing")
        for each in self.about.materials:
            session.set_material(each.segment, _given_material(each), undoable=False)
        session.set_deformation(self.about.model, edge=self.about.edge, undoable=False)


def save_scene(
    path: Path,
    session: Session,
    *,
    looks: bytes = b"[]",
    view: Mapping[str, Any] | None = None,
    copy: bool = False,
) -> None:
    """Writes a session's scene: all of the file, or none of it where that fails.

    Args:
        path: The file; one that is there is replaced once the new one is whole.
        session: What is saved, as it is now.
        looks: Names and colours, as pages keep them.
        view: What the page keeps of its view.
        copy: Whether the scan goes into the file; one that was read from no file always does.

    Raises:
        OSError: The disk refuses the file.
    """
    volume = session.scene.volume
    copied = copy or volume.source is None
    state = session.deformation()
    about = _About(
        format=FORMAT,
        version=package_version(),
        scan=_scan_of(volume, path, copied=copied),
        looks=msgspec.Raw(looks),
        materials=[made for each in session.segments() if (made := _material_of(each)) is not None],
        model=state["model"],
        edge=state["edge"],
        view=None if view is None else dict(view),
    )
    with TemporaryDirectory(prefix="palpate-") as folder:
        journal = Path(folder) / SEGMENTS
        session.keep_state(journal, scan_hash(volume))
        with (
            whole_file(path) as unfinished,
            zipfile.ZipFile(unfinished, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
        ):
            archive.writestr(ABOUT, msgspec.json.encode(about))
            archive.write(journal, SEGMENTS)
            if copied:
                archive.writestr(SCAN, volume.array.astype("<i2", copy=False).tobytes())


def open_scene(path: Path, *, progress: Progress = silent) -> SavedScene:
    """Opens a scene file and its scan.

    Raises:
        SceneFormatError: It is no scene, damaged, or its scan is not where it was.
    """
    with _opened(path) as archive:
        about = _about(path, archive)
        volume = (
            _copied_scan(path, archive, about.scan)
            if about.scan.copied
            else _linked_scan(path, about.scan, progress)
        )
    if scan_hash(volume).hex() != about.scan.hash:
        raise SceneFormatError(
            f"{path}: the scan {about.scan.name!r} is not as it was when the scene was saved; "
            "allowed: the same scan, or a scene that was saved with its scan"
        )
    return SavedScene(path, volume, about.view, bytes(about.looks), about)


def kept_changes(path: Path) -> tuple[str, datetime] | None:
    """Returns the scan of a damaged scene and when its journal was written last, in local time.

    None where the file does not tell its scan, or no journal of it is kept.
    """
    try:
        with _opened(path) as archive:
            scan = _about(path, archive).scan
        journal = journal_place(bytes.fromhex(scan.hash))
        when = datetime.fromtimestamp(journal.stat().st_mtime).astimezone()
    except (SceneFormatError, OSError, ValueError):
        return None
    return (scan.path or scan.name), when


def _scan_of(volume: Volume, path: Path, *, copied: bool) -> _Scan:
    source = volume.source
    return _Scan(
        name=volume.name,
        hash=scan_hash(volume).hex(),
        path=None if source is None else str(source.path),
        beside=None if source is None else _seen_from(path.parent, source.path),
        options={} if source is None else dict(source.options),
        grid=_Grid(
            dimensions=volume.dimensions,
            spacing=volume.spacing,
            origin=volume.origin,
            direction=volume.direction.tolist(),
            slope=volume.slope,
            intercept=volume.intercept,
            modality=volume.modality,
            unit=volume.unit,
            orientation_known=volume.traits.orientation_known,
        ),
        copied=copied,
    )


def _seen_from(folder: Path, place: Path) -> str | None:
    try:
        return Path(os.path.relpath(place, folder.resolve())).as_posix()
    except ValueError:
        # another drive
        return None


def _material_of(state: dict[str, Any]) -> _Material | None:
    material = state["material"]
    if material is None:
        return None
    if material["preset"] is not None:
        return _Material(segment=state["id"], preset=material["preset"], constants=None)
    constants = [number if np.isfinite(number) else None for number in material["low"]]
    return _Material(segment=state["id"], preset=None, constants=constants)


def _given_material(saved: _Material) -> Material | str | None:
    if saved.constants is None:
        return saved.preset
    return Material(*(np.inf if number is None else number for number in saved.constants))


def _opened(path: Path) -> zipfile.ZipFile:
    try:
        return zipfile.ZipFile(path)
    except zipfile.BadZipFile as error:
        raise SceneFormatError(
            f"{path} is no scene file, or a damaged one ({error}); allowed: a file that "
            "Palpate saved"
        ) from None


def _member(path: Path, archive: zipfile.ZipFile, name: str) -> bytes:
    try:
        return archive.read(name)
    except KeyError:
        raise SceneFormatError(f"{path}: {name} is missing; the file is damaged") from None
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as error:
        raise SceneFormatError(f"{path}: {name} is damaged: {error}") from None


def _about(path: Path, archive: zipfile.ZipFile) -> _About:
    # before anything of it is unpacked
    for name, most in ((ABOUT, MOST_JSON_BYTES), (SEGMENTS, MOST_SEGMENTS_BYTES)):
        if any(each.filename == name and each.file_size > most for each in archive.filelist):
            raise SceneFormatError(f"{path}: {name} is too large for a scene")
    text = _member(path, archive, ABOUT)
    try:
        found = msgspec.json.decode(text, type=dict[str, msgspec.Raw]).get("format")
        given = None if found is None else msgspec.json.decode(found)
        if given != FORMAT:
            raise SceneFormatError(f"{path}: format {given!r} given; allowed: {FORMAT!r}")
        return msgspec.json.decode(text, type=_About)
    except msgspec.DecodeError as error:
        raise SceneFormatError(f"{path}: {ABOUT} cannot be read: {error}") from None


def _copied_scan(path: Path, archive: zipfile.ZipFile, scan: _Scan) -> Volume:
    grid = scan.grid
    width, height, depth = grid.dimensions
    expected = 2 * width * height * depth
    # before anything of it is unpacked
    if any(each.filename == SCAN and each.file_size != expected for each in archive.filelist):
        raise SceneFormatError(f"{path}: {SCAN} is damaged: not {expected} bytes")
    values = np.frombuffer(_member(path, archive, SCAN), "<i2").reshape(depth, height, width)
    try:
        return Volume(
            values.astype(np.int16, copy=False),
            spacing=grid.spacing,
            origin=grid.origin,
            direction=grid.direction,
            slope=grid.slope,
            intercept=grid.intercept,
            traits=VolumeTraits(
                name=scan.name,
                modality=grid.modality,
                unit=grid.unit,
                orientation_known=grid.orientation_known,
            ),
        )
    except PalpateError as error:
        raise SceneFormatError(f"{path}: {error}") from None


def _linked_scan(path: Path, scan: _Scan, progress: Progress) -> Volume:
    """Reads the scan from where it is, seen from the file first: both may have been moved."""
    places = [path.resolve().parent / scan.beside] if scan.beside is not None else []
    places += [Path(scan.path)] if scan.path is not None else []
    for place in places:
        if place.exists():
            return read(place, **scan.options, progress=progress)
    looked = " and ".join(str(place) for place in places) or "nowhere"
    raise SceneFormatError(
        f"{path}: the scan {scan.name!r} is not there any more (looked at {looked}); allowed: "
        "put it back, or save scenes with their scan"
    )
