"""The folder of the program's state, and small JSON files in it.

A damaged file counts as missing; where a file cannot be written, nothing is remembered.
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
    """Returns the folder: ``PALPATE_STATE``, or the user's folder for state."""
    if given := os.environ.get("PALPATE_STATE"):
        return Path(given)
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Application Support" / "palpate"
    if sys.platform == "win32" and (local := os.environ.get("LOCALAPPDATA")):
        return Path(local) / "palpate"
    return Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state") / "palpate"


def kept(path: Path, form: type[T]) -> T | None:
    """Returns the content of a file in the folder; None where it is missing or damaged."""
    try:
        return msgspec.json.decode(path.read_bytes(), type=form)
    except (OSError, msgspec.DecodeError):
        return None


def keep(path: Path, value: object) -> None:
    """Writes a file in the folder, completely or not at all."""
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        with whole_file(path) as unfinished:
            unfinished.write_bytes(msgspec.json.encode(value))
