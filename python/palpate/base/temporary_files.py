"""One folder for all temporary files of a command, which nothing outlives.

Scans that were dropped on the page, unpacked archives and downloads lie in it. It is locked for as
long as its process lives: what one left that was killed is removed by the next start, and never the
files of one that lives. Only the user can enter it.
"""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from palpate.base.file_lock import FileLock

__all__ = ["OF_A_COMMAND", "SYSTEM_FOLDER", "temporary_files"]

SYSTEM_FOLDER = Path(tempfile.gettempdir())
OF_A_COMMAND = "palpate-files-"
"""What the names of these folders begin with; eight letters follow."""
LOCK = "lock"


@contextmanager
def temporary_files() -> Iterator[None]:
    """Has all temporary files of this process lie in a folder that goes with it.

    Where none can be made they lie where the system has them.
    """
    before = tempfile.tempdir
    folder: Path | None = None
    lock: FileLock | None = None
    # Ctrl-C may come at any of these lines
    try:
        with suppress(OSError):
            folder = Path(tempfile.mkdtemp(prefix=OF_A_COMMAND))
            lock = FileLock.take(folder / LOCK)
            # or another start took it for one that was left
            if lock is not None:
                _sweep(folder.parent)
                tempfile.tempdir = str(folder)
        yield
    finally:
        tempfile.tempdir = before
        if folder is not None:
            _remove(folder, lock)


def _sweep(place: Path) -> None:
    """Removes what processes of this user have left that do not live any more."""
    with suppress(OSError), os.scandir(place) as entries:
        for entry in entries:
            # one of them may go just now, or be no such folder
            with suppress(OSError):
                if entry.name.startswith(OF_A_COMMAND) and _is_own_folder(entry):
                    lock = FileLock.take(Path(entry.path) / LOCK, new=False)
                    if lock is not None:
                        _remove(Path(entry.path), lock)


def _is_own_folder(entry: os.DirEntry[str]) -> bool:
    if not entry.is_dir(follow_symlinks=False):
        return False
    return sys.platform == "win32" or entry.stat(follow_symlinks=False).st_uid == os.getuid()


def _remove(folder: Path, lock: FileLock | None) -> None:
    """Removes a folder, locked to the end."""
    shutil.rmtree(folder, ignore_errors=True)
    if lock is not None:
        lock.let_go()
    # a file that is open cannot be removed everywhere
    shutil.rmtree(folder, ignore_errors=True)
