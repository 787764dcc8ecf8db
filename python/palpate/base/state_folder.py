"""The folder of the program's state, and small JSON files in it.

A damaged file counts as none; a disk that refuses one only means that nothing is remembered.
"""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from pathlib import Path
from typing import TypeVar

import msgspec

from palpate.base.whole_file import whole_file

__all__ = ["keep", "kept", "state_folder"]

T = TypeVar("T")


def state_folder() -> Path:
    """Returns where state is kept: ``PALPATE_STATE``, or the user's folder for state."""
    if given := os.environ.get("PALPATE_STATE"):
        return Path(given)
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Application Support" / "palpate"
    if sys.platform == "win32" and (local := os.environ.get("LOCALAPPDATA")):
        return Path(local) / "palpate"
    return Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state") / "palpate"


def kept(path: Path, form: type[T]) -> T | None:
    """Returns what a file of the folder holds; None where it is not there, or damaged."""
    try:
        return msgspec.json.decode(path.read_bytes(), type=form)
    except (OSError, msgspec.DecodeError):
        return None


def keep(path: Path, value: object) -> None:
    """Writes a file of the folder, all of it or nothing."""
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        with whole_file(path) as unfinished:
            unfinished.write_bytes(msgspec.json.encode(value))
