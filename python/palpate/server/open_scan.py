"""One open scan: its session, its recordings, its changes on disk, and what pages ask of it.

An ASGI application below ``/api``; ``workbench`` holds it and exchanges it for another.
"""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from contextlib import suppress
from datetime import datetime
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Self

from numpy.typing import NDArray
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import FileResponse, PlainTextResponse, Response
from starlette.routing import Route, Router, WebSocketRoute
from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.websockets import WebSocket

from palpate.base.errors import OptionError
from palpate.saved.journal import Journal
from palpate.saved.kept_with_scan import KeptWithScan
from palpate.saved.scene_file import SavedScene
from palpate.server.added_labels import add_labels
from palpate.server.answers import errors_as_text, json_body, json_response, whole_body
from palpate.server.area_values import AreaRequest, measured_areas
from palpate.server.closing import ENDED, EXCHANGED
from palpate.server.export import export_response
from palpate.server.job import Job
from palpate.server.live import Live
from palpate.server.messages.hello import hello_of
from palpate.server.preset_pictures import PresetsRequest, preset_pictures_job
from palpate.server.recording import Recorder
from palpate.server.saved_picture import saved_picture
from palpate.server.scene import scene_response, shared_scene_response, view_response
from palpate.server.second_scan import second_routes
from palpate.server.segment_statistics import statistics_job
from palpate.server.surface_export import surface_response
from palpate.server.voxel_data import parse_step, voxels_response
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene
from palpate.volumes.second_scan import SecondScan

__all__ = ["OpenScan"]

Notify = Callable[[str], None]
"""Takes a sentence for the person."""


class OpenScan:
    """A session, its recordings and journal, and the routes and messages of its pages."""

    def __init__(
        self,
        session: Session,
        *,
        recorder: Recorder | None = None,
        journal: Journal | None = None,
        run: Path | None = None,
        saved: SavedScene | None = None,
        kept: KeptWithScan | None = None,
        notify: Notify = print,
    ) -> None:
        """Takes a session that runs.

        Recordings are those of ``recorder``; what ``journal`` offers, pages are asked about; the
        file of a scenario's ``run`` is what they play; ``saved`` is the scene that was opened,
        ``kept`` what is kept with the scan.
        """
        self.session = session
        self.journal = journal
        self.recorder = Recorder(session) if recorder is None else recorder
        self.files: TemporaryDirectory[str] | None = None
        """Where its files were put for as long as it is open; None where they stay."""
        self._second_files: TemporaryDirectory[str] | None = None
        self._notify = notify
        looks = None if saved is None else saved.looks
        self.live = Live(
            session, hello_of(session), self.recorder, journal=journal, looks=looks, kept=kept
        )
        self._pump: asyncio.Task[None] | None = None
        self._routes = Router(
            [
                *_data_routes(self, run=run, saved=saved),
                WebSocketRoute("/live", self._messages),
            ]
        )

    @classmethod
    def begin(
        cls,
        scene: Scene,
        *,
        rate: int = 1000,
        journalled: bool = False,
        recover: bool | None = None,
        run: Path | None = None,
        saved: SavedScene | None = None,
        notify: Notify = print,
    ) -> Self:
        """Starts a session of a scene.

        Changes are ``journalled``; what an earlier session left is brought back (``recover``), kept
        aside, or asked about on the page (None). A scene that was ``saved`` is brought back first.

        Raises:
            PalpateError: The scene that was saved is damaged.
        """
        session = Session(scene, options=SessionOptions(rate_hz=rate))
        try:
            # changes from before the recovery are dropped: there is no page yet
            session.picture_changes()
            if saved is not None:
                saved.restore(session)
            journal = Journal(session, tell=notify) if journalled else None
            if journal is not None:
                save_id = None if saved is None else saved.about.save_id
                journal.start(recover=recover, scene=save_id)
                scene.second = journal.second or scene.second
            kept = KeptWithScan(
                scene, view=None if saved is None else saved.view or {}, on_disk=journalled
            )
            return cls(session, journal=journal, run=run, saved=saved, kept=kept, notify=notify)
        except BaseException:
            session.stop()
            raise

    @property
    def name(self) -> str:
        """What a person calls the scan."""
        return self.session.scene.volume.name

    @property
    def changed(self) -> bool:
        """Whether something was changed that undo could take back."""
        frame = self.session.frame()
        return bool(frame["can_undo"] or frame["can_redo"])

    @property
    def keeps_changes(self) -> bool:
        """Whether changes are kept on disk."""
        return self.journal is not None and self.journal.problem is None

    def show_second(
        self, second: SecondScan, *, files: TemporaryDirectory[str] | None = None
    ) -> None:
        """Shows another scan with this one; ``files`` are its own for as long as it is open."""
        old, self._second_files = self._second_files, files
        self.live.show_second(second)
        if old is not None:
            old.cleanup()

    async def start(self) -> None:
        """Begins to publish to pages."""
        self._pump = asyncio.create_task(self.live.run())

    async def stop(self, *, exchanged: bool = False) -> None:
        """Ends the force and publishing; pages load anew, or say that the session has ended."""
        if self._pump is not None:
            # before it sees that the session has ended, which it would tell pages
            self._pump.cancel()
        await run_in_threadpool(self.session.stop)
        if self._pump is not None:
            with suppress(asyncio.CancelledError):
                await self._pump
        if exchanged:
            await self.live.send_away(EXCHANGED, "another scan")
        else:
            await self.live.send_away(ENDED, "the session has ended")

    def end(self) -> None:
        """Keeps a recording that still runs, stops the session and closes what was kept of it."""
        try:
            if self.recorder.is_running:
                _keep_unfinished(self.recorder, self._notify)
        finally:
            self.recorder.close()
            self.session.stop()
            self.live.kept.write()
            if self.journal is not None:
                self.journal.close()
            for files in (self.files, self._second_files):
                if files is not None:
                    files.cleanup()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answers a request below ``/api``."""
        await self._routes(scope, receive, send)

    async def _messages(self, websocket: WebSocket) -> None:
        await self.live.serve(websocket)


def _keep_unfinished(recorder: Recorder, notify: Notify) -> None:
    """Writes a recording that nobody has ended where the program was started."""
    said = recorder.stop()
    moment = datetime.now().astimezone().strftime("%Y%m%d-%H%M%S")
    target = Path.cwd() / f"{moment}-{recorder.file_name}"
    recorder.keep(target)
    notify(f"the recording that ran is in {target}: {said}")


# --- what pages fetch beside the messages -------------------------------------------------


def _scene_routes(opened: OpenScan, saved: SavedScene | None) -> list[Route]:
    async def answered(response: Callable[..., Response], request: Request) -> Response:
        body = await whole_body(request)
        passing = opened.files is not None
        live = opened.live
        return await run_in_threadpool(
            response, opened.session, live.segments, body, passing=passing, kept=live.kept
        )

    async def scene(request: Request) -> Response:
        return await answered(partial(scene_response, journal=opened.journal), request)

    async def shared_scene(request: Request) -> Response:
        return await answered(shared_scene_response, request)

    async def view(_: Request) -> Response:
        return view_response(None if saved is None else saved.view)

    return [
        Route("/scene", errors_as_text(scene), methods=["POST"]),
        Route("/scene/shared", errors_as_text(shared_scene), methods=["POST"]),
        Route("/view", view),
    ]


def _data_routes(opened: OpenScan, *, run: Path | None, saved: SavedScene | None) -> list[Route]:
    live, kept = opened.live, opened.recorder

    async def volume(request: Request) -> Response:
        # as edits have left it
        return await _voxels(request, lambda: live.picture.values)

    async def labels(request: Request) -> Response:
        return await _voxels(request, live.segments.labels)

    async def second(request: Request) -> Response:
        shown = live.session.scene.second
        if shown is None:
            reason = "there is no second scan; allowed: after one was added"
            return PlainTextResponse(reason, status_code=404)
        return await _voxels(request, lambda: shown.volume.array)

    async def recording(_: Request) -> Response:
        # a page asks as soon as the recording has ended, which is before its file is written
        return _recording_of(kept.file_name, await run_in_threadpool(kept.newest))

    async def scenario(_: Request) -> Response:
        return Response(status_code=204) if run is None else FileResponse(run)

    async def export(request: Request) -> Response:
        body = await whole_body(request)
        return await run_in_threadpool(export_response, live.segments, live.picture.values, body)

    return [
        Route("/volume", volume),
        Route("/labels", labels),
        Route("/second", second, methods=["GET"]),
        *second_routes(live.session.scene, live.show_second, partial(add_labels, live)),
        Route("/registration", _registration_of(live), methods=["POST"]),
        Route("/recording", recording),
        Route("/scenario", scenario),
        *_scene_routes(opened, saved),
        Route("/export", errors_as_text(export), methods=["POST"]),
        Route("/statistics", _statistics_of(live), methods=["POST"]),
        Route("/areas", _areas_of(live), methods=["POST"]),
        Route("/surface", _surface_of(live), methods=["POST"]),
        Route("/picture", _picture_of(live), methods=["POST"]),
        Route("/presets", _presets_of(live), methods=["POST"]),
    ]


def _areas_of(live: Live) -> Callable[[Request], Awaitable[Response]]:
    async def areas(request: Request) -> Response:
        wanted = await json_body(request, AreaRequest)
        volume, stored = live.session.scene.volume, live.picture.values
        return json_response(await run_in_threadpool(measured_areas, wanted, volume, stored))

    return errors_as_text(areas)


def _surface_of(live: Live) -> Callable[[Request], Awaitable[Response]]:
    async def surface(request: Request) -> Response:
        body = await whole_body(request)
        return await run_in_threadpool(surface_response, live.segments, live.picture.values, body)

    return errors_as_text(surface)


def _picture_of(live: Live) -> Callable[[Request], Awaitable[Response]]:
    async def picture(request: Request) -> Response:
        return await saved_picture(request, live.engine_pictures.still)

    return errors_as_text(picture)


def _presets_of(live: Live) -> Callable[[Request], Awaitable[ASGIApp]]:
    async def presets(request: Request) -> ASGIApp:
        wanted = await json_body(request, PresetsRequest)
        return preset_pictures_job(wanted, live.session.scene.volume, live.engine_pictures.still)

    return errors_as_text(presets)


def _registration_of(live: Live) -> Callable[[Request], Awaitable[Response]]:
    async def registration(request: Request) -> Response:
        body = await whole_body(request)
        return await run_in_threadpool(live.registration.file_response, body)

    return errors_as_text(registration)


def _statistics_of(live: Live) -> Callable[[Request], Awaitable[Job]]:
    async def statistics(_: Request) -> Job:
        return statistics_job(live.segments, lambda: live.picture.values)

    return statistics


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
