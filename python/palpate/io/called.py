"""What messages call the files of a scan."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

__all__ = ["called_of"]


def called_of(paths: Sequence[Path]) -> Path:
    """Returns what messages call several files: the folder that all of them are in."""
    if len(paths) == 1:
        return paths[0]
    folders = (path if path.is_dir() else path.parent for path in paths)
    return Path(os.path.commonpath([folder.absolute() for folder in folders]))
