"""A way to a server that takes only so many bytes in a second toward the page, as a slow line."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from socketserver import BaseRequestHandler, ThreadingTCPServer
from urllib.parse import urlsplit

READ_BYTES = 1 << 16
PORTION_SECONDS = 0.005


class SlowWay(ThreadingTCPServer):
    """Hands bytes on both ways."""

    daemon_threads = True

    def __init__(self, url: str) -> None:
        """Listens, and is as fast as the machine."""
        super().__init__(("127.0.0.1", 0), _Connection)
        port = urlsplit(url).port
        assert port is not None
        self.server_port = port
        self.own_port: int = self.socket.getsockname()[1]
        self.url = url.replace(f":{port}/", f":{self.own_port}/")
        """The server's address as a page has to ask for it."""
        self.rate: float | None = None
        """Bytes a second to each page; 0 hands nothing on, None all at once."""
        self.handed = 0
        """Bytes that went to pages."""


class _Connection(BaseRequestHandler):
    """One connection of a page, and the one to the server that belongs to it."""

    server: SlowWay

    def handle(self) -> None:
        with (
            suppress(OSError),
            socket.create_connection(("127.0.0.1", self.server.server_port)) as to,
        ):
            answers = threading.Thread(target=self._answer, args=[to], daemon=True)
            answers.start()
            own, other = (b"127.0.0.1:%d" % p for p in (self.server.own_port, to.getpeername()[1]))
            with suppress(OSError):
                while sent := self.request.recv(READ_BYTES):
                    to.sendall(sent.replace(own, other))
            with suppress(OSError):
                to.shutdown(socket.SHUT_RDWR)
            answers.join()

    def _answer(self, server: socket.socket) -> None:
        with suppress(OSError):
            while sent := server.recv(self._portion()):
                while self.server.rate == 0.0:
                    time.sleep(PORTION_SECONDS)
                if self.server.rate is not None:
                    time.sleep(len(sent) / self.server.rate)
                self.request.sendall(sent)
                self.server.handed += len(sent)
            self.request.shutdown(socket.SHUT_RDWR)

    def _portion(self) -> int:
        rate = self.server.rate
        return READ_BYTES if rate is None else max(64, int(rate * PORTION_SECONDS))


@contextmanager
def slow_way(url: str) -> Iterator[SlowWay]:
    """Gives a way to the server of an address."""
    with SlowWay(url) as way:
        threading.Thread(target=way.serve_forever, daemon=True).start()
        try:
            yield way
        finally:
            way.rate = None
            way.shutdown()
