"""Memory that is freed goes back to the system, also in a process that runs for days."""

from __future__ import annotations

import ctypes
import sys
from contextlib import suppress

__all__ = ["give_freed_memory_back"]

_LARGE_BLOCK = 4 << 20
"""Blocks from here on are mapped one by one [bytes]; pieces of scans and pictures are larger."""
_MOST_ARENAS = 4
_TOP_KEPT = 32 << 20
"""What may stay free at the end of an arena [bytes]."""
# parameters of mallopt(3), from malloc.h of glibc
_TRIM_THRESHOLD, _MMAP_THRESHOLD, _ARENA_MAX = -1, -3, -8


def give_freed_memory_back() -> None:
    """Has the C library give large blocks back as soon as they are freed.

    By itself glibc takes blocks of up to 32 MiB from the same arenas as small ones once some were
    freed, and has eight arenas a core: after 30 scans, opened one after another by as many threads,
    their holes took more than the scan that was open. Other C libraries have no such settings.
    """
    if sys.platform != "linux":
        return
    with suppress(AttributeError):
        mallopt = ctypes.CDLL(None).mallopt
        mallopt(_MMAP_THRESHOLD, _LARGE_BLOCK)
        mallopt(_TRIM_THRESHOLD, _TOP_KEPT)
        mallopt(_ARENA_MAX, _MOST_ARENAS)
