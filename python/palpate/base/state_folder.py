"""The folder of the program's state, and small JSON files in it.

Journals and what is kept with scans tell of patients: only the user can read them, on systems where
files have modes. A damaged file counts as missing; where a file cannot be written, nothing is
remembered.
"""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from pathlib import Path
from typing import TypeVar

import msgspec

from palpate.base.whole_file import whole_file

__all__ = ["keep", "kept", "private_folder", "state_folder"]

T = TypeVar("T")


def state_folder() -> Path:
    """Returns the folder: ``PALPATE_STATE``, or the user's folder for state."""
    if given := os.environ.get("PALPATE_STATE"):
        return Path(given)
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Application Support" / "palpate"
    if sys.platform == "win32" and (local := os.environ.get("LOCALAPPDATA")):
        return Path(local) / "palpate"
    return Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state") / "palpate"


def private_folder(path: Path) -> Path:
    """Makes the state's folder, or one in it, so that no other user can enter it; returns it.

    Folders that an earlier version has made are closed too. A folder that was there before as
    ``PALPATE_STATE`` keeps its mode: it may hold other things.

    Raises:
        OSError: It cannot be made.
    """
    root = state_folder()
    if root == path or root in path.parents:
        root.mkdir(parents=True, exist_ok=True, mode=0o700)
    path.mkdir(parents=True, exist_ok=True, mode=0o700)
    if "PALPATE_STATE" not in os.environ or path != root:
        with suppress(OSError):
            path.chmod(0o700)
    return path


def kept(path: Path, form: type[T]) -> T | None:
    """Returns the content of a file in the folder; None where it is missing or damaged."""
    try:
        return msgspec.json.decode(path.read_bytes(), type=form)
    except (OSError, msgspec.DecodeError):
        return None


def keep(path: Path, value: object) -> None:
    """Writes a file in the folder, completely or not at all."""
    with suppress(OSError):
        private_folder(path.parent)
        with whole_file(path) as unfinished:
            unfinished.touch(mode=0o600)
            unfinished.write_bytes(msgspec.json.encode(value))
