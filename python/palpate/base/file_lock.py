"""A lock that a process holds by an open file; the system lets go of it when the process ends."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from pathlib import Path

__all__ = ["FileLock"]


class FileLock:
    """A lock that is held until it is let go of, or until nobody knows it any more."""

    def __init__(self, path: Path, descriptor: int) -> None:
        """Takes over an open file that is locked; see ``take``."""
        self.path = path
        self._descriptor: int | None = descriptor

    @classmethod
    def take(cls, path: Path, *, new: bool = True) -> FileLock | None:
        """Takes the lock at a path; returns None where another one has it.

        Args:
            path: Of the file, which is made where it is not there.
            new: Whether it may be made.

        Raises:
            OSError: The file cannot be opened.
        """
        while True:
            descriptor = os.open(path, os.O_RDWR | (os.O_CREAT if new else 0), 0o600)
            if not _locked(descriptor):
                os.close(descriptor)
                return None
            if _is_at(descriptor, path):
                return cls(path, descriptor)
            # whoever had it has removed the file
            os.close(descriptor)

    def let_go(self) -> None:
        """Removes the file, and lets go of the lock."""
        with suppress(OSError):
            self.path.unlink()
        self._close()
        if sys.platform == "win32":
            # there a file that is open stays
            with suppress(OSError):
                self.path.unlink()

    def _close(self) -> None:
        if self._descriptor is not None:
            os.close(self._descriptor)
            self._descriptor = None

    def __del__(self) -> None:
        self._close()


def _is_at(descriptor: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(descriptor), path.stat())
    except OSError:
        return False


def _locked(descriptor: int) -> bool:
    try:
        if sys.platform == "win32":
            import msvcrt

            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
