"""Messages between processes: pickled, each behind its length, over pipes."""

from __future__ import annotations

import pickle
import struct
from threading import Lock
from typing import IO

__all__ = ["Sender", "receive"]

LENGTH = struct.Struct("<Q")


class Sender:
    """Sends messages, from several threads too."""

    def __init__(self, file: IO[bytes]) -> None:
        """Sends into a pipe."""
        self._file = file
        self._lock = Lock()

    def __call__(self, message: object) -> None:
        """Sends a message.

        Raises:
            OSError: Nobody is there.
        """
        body = pickle.dumps(message, protocol=5)
        with self._lock:
            self._file.write(LENGTH.pack(len(body)) + body)
            self._file.flush()


def receive(file: IO[bytes]) -> object | None:
    """Returns the next message; None where there are no more."""
    try:
        head = file.read(LENGTH.size)
        if len(head) < LENGTH.size:
            return None
        size = LENGTH.unpack(head)[0]
        body = file.read(size)
    except (OSError, ValueError):
        return None
    message: object = pickle.loads(body) if len(body) == size else None  # noqa: S301
    return message
