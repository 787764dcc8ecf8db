"""What a case is made of, so that a rerun knows whether it has changed: recipe and files."""

from __future__ import annotations

import json
from collections.abc import Sequence
from hashlib import file_digest, sha256
from pathlib import Path
from typing import Any

from palpate.base.request_files import files_of
from palpate.recipes.recipe import recipe_of
from palpate.recipes.source import Source
from palpate.recipes.steps import steps_of

__all__ = ["inputs_of", "recipe_hash", "same_inputs", "told_inputs"]


def recipe_hash(source: Source) -> str:
    """Returns the hash of what a recipe says, variables filled in; comments do not count."""
    text = json.dumps(source.given, sort_keys=True, default=str)
    return sha256(text.encode()).hexdigest()


def inputs_of(source: Source) -> list[Path]:
    """Returns the files and folders that a recipe reads and does not write itself."""
    recipe = recipe_of(source)
    read: list[Path] = []
    written: set[Path] = set()
    for _, step in steps_of(recipe):
        for option, path in files_of(step):
            (read.append if option.reads else written.add)(path)
    return sorted({path.absolute() for path in read if path not in written})


def told_inputs(paths: Sequence[Path]) -> list[dict[str, Any]]:
    """Returns size, time and hash of each file, those of folders too.

    Raises:
        OSError: A file cannot be read.
    """
    told = []
    for path in _files(paths):
        # its time first: what changes while it is read is seen as changed later
        state = path.stat()
        with path.open("rb") as file:
            digest = file_digest(file, "sha256").hexdigest()
        told.append(_told(path, state.st_size, state.st_mtime_ns) | {"sha256": digest})
    return told


def same_inputs(paths: Sequence[Path], told: object) -> bool:
    """Says whether files are as they were; only what has another time is read for that."""
    if not isinstance(told, list):
        return False
    before = {each["path"]: each for each in told}
    files = _files(paths)
    if {str(path) for path in files} != set(before):
        return False
    for path in files:
        state, old = path.stat(), before[str(path)]
        if state.st_size != old["bytes"]:
            return False
        if state.st_mtime_ns != old["modified_ns"]:
            with path.open("rb") as file:
                if file_digest(file, "sha256").hexdigest() != old["sha256"]:
                    return False
    return True


def _told(path: Path, size: int, modified: int) -> dict[str, Any]:
    return {"path": str(path), "bytes": size, "modified_ns": modified}


def _files(paths: Sequence[Path]) -> list[Path]:
    found: set[Path] = set()
    for path in paths:
        if path.is_dir():
            found |= {each for each in path.rglob("*") if each.is_file()}
        elif path.is_file():
            found.add(path)
    return sorted(found)
