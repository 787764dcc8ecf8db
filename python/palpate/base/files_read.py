"""Which files a command has read, itself or in its readers: its results replace none of them.

A file is known by its device and number there, so that links and other spellings of its path are
the same file.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

__all__ = ["Identity", "files_noted", "identity_of", "note_files", "note_read", "was_read"]

Identity = tuple[int, int]
"""Device, and number of the file on it."""

_noted: set[Identity] | None = None
"""None outside of commands."""


@contextmanager
def files_noted() -> Iterator[set[Identity]]:
    """Within it, files that are read are noted in the set that it yields, by any thread."""
    global _noted  # noqa: PLW0603  # threads that read have no context of their own
    before, _noted = _noted, set()
    try:
        yield _noted
    finally:
        _noted = before


def identity_of(path: str | os.PathLike[str]) -> Identity | None:
    """Returns what a file or folder is known by; None where there is none."""
    try:
        found = os.stat(path)  # noqa: PTH116  # of many files, as text
    except (OSError, ValueError):
        return None
    return found.st_dev, found.st_ino


def note_read(path: Path) -> None:
    """Notes that a file is read."""
    found = None if _noted is None else identity_of(path)
    if found is not None:
        note_files([found])


def note_files(files: Iterable[Identity]) -> None:
    """Notes that files are read."""
    if _noted is not None:
        _noted.update(files)


def was_read(path: Path) -> bool:
    """Says whether the running command has read a file."""
    return _noted is not None and identity_of(path) in _noted
