"""Files and folders that appear under their name only once they are complete.

Until then, an existing file of that name stays as it is, even where the disk is full. What may be
replaced at all, ``replacing`` says.
"""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from uuid import uuid4

from palpate.base.errors import OptionError
from palpate.base.replacing import check_replaceable

__all__ = ["check_target", "is_unfinished", "whole_file", "whole_folder"]


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Yields a temporary file beside a path, with the same extension; then renames it to the path.

    A link stays, and what it leads to is written. Who could not read a file that is replaced cannot
    read the new one.

    Raises:
        OptionError: A file is there that must not be replaced.
        OSError: The file cannot be written; nothing is left behind then.
    """
    check_replaceable(path)
    target = path.resolve() if path.is_symlink() else path
    unfinished = _beside(target)
    try:
        yield unfinished
        with unfinished.open("rb") as written:
            os.fsync(written.fileno())
        # another program may have made it meanwhile
        check_replaceable(path)
        if target.exists():
            unfinished.chmod(unfinished.stat().st_mode & target.stat().st_mode)
        unfinished.replace(target)
    finally:
        unfinished.unlink(missing_ok=True)


@contextmanager
def whole_folder(path: Path) -> Iterator[Path]:
    """Yields a temporary folder beside a path; then renames it to the path.

    Raises:
        OptionError: There are files at the path already.
        OSError: The folder cannot be written; nothing is left behind then.
    """
    if path.exists() and not (path.is_dir() and not any(path.iterdir())):
        raise OptionError(f"{path} is there already; allowed: a new folder, or an empty one")
    unfinished = _beside(path)
    unfinished.mkdir()
    try:
        yield unfinished
        for written in unfinished.rglob("*"):
            if written.is_file():
                with written.open("rb") as file:
                    os.fsync(file.fileno())
        if path.exists():
            path.rmdir()
        unfinished.rename(path)
    finally:
        shutil.rmtree(unfinished, ignore_errors=True)


def _beside(path: Path) -> Path:
    return path.with_name(f".{uuid4().hex[:8]}-{path.name}")


def is_unfinished(found: Path, name: str) -> bool:
    """Says whether a path is that of a file or folder of this name in the making."""
    return re.fullmatch(rf"\.[0-9a-f]{{8}}-{re.escape(name)}", found.name) is not None


def check_target(path: Path, suffixes: tuple[str, ...]) -> None:
    """Refuses a file that could not be written, before anything is computed.

    Raises:
        OptionError: The extension is not known, or the folder does not exist.
    """
    if not path.name.lower().endswith(suffixes):
        raise OptionError(f"{path.name!r} given; allowed: a name with {', '.join(suffixes)}")
    if not path.parent.is_dir():
        raise OptionError(f"folder {str(path.parent)!r} given; allowed: one that exists")
