"""The name that a saved scene has."""

from __future__ import annotations

from pathlib import Path

__all__ = ["ENDING", "is_scene"]

ENDING = ".palpate"


def is_scene(path: Path) -> bool:
    """Returns whether a path is that of a scene file, by its extension."""
    return path.suffix == ENDING and path.is_file()
