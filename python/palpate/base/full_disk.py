"""What a person is told where a disk has no space left."""

from __future__ import annotations

import errno

__all__ = ["is_full_disk", "told_of"]

NO_SPACE = tuple(getattr(errno, name) for name in ("ENOSPC", "EDQUOT") if hasattr(errno, name))
"""What the system says: no space on the disk, or of one's share of it."""


def is_full_disk(error: BaseException) -> bool:
    """Says whether an error is that the disk is full."""
    return isinstance(error, OSError) and error.errno in NO_SPACE


def told_of(error: BaseException) -> str:
    """Returns what is said of an error."""
    if is_full_disk(error):
        return "no space is left on the disk; the same command, once there is, goes on"
    return str(error)
