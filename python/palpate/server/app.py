"""The server: the page, and below ``/api`` what is on the workbench.

Bound to 127.0.0.1; every route stands behind ``AccessMiddleware``. Messages are not deflated:
that costs more time than it saves on one machine.
"""

from __future__ import annotations

import asyncio
import socket
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress
from pathlib import Path
from threading import Timer
from typing import Any

import uvicorn
from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import FileResponse, Response
from starlette.routing import Mount, Route
from starlette.staticfiles import StaticFiles

from palpate.base.errors import OptionError
from palpate.base.freed_memory import give_freed_memory_back
from palpate.server.library.library import Library
from palpate.server.patience import PatientProtocol
from palpate.server.resume import Resuming, kept_port
from palpate.server.security import Access, AccessMiddleware
from palpate.server.workbench import Workbench

__all__ = ["PAGE", "bind", "bind_again", "make_app", "serve"]

PAGE = Path(__file__).parents[1] / "viewer"
"""The built page, as the wheel carries it."""

PAGE_PATIENCE: float | None = 60.0
"""Seconds until a page that does not answer counts as gone: a busy machine may be late."""

MOST_MESSAGE_BYTES = 1 << 16
"""Bytes of one message of the page; all of them are far smaller."""


def bind_again(name: str, port: int) -> socket.socket:
    """Reserves a port for a scan: that given, else the one where it was shown last, else any.

    Raises:
        OptionError: The port given is in use, or not allowed.
    """
    if port == 0 and (before := kept_port(name)) != 0:
        with suppress(OptionError):
            return bind(before)
    return bind(port)


def bind(port: int) -> socket.socket:
    """Reserves a port of 127.0.0.1 without answering on it yet; 0 takes any free one.

    Raises:
        OptionError: The port is in use, or not allowed.
    """
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(("127.0.0.1", port))
    except (OSError, OverflowError) as error:
        listener.close()
        reason = getattr(error, "strerror", None) or "not a port"
        raise OptionError(
            f"port {port} cannot be used ({reason}); allowed: a free port from 1 to 65535, "
            "or 0 for any"
        ) from None
    return listener


def make_app(workbench: Workbench, *, access: Access, page: Path = PAGE) -> Starlette:
    """Makes the application that shows what is on the workbench."""
    library = Library(workbench)

    @asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncIterator[None]:
        await workbench.start()
        try:
            yield
        finally:
            # the force goes first
            await workbench.stop()
            library.close()

    async def index(_: Request) -> Response:
        return FileResponse(page / "index.html")

    app = Starlette(
        routes=[
            Route("/", index),
            *Resuming(access).routes,
            Mount("/api/library", library),
            Mount("/api", workbench),
            # scripts, styles and icons of the page
            Mount("/", StaticFiles(directory=page, check_dir=False)),
        ],
        middleware=[Middleware(AccessMiddleware, access=access)],
        lifespan=lifespan,
    )
    app.state.ending = workbench.stop
    return app


class _Server(uvicorn.Server):
    """Calls ``ready`` once it answers, and ``ending`` before it closes the connections of pages."""

    def __init__(
        self,
        config: uvicorn.Config,
        *,
        ready: Callable[[], None],
        ending: Callable[[], Awaitable[None]],
    ) -> None:
        super().__init__(config)
        self._ready = ready
        self._ending = ending

    def end(self) -> None:
        """Asks it to end, from any thread."""
        self.should_exit = True

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        self._ready()

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        for listening in self.servers:
            listening.close()
        ending = asyncio.ensure_future(self._ending())
        # who asks once more does not wait
        while not ending.done() and not self.force_exit:
            await asyncio.wait([ending], timeout=0.1)
        await super().shutdown(sockets)


def make_server(app: Starlette, *, ready: Callable[[], None] = lambda: None) -> _Server:
    """Makes a server of an app; ``ready`` is called once it answers."""
    options: dict[str, Any] = {
        "http": PatientProtocol,
        "log_level": "warning",
        # streams of the command line print no orders to a terminal
        "use_colors": False,
        "access_log": False,
        "server_header": False,
        "lifespan": "on",
        "ws": "websockets-sansio",
        "ws_per_message_deflate": False,
        "ws_max_size": MOST_MESSAGE_BYTES,
        "timeout_graceful_shutdown": 1,
        "ws_ping_timeout": PAGE_PATIENCE,
    }
    return _Server(uvicorn.Config(app, **options), ready=ready, ending=app.state.ending)


def serve(
    workbench: Workbench,
    listener: socket.socket,
    *,
    access: Access,
    ready: Callable[[], None],
    seconds: float | None = None,
) -> None:
    """Serves a workbench until the process is asked to end; then stops what is open on it.

    It ends by itself where what the workbench waits for cannot be read.

    Args:
        workbench: What is shown.
        listener: Where to answer.
        access: Who is let in.
        ready: Called once it answers.
        seconds: Ends by itself after so long.

    Raises:
        OptionError: Another program took the port meanwhile.
    """
    give_freed_memory_back()
    try:
        listener.listen()
    except OSError as error:
        raise OptionError(
            f"port {access.port} cannot be used ({error.strerror}); allowed: a free port"
        ) from None
    server = make_server(make_app(workbench, access=access), ready=ready)
    workbench.given_up = server.end
    timer = Timer(seconds or 0.0, server.end)
    if seconds is not None:
        timer.start()
    try:
        server.run(sockets=[listener])
    finally:
        timer.cancel()
