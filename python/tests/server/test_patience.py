"""Connections that say nothing are let go, and take nobody's place; pages stay."""

from __future__ import annotations

import socket
import time
from contextlib import ExitStack
from typing import Any

import pytest
from palpate.server import live
from palpate.server.patience import PatientProtocol
from running_server import PATIENCE
from websockets.exceptions import ConnectionClosed

SOON = 0.3
"""Seconds that the server waits in tests."""


@pytest.fixture
def impatient(server: Any, monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.setattr(PatientProtocol, "HEAD_SECONDS", SOON)
    monkeypatch.setattr(PatientProtocol, "BODY_SECONDS", SOON)
    return server


def connected(server: Any) -> socket.socket:
    return socket.create_connection(("127.0.0.1", server.access.port), timeout=PATIENCE)


def head(server: Any, rest: str = "", *, way: str = "GET /") -> bytes:
    known = f"Host: 127.0.0.1:{server.access.port}\r\nCookie: {server.access.set_cookie}\r\n"
    return f"{way} HTTP/1.1\r\n{known}{rest}\r\n".encode()


def is_let_go(client: socket.socket) -> bool:
    """Waits for the end of a connection; what is answered before is left out."""
    try:
        while client.recv(1 << 16):
            pass
    except ConnectionError:
        pass
    return True


def drips(client: socket.socket) -> bool:
    """Sends a byte now and then, until nobody takes it."""
    client.settimeout(SOON / 6)
    for _ in range(int(PATIENCE / SOON * 6)):
        try:
            client.send(b"x")
            if client.recv(1 << 16) == b"":
                return False
        except TimeoutError:
            continue
        except OSError:
            return False
    return True


def test_who_says_nothing_is_let_go(impatient: Any) -> None:
    with connected(impatient) as client:
        assert is_let_go(client)


def test_a_head_that_comes_by_bytes_is_not_waited_for(impatient: Any) -> None:
    with connected(impatient) as client:
        client.sendall(head(impatient)[:-2] + b"X-Long: ")
        assert not drips(client)


def test_a_second_head_that_comes_by_bytes_is_not_waited_for(impatient: Any) -> None:
    with connected(impatient) as client:
        client.sendall(head(impatient))
        assert client.recv(12) == b"HTTP/1.1 200"
        assert not drips(client)


def test_a_body_that_stops_is_not_waited_for(impatient: Any) -> None:
    with connected(impatient) as client:
        client.sendall(head(impatient, "Content-Length: 1000\r\n", way="POST /api/export"))
        assert is_let_go(client)


def test_who_is_refused_cannot_go_on_with_a_body(impatient: Any) -> None:
    with connected(impatient) as client:
        client.sendall(b"POST /api/export HTTP/1.1\r\nHost: x\r\nContent-Length: 100000\r\n\r\n")
        assert client.recv(12) == b"HTTP/1.1 403"
        assert not drips(client)


def test_a_body_that_goes_on_slowly_arrives(impatient: Any) -> None:
    whole = b"{}" + b" " * 16
    with connected(impatient) as client:
        told = f"Connection: close\r\nContent-Length: {len(whole)}\r\n"
        client.sendall(head(impatient, told, way="POST /api/export"))
        for byte in whole:
            client.send(bytes([byte]))
            # all of it takes longer than nothing may come
            time.sleep(SOON / 8)
        assert client.recv(12) == b"HTTP/1.1 400"


@pytest.mark.parametrize(
    "way", ["scene", "export", "surface", "registration", "areas", "picture", "resume"]
)
def test_too_much_of_a_body_is_refused_while_it_comes(shared_server: Any, way: str) -> None:
    with connected(shared_server) as client:
        told = "Transfer-Encoding: chunked\r\n"
        client.sendall(head(shared_server, told, way=f"POST /api/{way}"))
        part = b"%x\r\n%s\r\n" % (1 << 20, b" " * (1 << 20))
        for _ in range(17):
            client.sendall(part)
        # the end of it never comes
        assert client.recv(12) == b"HTTP/1.1 400"


def test_many_that_wait_take_nobodys_place(server: Any) -> None:
    with ExitStack() as stack:
        waiting = [
            stack.enter_context(connected(server)) for _ in range(PatientProtocol.MOST_WAITING + 6)
        ]
        assert server.get("/").status_code == 200
        # the oldest have made room
        assert all(is_let_go(client) for client in waiting[:6])
        waiting[-1].sendall(head(server))
        assert waiting[-1].recv(12) == b"HTTP/1.1 200"


def test_a_page_that_says_nothing_stays(impatient: Any) -> None:
    with impatient.page() as page:
        page.receive("hello")
        with connected(impatient) as client:
            assert is_let_go(client)
        page.send({"type": "nothing"})
        assert "not understood" in page.receive("notice")["text"]


def test_pages_are_limited(server: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live, "MOST_PAGES", 2)
    with ExitStack() as stack:
        for _ in range(2):
            stack.enter_context(server.page()).receive("hello")
        with pytest.raises(ConnectionClosed, match="pages"):
            stack.enter_context(server.page()).receive("hello")
