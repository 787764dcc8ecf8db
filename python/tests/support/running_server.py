"""A server that runs in this process, and pages that talk to it."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from socket import SO_RCVBUF, SOL_SOCKET, socket
from threading import Event, Thread
from typing import Any

import httpx
import msgspec
import numpy as np
from palpate.saved.journal import Journal
from palpate.server.app import bind, make_app, make_server
from palpate.server.live import Live
from palpate.server.open_scan import OpenScan
from palpate.server.security import Access
from palpate.server.workbench import Workbench
from palpate.session.session import Session
from palpate.volumes.scene import Scene
from websockets.sync.client import ClientConnection, connect

PATIENCE = 60.0
"""Seconds until what is waited for counts as lost: however busy the machine is, it comes sooner."""


@dataclass(frozen=True)
class RunningServer:
    """A server that answers, in a thread of this process."""

    access: Access
    session: Session
    journal: Journal | None = None
    live: Live | None = None

    @property
    def base(self) -> str:
        return f"http://127.0.0.1:{self.access.port}"

    def ask(self, method: str, path: str, content: bytes | None = None) -> httpx.Response:
        """Asks in any way, with the token as a cookie."""
        sent = {"Cookie": f"{self.access.cookie}={self.access.token}"}
        return httpx.request(
            method,
            f"{self.base}{path}",
            headers=sent,
            content=content,
            trust_env=False,
            timeout=PATIENCE,
        )

    def get(self, path: str, **headers: str) -> httpx.Response:
        """Asks with the token as a cookie, unless headers say otherwise."""
        sent = {"Cookie": f"{self.access.cookie}={self.access.token}"}
        sent |= {name.replace("_", "-"): value for name, value in headers.items()}
        return httpx.get(f"{self.base}{path}", headers=sent, trust_env=False, timeout=PATIENCE)

    @contextmanager
    def page(self, *, host_name: str = "127.0.0.1", **options: Any) -> Iterator[Page]:
        """Connects as the page does."""
        address = f"{host_name}:{self.access.port}/api/live?token={self.access.token}"
        with page_at(address, self.access.port, **({"origin": self.base} | options)) as page:
            yield page


@contextmanager
def page_at(address: str, port: int, *, room: int | None = None, **options: Any) -> Iterator[Page]:
    """Connects to the live messages of any server on a port of this machine.

    The system keeps ``room`` bytes for a page that does not read; by default many.
    """
    settings = {"max_size": None, "open_timeout": PATIENCE} | options
    with socket() as plain:
        if room is not None:
            plain.setsockopt(SOL_SOCKET, SO_RCVBUF, room)
        plain.connect(("127.0.0.1", port))
        with connect(f"ws://{address}", sock=plain, **settings) as connection:
            yield Page(connection)


class Page:
    """The page's end of the connection."""

    def __init__(self, socket: ClientConnection) -> None:
        self.socket = socket

    def send(self, message: dict[str, Any]) -> None:
        self.socket.send(msgspec.msgpack.encode(message))

    def receive(self, kind: str, *, until: Callable[[Any], bool] = lambda _: True) -> Any:
        """Waits for a message of a kind that fits; others before it are left out."""
        ends = time.monotonic() + PATIENCE
        while time.monotonic() < ends:
            message = self.next()
            if message["type"] == kind and until(message):
                return message
        raise AssertionError(f"no {kind} message that fits within {PATIENCE} s")

    def next(self) -> Any:
        """Waits for the next message, of whatever kind."""
        return msgspec.msgpack.decode(self.socket.recv(timeout=PATIENCE, decode=False))


def write_page(folder: Path) -> Path:
    """Writes a stand-in for the built page: what it shows does not matter to the server."""
    (folder / "assets").mkdir(parents=True)
    (folder / "index.html").write_text("<!doctype html><title>Palpate</title>")
    (folder / "assets" / "page.js").write_text("export {};")
    (folder.parent / "beside.txt").write_text("not for the page")
    return folder


@contextmanager
def running(scene: Scene, page: Path, *, state: Path | None = None) -> Iterator[RunningServer]:
    """Runs the real server with a real session on a free port, with a journal in ``state``."""
    with Session(scene) as session:
        journal = None if state is None else Journal(session, folder=state, tell=lambda _: None)
        if journal is not None:
            journal.start()
        opened = OpenScan(session, journal=journal)
        with serving(Workbench(opened), page) as access:
            yield RunningServer(access, session, journal, opened.live)
        opened.recorder.close()
    if journal is not None:
        journal.close()


@contextmanager
def serving(workbench: Workbench, page: Path) -> Iterator[Access]:
    """Runs the real server with a workbench on a free port."""
    with bind(0) as listener:
        access = Access(port=listener.getsockname()[1])
        ready = Event()
        server = make_server(make_app(workbench, access=access, page=page), ready=ready.set)
        listener.listen()
        thread = Thread(target=server.run, kwargs={"sockets": [listener]})
        thread.start()
        assert ready.wait(PATIENCE)
        yield access
        server.should_exit = True
        thread.join(PATIENCE)
        assert not thread.is_alive()


@dataclass
class LibraryClient:
    """A page that opens scans."""

    access: Access
    workbench: Workbench

    def ask(self, method: str, route: str, body: Any = None) -> httpx.Response:
        content = body if isinstance(body, bytes) else json.dumps(body).encode()
        return httpx.request(
            method,
            f"http://127.0.0.1:{self.access.port}/api/{route}",
            headers={"Cookie": f"{self.access.cookie}={self.access.token}"},
            content=None if body is None else content,
            trust_env=False,
            timeout=PATIENCE,
        )

    def about(self) -> dict[str, Any]:
        told: dict[str, Any] = self.ask("GET", "library/").json()
        return told

    def job(self, route: str, body: Any) -> list[dict[str, Any]]:
        """Returns the lines of some work, without its progress."""
        answer = self.ask("POST", f"library/{route}", body)
        assert answer.status_code == 200, answer.text
        lines = [json.loads(line) for line in answer.text.splitlines()]
        return [line for line in lines if line["kind"] != "progress"]

    def upload(self, files: dict[str, bytes]) -> int:
        told = [{"name": name, "size": len(content)} for name, content in files.items()]
        number = int(self.ask("POST", "library/uploads", told).json()["upload"])
        for file, content in enumerate(files.values()):
            assert self.ask("PUT", f"library/uploads/{number}/{file}", content).status_code == 204
        return number


def voxels(server: Any, route: str, kind: str) -> np.ndarray:
    answer = server.get(route)
    assert answer.status_code == 200
    width, height, depth = map(int, answer.headers["x-palpate-dimensions"].split())
    return np.frombuffer(answer.content, kind).reshape(depth, height, width)
