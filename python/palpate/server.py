"""The server: the page, its data over HTTP, and the session over a WebSocket.

Bound to 127.0.0.1; every route stands behind ``AccessMiddleware``. Messages are not deflated:
that costs more time than it saves on one machine.
"""

from __future__ import annotations

import asyncio
import socket
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from pathlib import Path
from threading import Timer
from typing import Any

import uvicorn
from numpy.typing import NDArray
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import FileResponse, PlainTextResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.websockets import WebSocket

from palpate.errors import OptionError
from palpate.journal import Journal
from palpate.scene_file import SavedScene
from palpate.server_data import parse_step, voxels_response
from palpate.server_export import export_response
from palpate.server_hello import hello_of
from palpate.server_live import Live
from palpate.server_recording import Recorder
from palpate.server_scene import scene_response, view_response
from palpate.server_security import Access, AccessMiddleware
from palpate.session import Session

__all__ = ["PAGE", "bind", "make_app", "serve"]

PAGE = Path(__file__).parent / "viewer"
"""The built page, as the wheel carries it."""

PAGE_PATIENCE: float | None = 60.0
"""Seconds until a page that does not answer counts as gone: a busy machine may be late."""

MOST_MESSAGE_BYTES = 1 << 16
"""Of one message of the page; all of them are far smaller."""


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


def make_app(
    session: Session,
    *,
    access: Access,
    page: Path = PAGE,
    recorder: Recorder | None = None,
    journal: Journal | None = None,
    run: Path | None = None,
    saved: SavedScene | None = None,
) -> Starlette:
    """Makes the application that shows a session.

    Recordings are those of ``recorder``; what ``journal`` offers, pages are asked about; the file
    of a scenario's ``run`` is what they play; ``saved`` is the scene that was opened.
    """
    kept = Recorder(session) if recorder is None else recorder
    looks = None if saved is None else saved.looks
    live = Live(session, hello_of(session), kept, journal=journal, looks=looks)

    @asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncIterator[None]:
        pump = asyncio.create_task(live.run())
        try:
            yield
        finally:
            # the force goes first
            await run_in_threadpool(session.stop)
            pump.cancel()
            with suppress(asyncio.CancelledError):
                await pump
            if recorder is None:
                kept.close()

    async def index(_: Request) -> Response:
        return FileResponse(page / "index.html")

    async def messages(websocket: WebSocket) -> None:
        await live.serve(websocket)

    app = Starlette(
        routes=[
            Route("/", index),
            *_data_routes(live, kept, run=run, saved=saved),
            WebSocketRoute("/api/live", messages),
            # scripts, styles and icons of the page
            Mount("/", StaticFiles(directory=page, check_dir=False)),
        ],
        middleware=[Middleware(AccessMiddleware, access=access)],
        lifespan=lifespan,
    )
    app.state.live = live
    return app


def _data_routes(
    live: Live, kept: Recorder, *, run: Path | None, saved: SavedScene | None
) -> list[Route]:
    """What pages fetch beside the messages."""

    async def volume(request: Request) -> Response:
        # as edits have left it
        return await _voxels(request, lambda: live.picture.values)

    async def labels(request: Request) -> Response:
        return await _voxels(request, live.segments.labels)

    async def second(request: Request) -> Response:
        shown = live.session.scene.second
        if shown is None:
            reason = "there is no second scan; allowed: after palpate open SCAN --with SECOND"
            return PlainTextResponse(reason, status_code=404)
        return await _voxels(request, lambda: shown.volume.array)

    async def recording(_: Request) -> Response:
        # a page asks as soon as the recording has ended, which is before its file is written
        return _recording_of(kept.file_name, await run_in_threadpool(kept.newest))

    async def scenario(_: Request) -> Response:
        return Response(status_code=204) if run is None else FileResponse(run)

    async def scene(request: Request) -> Response:
        body = await request.body()
        return await run_in_threadpool(scene_response, live.session, live.segments, body)

    async def export(request: Request) -> Response:
        body = await request.body()
        return await run_in_threadpool(export_response, live.segments, live.picture.values, body)

    async def view(_: Request) -> Response:
        return view_response(None if saved is None else saved.view)

    return [
        Route("/api/volume", volume),
        Route("/api/labels", labels),
        Route("/api/second", second),
        Route("/api/recording", recording),
        Route("/api/scenario", scenario),
        Route("/api/scene", scene, methods=["POST"]),
        Route("/api/export", export, methods=["POST"]),
        Route("/api/view", view),
    ]


async def _voxels(request: Request, array: Callable[[], NDArray[Any]]) -> Response:
    try:
        step = parse_step(request.query_params.get("step"))
    except OptionError as error:
        return PlainTextResponse(str(error), status_code=400)
    return voxels_response(await run_in_threadpool(array), step=step)


def _recording_of(name: str, file: Path | None) -> Response:
    if file is None:
        reason = "no recording was made yet; allowed: after one has ended"
        return PlainTextResponse(reason, status_code=404)
    return FileResponse(file, media_type="application/octet-stream", filename=name)


class _Server(uvicorn.Server):
    """Tells when it answers."""

    def __init__(self, config: uvicorn.Config, ready: Callable[[], None]) -> None:
        super().__init__(config)
        self._ready = ready

    def end(self) -> None:
        """Asks it to end, from any thread."""
        self.should_exit = True

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        self._ready()


def make_server(app: Starlette, *, ready: Callable[[], None] = lambda: None) -> _Server:
    """Makes a server of an app; ``ready`` is called once it answers."""
    options: dict[str, Any] = {
        "log_level": "warning",
        "access_log": False,
        "server_header": False,
        "lifespan": "on",
        "ws": "websockets-sansio",
        "ws_per_message_deflate": False,
        "ws_max_size": MOST_MESSAGE_BYTES,
        "timeout_graceful_shutdown": 1,
        "ws_ping_timeout": PAGE_PATIENCE,
    }
    return _Server(uvicorn.Config(app, **options), ready)


def serve(
    session: Session,
    listener: socket.socket,
    *,
    access: Access,
    ready: Callable[[], None],
    recorder: Recorder | None = None,
    journal: Journal | None = None,
    run: Path | None = None,
    saved: SavedScene | None = None,
    seconds: float | None = None,
) -> None:
    """Serves a session until the process is asked to end; then stops the session.

    Args:
        session: What is shown.
        listener: Where to answer.
        access: Who is let in.
        ready: Called once it answers.
        recorder: Keeps the recordings that pages ask for.
        journal: Keeps the session's changes on disk.
        run: File of a scenario's run, which pages play.
        saved: Scene that was opened, whose view pages take.
        seconds: Ends by itself after so long.

    Raises:
        OptionError: Another program took the port meanwhile.
    """
    try:
        listener.listen()
    except OSError as error:
        raise OptionError(
            f"port {access.port} cannot be used ({error.strerror}); allowed: a free port"
        ) from None
    app = make_app(session, access=access, recorder=recorder, journal=journal, run=run, saved=saved)
    server = make_server(app, ready=ready)
    timer = Timer(seconds or 0.0, server.end)
    if seconds is not None:
        timer.start()
    try:
        server.run(sockets=[listener])
    finally:
        timer.cancel()
