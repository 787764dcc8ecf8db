"""Objects with large arrays, handed from one process to another through a file that both map.

The file has no name where the system knows such (Linux), so that nothing is left of it whatever
ends; elsewhere it is a temporary one. Arrays are laid in it one after the other, each at a multiple
of 64 bytes.
"""

from __future__ import annotations

import mmap
import os
import pickle
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import mkstemp

__all__ = ["packed", "shared_file", "unpacked"]

SMALL = 1 << 16
"""Arrays that go with the rest [bytes]."""
ALIGNED = 64

Places = Sequence[tuple[int, int]]
"""Of arrays in the file: first byte and length."""


@contextmanager
def shared_file(folder: str) -> Iterator[tuple[int, str]]:
    """Gives a file, and the path under which another process of this user opens it."""
    descriptor, path = _opened(folder)
    try:
        yield descriptor, path
    finally:
        os.close(descriptor)


def _opened(folder: str) -> tuple[int, str]:
    if hasattr(os, "memfd_create"):
        descriptor = os.memfd_create("palpate-reading")
        return descriptor, f"/proc/{os.getpid()}/fd/{descriptor}"
    # the folder goes after the call
    return mkstemp(prefix="palpate-", dir=folder)


def packed(result: object, path: str) -> tuple[bytes, Places]:
    """Writes the large arrays of an object into a file; returns the rest, and where they are.

    Raises:
        OSError: There is no room for them.
    """
    large: list[pickle.PickleBuffer] = []

    def take(buffer: pickle.PickleBuffer) -> bool:
        if buffer.raw().nbytes < SMALL:
            return True
        large.append(buffer)
        return False

    rest = pickle.dumps(result, protocol=5, buffer_callback=take)
    places: list[tuple[int, int]] = []
    if large:
        with Path(path).open("r+b", buffering=0) as file:
            for buffer in large:
                view = buffer.raw()
                begins = -(-file.tell() // ALIGNED) * ALIGNED
                file.seek(begins)
                written = 0
                while written < view.nbytes:
                    written += file.write(view[written:])
                places.append((begins, view.nbytes))
    return rest, places


def unpacked(rest: bytes, places: Places, *, descriptor: int) -> object:
    """Returns an object; its large arrays are the file's own memory, which goes with them."""
    if not places:
        return pickle.loads(rest)  # noqa: S301  # of a process of our own
    view = memoryview(mmap.mmap(descriptor, 0))
    arrays = [view[begins : begins + length] for begins, length in places]
    return pickle.loads(rest, buffers=arrays)  # noqa: S301
