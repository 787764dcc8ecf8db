"""A way to a server on which one answer is held back, as on a slow line."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from socketserver import BaseRequestHandler, ThreadingTCPServer
from urllib.parse import urlsplit

READ_BYTES = 1 << 16


class HeldBack(ThreadingTCPServer):
    """Hands bytes on both ways; of one answer only so many until it is released."""

    daemon_threads = True

    def __init__(self, url: str, asked: str, most: int) -> None:
        """Listens; ``asked`` is where the answer is asked for, ``most`` its bytes until then."""
        super().__init__(("127.0.0.1", 0), _Connection)
        self._url = url
        port = urlsplit(url).port
        assert port is not None
        self.server_port = port
        self.asked = f"GET {asked}".encode()
        self.most = most
        self.released = threading.Event()

    @property
    def port(self) -> int:
        """The port that pages ask."""
        port: int = self.socket.getsockname()[1]
        return port

    @property
    def url(self) -> str:
        """The server's address as a page has to ask for it."""
        return self._url.replace(f":{self.server_port}/", f":{self.port}/")


class _Connection(BaseRequestHandler):
    """One connection of a page, and the one to the server that belongs to it."""

    server: HeldBack

    def handle(self) -> None:
        self.held = threading.Event()
        # a page asks for its server also when that has ended
        with suppress(ConnectionRefusedError):
            self._join()

    def _join(self) -> None:
        """Hands on until either side ends."""
        with socket.create_connection(("127.0.0.1", self.server.server_port)) as server:
            answers = threading.Thread(target=self._answer, args=[server], daemon=True)
            answers.start()
            with suppress(OSError):
                self._ask(server)
            # what is still to be answered reaches nobody
            with suppress(OSError):
                server.shutdown(socket.SHUT_RDWR)
            answers.join()

    def _ask(self, server: socket.socket) -> None:
        """Hands on requests, as if the page had asked the server itself."""
        own, other = (
            b"127.0.0.1:%d" % port for port in (self.server.port, server.getpeername()[1])
        )
        while sent := self.request.recv(READ_BYTES):
            if sent.startswith(self.server.asked):
                self.held.set()
            server.sendall(sent.replace(own, other))

    def _answer(self, server: socket.socket) -> None:
        """Hands on answers, and ends the connection where the server does."""
        handed = 0
        with suppress(OSError):
            while sent := server.recv(READ_BYTES):
                handed += len(sent) if self.held.is_set() else 0
                if handed > self.server.most:
                    self.server.released.wait()
                self.request.sendall(sent)
            self.request.shutdown(socket.SHUT_RDWR)


@contextmanager
def held_back(url: str, *, asked: str, most: int) -> Iterator[HeldBack]:
    """Gives a way to the server of an address; nothing is held back at its end."""
    with HeldBack(url, asked, most) as way:
        threading.Thread(target=way.serve_forever, daemon=True).start()
        try:
            yield way
        finally:
            way.released.set()
            way.shutdown()
