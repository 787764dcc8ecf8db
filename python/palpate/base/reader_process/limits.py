"""What a worker may take, and what it tells of its work; outside of workers nothing happens here.

Memory is 1.5 GiB, 24 bytes for each voxel that a checked header promises, and 32 for each byte of
the file; without a sign of progress it has 30 s, and a second for 10 million voxels or 5 MB.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from typing import Any

__all__ = [
    "BUSY",
    "PATIENCE",
    "SECONDS_PER_BYTE",
    "SECONDS_PER_VOXEL",
    "Telling",
    "begin",
    "end",
    "expect",
    "held",
    "in_this_process",
    "inside",
    "looking_at",
    "room_for",
]

MEMORY = 3 << 29
"""Beside what voxels and files need [bytes]."""
BYTES_PER_VOXEL, BYTES_PER_BYTE = 24, 32
PATIENCE = 30.0
"""Without a sign of progress, beside what voxels and files need [s]."""
SECONDS_PER_VOXEL, SECONDS_PER_BYTE = 1e-7, 2e-7

BUSY = "busy"
"""Tells a worker that the machine has other work while it waits."""

Telling = Callable[[tuple[Any, ...]], None]
"""Sends what a worker tells."""


class _State:
    """Of the call that a worker answers."""

    tell: Telling | None = None
    """None outside of workers."""
    limited = False
    """Whether memory is counted."""
    begun = 0
    """Memory before the call [bytes]."""
    file_bytes = 0
    numbers = count()


def inside() -> bool:
    """Says whether this is a worker."""
    return _State.tell is not None


def in_this_process() -> None:
    """Has files read in this process from now on, which is one for that purpose alone."""
    _State.tell = lambda _: None


def room_for(voxels: int, file_bytes: int) -> int:
    """Returns how much memory may be taken [bytes]."""
    return MEMORY + BYTES_PER_VOXEL * voxels + BYTES_PER_BYTE * file_bytes


def begin(tell: Telling, *, file_bytes: int) -> None:
    """Begins a call in a worker."""
    _State.tell, _State.limited = tell, True
    _State.begun, _State.file_bytes = held(), file_bytes
    _limit(room_for(0, file_bytes))


def end() -> None:
    """Ends a call in a worker: what it sends may be as large as it is."""
    _limit(None)


def expect(voxels: int) -> None:
    """Allows the memory and time that so many voxels need, once a header is known to be true."""
    if _State.tell is not None:
        _State.tell(("expect", voxels))
    if _State.limited:
        _limit(room_for(voxels, _State.file_bytes))


@contextmanager
def looking_at(path: Path, kind: str) -> Iterator[None]:
    """Tells which file is being read, and as what, for a message if that ends the worker."""
    tell = _State.tell
    if tell is None:
        yield
        return
    number = next(_State.numbers)
    tell(("at", number, str(path), kind))
    try:
        yield
    finally:
        tell(("left", number))


def held() -> int:
    """Returns the memory that this process has for data [bytes]; 0 where that is not told."""
    try:
        return int(Path("/proc/self/statm").read_text("ascii").split()[5]) * _page()
    except OSError:
        return 0


def _page() -> int:
    import resource

    return resource.getpagesize()


def _limit(room: int | None) -> None:
    """Sets how much memory may be taken beside what is held; Linux alone counts that."""
    if sys.platform != "linux":
        return
    import resource

    hard = resource.getrlimit(resource.RLIMIT_DATA)[1]
    wanted = hard if room is None else _State.begun + room
    soft = wanted if hard == resource.RLIM_INFINITY else min(wanted, hard)
    resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))
