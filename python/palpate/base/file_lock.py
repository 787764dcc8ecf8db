"""A lock that a process holds by an open file; the system lets go of it when the process ends."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from pathlib import Path
from typing import IO

__all__ = ["let_go", "taken"]


def taken(path: Path, *, new: bool = True) -> IO[bytes] | None:
    """Takes the lock at a path; returns its file, or None where another one has it.

    Args:
        path: Of the file, which is made where it is not there.
        new: Whether it may be made.

    Raises:
        OSError: The file cannot be opened.
    """
    while True:
        file = path.open("ab" if new else "r+b")
        if not _locked(file):
            file.close()
            return None
        if _is_at(file, path):
            return file
        # whoever had it has removed the file
        file.close()


def let_go(file: IO[bytes], path: Path) -> None:
    """Removes the file of a lock, and lets go of it."""
    with suppress(OSError):
        path.unlink()
    file.close()
    if sys.platform == "win32":
        # there a file that is open stays
        with suppress(OSError):
            path.unlink()


def _is_at(file: IO[bytes], path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(file.fileno()), path.stat())
    except OSError:
        return False


def _locked(file: IO[bytes]) -> bool:
    try:
        if sys.platform == "win32":
            import msvcrt

            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
