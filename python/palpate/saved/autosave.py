"""Autosaves of scenes whose file is damaged, found by the name of the file.

An autosave is the journal of the scene's scan. The scan of a scene is noted when its file is
written or opened, in a JSON file in the folder of the program's state.
"""

from __future__ import annotations

import re
import shlex
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import msgspec

from palpate.base.errors import SceneFormatError
from palpate.base.progress import Progress
from palpate.base.state_folder import keep, kept, state_folder
from palpate.saved.journal import journal_place
from palpate.saved.scene_file import kept_scan
from palpate.saved.scene_scan import SavedScan, check_same, linked_scan, places_of
from palpate.volumes.volume import Volume

__all__ = ["Autosave", "autosave_of", "note_scene", "with_autosave"]

MOST = 100


class NotedScene(msgspec.Struct, frozen=True):
    """A scene file and its scan."""

    name: str
    """Name of the file when it was last written or opened."""
    path: str | None
    """None for a file that a page saved: only the browser knows where it is."""
    scan: SavedScan


@dataclass(frozen=True)
class Autosave:
    """An autosave of a scene."""

    path: Path
    """Path of the scene file."""
    scan: SavedScan
    when: datetime
    """Local time of the last change."""

    @property
    def place(self) -> Path | None:
        """Where its scan is; None where that is not known."""
        return next((each for each in places_of(self.path, self.scan) if each.exists()), None)

    @property
    def command(self) -> str | None:
        """Command that recovers it; None where the place of its scan is not known."""
        if self.place is None:
            return None
        words = ["palpate", "open", str(self.place)]
        for name, value in self.scan.options.items():
            given = ",".join(map(str, value)) if isinstance(value, list | tuple) else str(value)
            words += [f"--{name.replace('_', '-')}", given]
        return shlex.join([*words, "--recover"])

    def read(self, progress: Progress) -> Volume:
        """Reads its scan with the options of the scene.

        Raises:
            SceneFormatError: The scan is missing or has changed.
            PalpateError: The scan cannot be read.
        """
        volume = linked_scan(self.path, self.scan, progress)
        check_same(self.path, volume, self.scan)
        return volume


def note_scene(scan: SavedScan, path: Path, *, passing: bool = False) -> None:
    """Notes the scan of the scene at a path; of a ``passing`` one only the name."""
    place = None if passing else str(path.resolve())
    newest = NotedScene(path.name, place, _with_place(scan))
    others = [one for one in _noted() if (one.name, one.path) != (newest.name, newest.path)]
    keep(_file(), [newest, *others][:MOST])


def autosave_of(path: Path) -> Autosave | None:
    """Returns the last autosave of the scene at a path; None where there is none.

    The scan is read from the file itself first: its beginning may be intact.
    """
    for scan in (kept_scan(path), *_scans_noted(path)):
        if scan is None:
            continue
        with suppress(OSError, ValueError):
            journal = journal_place(bytes.fromhex(scan.hash))
            when = datetime.fromtimestamp(journal.stat().st_mtime).astimezone()
            return Autosave(path, _with_place(scan), when)
    return None


def with_autosave(error: SceneFormatError, path: Path) -> SceneFormatError:
    """Returns why a scene cannot be opened, and how to open its last autosave."""
    kept = autosave_of(path)
    if kept is None:
        return error
    way = (
        f"once its scan {kept.scan.name!r} is opened again, the page offers it"
        if kept.command is None
        else f"{kept.command} brings it back"
    )
    return SceneFormatError(
        f"{error}; the last autosave of this scene is from {kept.when:%d %B %Y, %H:%M}: {way}"
    )


def _scans_noted(path: Path) -> list[SavedScan]:
    """Returns scans of scenes at a path, then those of scenes with that name elsewhere."""
    noted, place = _noted(), str(path.resolve())
    here = [one.scan for one in noted if one.path == place]
    return here or [one.scan for one in noted if _plain(one.name) == _plain(path.name)]


def _with_place(scan: SavedScan) -> SavedScan:
    """Returns a reference with the place of the scan where only a note has it, and not the file."""
    known = (one.scan for one in _noted() if one.scan.hash == scan.hash and one.scan.path)
    return scan if scan.path is not None else next(known, scan)


def _plain(name: str) -> str:
    """Returns a name without the number that browsers append to a second file of that name."""
    return re.sub(r" ?\(\d+\)(?=\.[^.]*$)", "", name)


def _file() -> Path:
    return state_folder() / "scenes.json"


def _noted() -> list[NotedScene]:
    return kept(_file(), list[NotedScene]) or []
