"""Journals that were set aside: a person wanted to begin afresh, or they could not be followed.

Each is a group of files beside the journals in use, under the name of its journal and the moment
when it was set aside. They are kept for some months, and the newest ones within a limit of bytes.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path

import msgspec

from palpate.base.errors import OptionError
from palpate.base.file_lock import FileLock
from palpate.base.state_folder import keep, kept, state_folder
from palpate.volumes.volume import Volume

__all__ = [
    "KEPT_DAYS",
    "SetAside",
    "folder_of_journals",
    "lock_of",
    "note_scan",
    "put_aside",
    "remove_old",
    "set_aside",
]

KEPT_DAYS = 90
MOST_BYTES = 1 << 30
"""Of all that are set aside."""
JOURNAL, SECOND, STEPS, SCAN = ".journal", ".second", ".steps", ".scan"
"""Endings of the files of a journal: changes, second scan, steps of segments, which scan it is."""
PARTS = (JOURNAL, SECOND, STEPS, SCAN)
MOMENT = "%Y%m%d-%H%M%S-%f"
NAME = re.compile(r"([0-9a-f]{32})-(\d{8}-\d{6}-\d{6})")


class NotedScan(msgspec.Struct, frozen=True):
    """Which scan a journal is of."""

    name: str
    path: str | None
    """Where it was read from; None where it was made."""

    @property
    def place(self) -> Path | None:
        """Where it is; None where it is not there any more, such as one dropped on the page."""
        found = None if self.path is None else Path(self.path)
        return found if found is not None and found.exists() else None


@dataclass(frozen=True)
class SetAside:
    """A journal that was set aside."""

    name: str
    """The moment when it was, which tells it from others."""
    files: tuple[Path, ...]
    scan: NotedScan | None
    """None for those of earlier versions."""

    @property
    def when(self) -> datetime:
        """Local time when it was set aside."""
        return datetime.strptime(self.name, MOMENT).astimezone()

    @property
    def until(self) -> datetime:
        """Local time until which it is kept, if there is room."""
        return self.when + timedelta(days=KEPT_DAYS)

    @property
    def changed(self) -> datetime:
        """Local time of its last change."""
        newest = max(path.stat().st_mtime for path in self.files)
        return datetime.fromtimestamp(newest).astimezone()

    @property
    def bytes(self) -> int:
        """Size of its files."""
        return sum(path.stat().st_size for path in self.files)

    def restore(self) -> None:
        """Puts it back, so that the next start with its scan offers it.

        What is offered now is set aside in its place.

        Raises:
            OptionError: A session of the scan runs.
        """
        place = self.files[0]
        of_scan = place.with_name(f"{place.name[:32]}{JOURNAL}")
        lock = FileLock.take(lock_of(of_scan))
        if lock is None:
            raise OptionError("its scan is open in another session; allowed: once that has ended")
        try:
            put_aside(of_scan)
            of_scan.with_suffix(".saved").unlink(missing_ok=True)
            for path in self.files:
                path.rename(of_scan.with_suffix(path.suffix))
        finally:
            lock.let_go()

    def remove(self) -> None:
        """Removes it for good."""
        for path in self.files:
            path.unlink(missing_ok=True)


def folder_of_journals(folder: Path | None = None) -> Path:
    """Returns where journals lie; by default in the state's folder."""
    return (folder or state_folder()) / "journals"


def lock_of(journal: Path) -> Path:
    """Returns the lock that the session has which writes a journal, or offers it."""
    return journal.with_suffix(".lock")


def note_scan(journal: Path, volume: Volume) -> None:
    """Notes beside a journal which scan it is of."""
    source = None if volume.source is None else str(volume.source.path)
    keep(journal.with_suffix(SCAN), NotedScan(volume.name, source))


def set_aside(folder: Path | None = None) -> list[SetAside]:
    """Returns what is set aside, the newest first."""
    groups: dict[str, list[Path]] = {}
    place = folder_of_journals(folder)
    for path in sorted(place.iterdir()) if place.is_dir() else ():
        if NAME.fullmatch(path.stem) and path.suffix in PARTS:
            groups.setdefault(path.stem, []).append(path)
    found = [
        SetAside(stem[33:], tuple(files), kept(place / f"{stem}{SCAN}", NotedScan))
        for stem, files in groups.items()
    ]
    return sorted(found, key=lambda one: one.name, reverse=True)


def put_aside(journal: Path, parts: Iterable[str] = PARTS) -> Path | None:
    """Sets aside the files of a journal that are there; returns the first one, if any.

    Raises:
        OSError: They cannot be renamed.
    """
    moment = datetime.now().astimezone().strftime(MOMENT)
    there = [path for part in parts if (path := journal.with_suffix(part)).exists()]
    # which scan it is of is nothing by itself
    if all(path.suffix == SCAN for path in there):
        return None
    renamed = [path.rename(path.with_name(f"{path.stem}-{moment}{path.suffix}")) for path in there]
    return renamed[0]


def remove_old(folder: Path | None = None) -> int:
    """Removes what was set aside too long ago, or is beyond the limit; returns how many."""
    removed, size, now = 0, 0, datetime.now().astimezone()
    for one in set_aside(folder):
        size += one.bytes
        # the one that was set aside last stays, however large it is
        if now > one.until or (size > MOST_BYTES and size > one.bytes):
            one.remove()
            removed += 1
    return removed
