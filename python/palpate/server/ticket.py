"""Lets in the browser that a command starts, without the token.

A browser is given its first address as an argument, which every user of the machine can read. So a
ticket stands there: it is of use once, for a short time, and only to programs of this user or of
the system.

Source: proc_pid_net(5), ``/proc/net/tcp``.
"""

from __future__ import annotations

import os
import secrets
import sys
from pathlib import Path
from threading import Lock
from time import monotonic

__all__ = ["Ticket", "tells_owners", "user_of"]

LIFETIME = 300.0
"""Seconds in which a browser has started."""
TABLES = (Path("/proc/net/tcp"), Path("/proc/net/tcp6"))
"""All connections of this machine, a line each."""


class Ticket:
    """A random value that is taken once."""

    def __init__(self) -> None:
        """Is of use from now on."""
        self.value = secrets.token_urlsafe(24)
        self._until = monotonic() + LIFETIME
        self._lock = Lock()
        self._taken = False

    def take(self, given: str, *, client: tuple[str, int] | None, port: int) -> bool:
        """Says whether what is given lets its client in; it does once.

        Args:
            given: What stands in the address.
            client: Where the request comes from.
            port: Of the server.
        """
        # takes the same time wherever the first difference is
        if not secrets.compare_digest(given.encode(), self.value.encode()):
            return False
        with self._lock:
            if self._taken or monotonic() > self._until or not _is_own(client, port):
                return False
            self._taken = True
            return True


def tells_owners() -> bool:
    """Says whether this system tells whose a connection is."""
    return sys.platform == "linux" and TABLES[0].exists()


def _is_own(client: tuple[str, int] | None, port: int) -> bool:
    """Says whether a client is a program of this user, where the system tells."""
    if not tells_owners():
        return True
    # root hands on connections from elsewhere, such as from Windows to WSL, and needs no ticket
    return client is not None and user_of(client[1], port) in (os.getuid(), 0)


def user_of(client: int, server: int) -> int | None:
    """Returns the user whose program has connected from a port of this machine to another one.

    Returns:
        The number of the user; None where there is no such connection.
    """
    for table in TABLES:
        try:
            lines = table.read_text(encoding="ascii").splitlines()[1:]
        except OSError:
            continue
        for line in lines:
            _, local, remote, _, _, _, _, user, *_ = line.split()
            if (_port(local), _port(remote)) == (client, server):
                return int(user)
    return None


def _port(address: str) -> int:
    return int(address.rpartition(":")[2], 16)
