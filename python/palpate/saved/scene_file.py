"""Scene files: a scan, its segments and edits, and the view, as one ``.palpate`` file.

A zip archive with

- ``scene.json``: the scan, names, appearance and materials of segments, the deformation model, and
  the page's view;
- ``segments.journal``: voxels of segments, edits of the scan, poses and touch settings, as the head
  of a journal (``crates/tools/src/journal/file.rs``);
- ``steps.msgpack``: how segments are made, where that is known (``palpate.session.steps``);
- ``scan.i16``: the scan's stored values, x fastest, where the file is to be self-contained;
- ``second.i16``: those of a second scan that is shown with it;
- ``scan.exact``, ``second.exact``: the values themselves, where stored ones are rounded.

Otherwise scans are links (``scene_scan``).
"""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import msgspec

from palpate.base.damaged_file import damage_as
from palpate.base.errors import PalpateError, SceneFormatError
from palpate.base.package_version import package_version
from palpate.base.progress import Progress, silent
from palpate.base.whole_file import whole_file
from palpate.saved.scene_archive import check_whole, member, opened
from palpate.saved.scene_scan import (
    SavedScan,
    check_same,
    copied_scan,
    exact_member,
    linked_scan,
    saved_scan,
)
from palpate.saved.scene_soft_tissue import SavedSoftTissue, restore_soft_tissue, saved_soft_tissue
from palpate.saved.second_scan_note import SavedSecond, saved_second
from palpate.session.session import Session
from palpate.volumes.scan_hash import scan_hash
from palpate.volumes.scene import Scene
from palpate.volumes.second_scan import SecondScan
from palpate.volumes.volume import Volume

__all__ = ["SavedScene", "kept_scan", "open_scene", "save_scene"]

FORMAT = "palpate-scene-1"
MOST_JSON_BYTES = 1 << 24
"""Most bytes of ``scene.json``; 255 segments take about 100 kB."""
MOST_SEGMENTS_BYTES = 1 << 31
"""Most bytes of ``segments.journal``; all bones of a CT of the trunk take about 10 MB."""
MOST_STEPS_BYTES = 1 << 28
"""Most bytes of ``steps.msgpack``; the bones as a source of steps take about 2 MB."""

SAVED = "a file that Palpate saved"
ABOUT, SEGMENTS, STEPS = "scene.json", "segments.journal", "steps.msgpack"
SCAN, SECOND = "scan.i16", "second.i16"


class _About(SavedSoftTissue, frozen=True, kw_only=True):
    format: str
    version: str
    scan: SavedScan
    looks: msgspec.Raw
    view: dict[str, Any] | None
    """JSON of the page, which alone knows what is in it."""
    second: SavedSecond | None = None
    locked: tuple[int, ...] = ()
    """Numbers of locked segments."""
    labels: dict[int, int] = msgspec.field(default_factory=dict)
    """Labels of segments in the files that they were read from, by their numbers here."""
    save_id: str | None = None
    """What a journal knows this file by; None where none was written beside."""


@dataclass(frozen=True)
class SavedScene:
    """An opened scene file: its scan, and what is to be restored into a session."""

    path: Path
    volume: Volume
    view: Mapping[str, Any] | None
    """The page's view; its content is the page's own."""
    looks: bytes
    """Names and colours of segments, as ``palpate.session.appearance`` writes them."""
    about: _About
    second: SecondScan | None = None
    missing: str | None = None
    """Why the second scan is not shown; None where it is, or where there is none."""

    @property
    def scan(self) -> SavedScan:
        """Reference to its scan."""
        return self.about.scan

    @property
    def messages(self) -> tuple[str, ...]:
        """Messages on the reading for the user."""
        return (*self.volume.warnings, *(() if self.missing is None else (self.missing,)))

    def scene(self) -> Scene:
        """Returns its scans, without segments."""
        scene = Scene(self.volume)
        scene.second = self.second
        return scene

    def restore(self, session: Session) -> None:
        """Restores segments, edits and materials into a session of the scan without segments.

        Raises:
            SceneFormatError: The file is damaged.
        """
        with damage_as(SceneFormatError, f"{self.path} is damaged", allowed=SAVED):
            self._restore(session)

    def _restore(self, session: Session) -> None:
        with TemporaryDirectory(prefix="palpate-") as folder:
            journal = Path(folder) / SEGMENTS
            with opened(self.path) as archive:
                journal.write_bytes(member(self.path, archive, SEGMENTS))
                has_steps = STEPS in archive.namelist()
                steps = member(self.path, archive, STEPS) if has_steps else None
            # without this the scan's own edits are not reported
            session.picture_changes()
            try:
                _, lost, _ = session.recover_journal(journal, scan_hash(self.volume))
            except (PalpateError, OSError) as error:
                raise SceneFormatError(f"{self.path}: {SEGMENTS} is damaged: {error}") from None
            session.end_journal()
        if lost:
            raise SceneFormatError(f"{self.path}: {SEGMENTS} is damaged: {lost} bytes are missing")
        if steps is not None:
            try:
                session.restore_steps(steps)
            except PalpateError as error:
                raise SceneFormatError(f"{self.path}: {STEPS} is damaged: {error}") from None
        restore_soft_tissue(session, self.about)
        session.label_numbers.update(self.about.labels)
        for each in self.about.locked:
            session.set_locked(each, locked=True)


def save_scene(
    path: Path,
    session: Session,
    *,
    looks: bytes = b"[]",
    view: Mapping[str, Any] | None = None,
    copy: bool = False,
    save_id: str | None = None,
) -> SavedScan:
    """Writes the scene of a session, completely or not at all.

    Args:
        path: The file; an existing one is replaced once the new one is complete.
        session: The session, in its current state.
        looks: Names and colours of segments, as ``palpate.session.appearance`` writes them.
        view: The page's view.
        copy: Whether the file contains the scans; it always contains those that were not read from
            a file.
        save_id: What the journal of the session knows the file by.

    Returns:
        The reference to the scan, with its place on this machine also where the file has none.

    Raises:
        OSError: The file cannot be written.
    """
    volume = session.scene.volume
    second = session.scene.second
    copied = copy or volume.source is None
    second_copied = second is not None and (copy or second.volume.source is None)
    about = _About(
        format=FORMAT,
        version=package_version(),
        scan=saved_scan(volume, path, copied=copied),
        looks=msgspec.Raw(looks),
        view=None if view is None else dict(view),
        second=None if second is None else saved_second(second, path, copied=second_copied),
        locked=tuple(each["id"] for each in session.segments() if each["locked"]),
        labels=dict(session.label_numbers),
        save_id=save_id,
        **msgspec.structs.asdict(saved_soft_tissue(session)),
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
            if (steps := session.kept_steps()) is not None:
                archive.writestr(STEPS, steps)
            if copied:
                _write_values(archive, SCAN, volume)
            if second is not None and second_copied:
                _write_values(archive, SECOND, second.volume)
    return saved_scan(volume, path, copied=False) if copied else about.scan


def open_scene(path: Path, *, progress: Progress = silent) -> SavedScene:
    """Opens a scene file and its scan.

    Raises:
        SceneFormatError: The file is not a scene, is damaged, or its scan is missing.
    """
    with damage_as(SceneFormatError, f"{path} is damaged", allowed=SAVED), opened(path) as archive:
        about = _about(path, archive)
        # before a scan that is open makes room for this one
        for name in {SEGMENTS, STEPS} & {SEGMENTS, *archive.namelist()}:
            check_whole(path, archive, name)
        volume = _scan(path, archive, about.scan, values=SCAN, progress=progress)
        second, missing = _second(path, archive, about.second, progress=progress)
    return SavedScene(path, volume, about.view, bytes(about.looks), about, second, missing)


def kept_scan(path: Path) -> SavedScan | None:
    """Returns the reference to the scan of a damaged scene; None where it cannot be read."""
    try:
        with opened(path) as archive:
            return _about(path, archive).scan
    except (SceneFormatError, OSError):
        return None


def _scan(
    path: Path, archive: zipfile.ZipFile, scan: SavedScan, *, values: str, progress: Progress
) -> Volume:
    volume = (
        copied_scan(path, archive, scan, values=values)
        if scan.copied
        else linked_scan(path, scan, progress)
    )
    check_same(path, volume, scan)
    return volume


def _second(
    path: Path, archive: zipfile.ZipFile, kept: SavedSecond | None, *, progress: Progress
) -> tuple[SecondScan | None, str | None]:
    """Returns the second scan, or why it is not shown: the rest is shown without it."""
    if kept is None:
        return None, None
    matrix = kept.matrix(path)
    try:
        volume = _scan(path, archive, kept.scan, values=SECOND, progress=progress)
    except (PalpateError, OSError) as error:
        if kept.scan.copied:
            raise
        return None, f"the second scan is not shown: {error}"
    return SecondScan(volume, matrix), None


def _write_values(archive: zipfile.ZipFile, name: str, volume: Volume) -> None:
    archive.writestr(name, volume.array.astype("<i2", copy=False).tobytes())
    if (exact := volume.exact) is not None:
        little = exact.astype(exact.dtype.newbyteorder("<"), copy=False)
        archive.writestr(exact_member(name), little.tobytes())


def _about(path: Path, archive: zipfile.ZipFile) -> _About:
    # before anything of it is unpacked
    limits = {ABOUT: MOST_JSON_BYTES, SEGMENTS: MOST_SEGMENTS_BYTES, STEPS: MOST_STEPS_BYTES}
    for name, most in limits.items():
        if any(each.filename == name and each.file_size > most for each in archive.filelist):
            raise SceneFormatError(f"{path}: {name} is too large for a scene")
    text = member(path, archive, ABOUT)
    try:
        found = msgspec.json.decode(text, type=dict[str, msgspec.Raw]).get("format")
        given = None if found is None else msgspec.json.decode(found)
        if given != FORMAT:
            raise SceneFormatError(f"{path}: format {given!r} given; allowed: {FORMAT!r}")
        return msgspec.json.decode(text, type=_About)
    except (msgspec.DecodeError, RecursionError) as error:
        raise SceneFormatError(f"{path}: {ABOUT} cannot be read: {error}") from None
