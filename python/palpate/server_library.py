"""What pages open scans with: the list of a place's scans, files that are dropped, and the opening.

Routes below ``/api/library``. A place is a path of this machine, which its person may read anyway,
or an upload. What is found is kept until more recent finds push it out.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path
from typing import Any, NoReturn, TypeVar

import msgspec
from anyio import from_thread
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route, Router
from starlette.types import ASGIApp, Receive, Scope, Send

from palpate.errors import OptionError, PalpateError
from palpate.io import read
from palpate.io_browse import Choice, browsed, previews
from palpate.io_preview import png_of
from palpate.opening import is_scene, opening
from palpate.progress import Progress
from palpate.recent import Recent, forget_recent, note_recent, recent_scans
from palpate.second_scan import placed
from palpate.server_job import Job, Tell
from palpate.server_open_scan import OpenScan
from palpate.server_upload import (
    MOST_UPLOAD_BYTES,
    MOST_UPLOAD_FILES,
    Uploads,
    WantedFile,
)
from palpate.server_workbench import Workbench

__all__ = ["Library"]

MOST_FINDS = 8
MOST_BODY_BYTES = 1 << 24
"""Of a list of files that will come: 50 000 names."""

PASSING = "its files are a copy that goes when it is closed: a saved scene has the scan in it"
"""Said of a scan that was dropped."""

Wanted = TypeVar("Wanted")


class WantedFind(msgspec.Struct, frozen=True):
    """Where scans are looked for: one of both."""

    path: str | None = None
    upload: int | None = None


class WantedScan(msgspec.Struct, frozen=True):
    """What is to be opened: a choice of a find, or a path."""

    find: int | None = None
    choice: int = 0
    path: str | None = None
    series: str | None = None
    beside: bool = False
    """Whether it is shown with the open scan, and not in its place."""


class ListedScan(msgspec.Struct, frozen=True):
    """A scan in a list."""

    patient: str
    study: str
    name: str
    modality: str
    size: tuple[int, ...]
    spacing: tuple[float, ...] | None
    refused: str | None


class About(msgspec.Struct, frozen=True):
    """What a page asks first."""

    scan: str | None
    """Name of the open scan."""
    changed: bool
    """Whether it has changes."""
    kept: bool
    """Whether those are kept on disk."""
    can_open: bool
    told: list[str]
    """What no page was told yet."""
    recent: list[Recent]
    most_files: int = MOST_UPLOAD_FILES
    most_bytes: int = MOST_UPLOAD_BYTES


@dataclass(frozen=True)
class Place:
    """Where a scan is, or where scans are looked for."""

    path: Path
    upload: int | None = None
    series: str | None = None


@dataclass(frozen=True)
class Find:
    """What was found at a place."""

    choices: list[Choice]
    upload: int | None


class Library:
    """Finds scans and puts them on a workbench."""

    def __init__(self, workbench: Workbench) -> None:
        """Opens scans on a workbench."""
        self._workbench = workbench
        self._uploads = Uploads()
        self._finds: dict[int, Find] = {}
        self._numbers = count(1)
        self._routes = Router(
            [
                Route("/", _answered(self._about)),
                Route("/find", _answered(self._find), methods=["POST"]),
                Route("/open", _answered(self._open), methods=["POST"]),
                Route("/uploads", _answered(self._begin_upload), methods=["POST"]),
                Route("/uploads/{upload:int}", _answered(self._drop_upload), methods=["DELETE"]),
                Route("/uploads/{upload:int}/{file:int}", _answered(self._take), methods=["PUT"]),
                Route("/recent", _answered(self._forget), methods=["DELETE"]),
            ]
        )

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answers a request below ``/api/library``."""
        await self._routes(scope, receive, send)

    def close(self) -> None:
        """Removes files that were dropped and never opened."""
        self._uploads.close()

    async def _about(self, _: Request) -> ASGIApp:
        opened = await self._workbench.settled()
        changed = opened is not None and await run_in_threadpool(lambda: opened.changed)
        return _json(
            About(
                scan=None if opened is None else opened.name,
                changed=changed,
                kept=opened is not None and opened.keeps_changes,
                can_open=not self._workbench.fixed,
                told=self._workbench.take_told(),
                recent=await run_in_threadpool(recent_scans),
            )
        )

    async def _forget(self, _: Request) -> ASGIApp:
        await run_in_threadpool(forget_recent)
        return Response(status_code=204)

    # --- files that are dropped -----------------------------------------------------------

    async def _begin_upload(self, request: Request) -> ASGIApp:
        wanted = await _body(request, list[WantedFile])
        return _json({"upload": await run_in_threadpool(self._uploads.begin, wanted)})

    async def _take(self, request: Request) -> ASGIApp:
        upload, file = request.path_params["upload"], request.path_params["file"]
        await self._uploads.of(upload).take(file, request)
        return Response(status_code=204)

    async def _drop_upload(self, request: Request) -> ASGIApp:
        await run_in_threadpool(self._uploads.drop, request.path_params["upload"])
        return Response(status_code=204)

    # --- finding and opening --------------------------------------------------------------

    async def _find(self, request: Request) -> ASGIApp:
        wanted = await _body(request, WantedFind)
        if (wanted.path is None) == (wanted.upload is None):
            raise OptionError("one place is needed; allowed: a path, or an upload")
        if wanted.upload is not None:
            place = Place(self._uploads.of(wanted.upload).path, wanted.upload)
        else:
            place = Place(_path_of(wanted.path or ""))
        return Job(lambda progress, tell: self._look(place, progress, tell))

    def _look(self, place: Place, progress: Progress, tell: Tell) -> None:
        if is_scene(place.path):
            choice = Choice(path=place.path, name=place.path.stem, size=(), picture=_no_picture)
            self._tell_find(Find([choice], place.upload), tell)
            return
        with browsed(place.path, progress=progress) as choices:
            self._tell_find(Find(choices, place.upload), tell)
            # a single one needs no choice
            for number, picture in previews(choices) if len(choices) > 1 else ():
                progress("drawing slices", None)
                png = b64encode(png_of(picture)).decode("ascii")
                tell({"kind": "picture", "choice": number, "png": png})

    def _tell_find(self, find: Find, tell: Tell) -> None:
        number = next(self._numbers)
        self._finds[number] = find
        while len(self._finds) > MOST_FINDS:
            del self._finds[min(self._finds)]
        tell({"kind": "found", "find": number, "scans": [_listed(one) for one in find.choices]})

    async def _open(self, request: Request) -> ASGIApp:
        if self._workbench.fixed:
            raise OptionError("this scan is recorded; allowed: palpate open for another one")
        wanted = await _body(request, WantedScan)
        place = self._chosen(wanted)
        act = self._add if wanted.beside else self._exchange
        return Job(lambda progress, _: act(place, progress))

    def _chosen(self, wanted: WantedScan) -> Place:
        if wanted.path is not None:
            return Place(_path_of(wanted.path), series=wanted.series)
        find = self._finds.get(wanted.find or 0)
        if find is None or not 0 <= wanted.choice < len(find.choices):
            raise OptionError("that list is gone; allowed: look for scans again")
        choice = find.choices[wanted.choice]
        if choice.refused is not None:
            raise OptionError(choice.refused)
        return Place(choice.path, find.upload, choice.series)

    def _exchange(self, place: Place, progress: Progress) -> None:
        read = opening(place.path, series=place.series, progress=progress)
        # from here on it cannot be taken back
        progress("starting", None)

        def begin() -> OpenScan:
            opened = OpenScan.begin(
                read.scene,
                rate=self._workbench.rate,
                journalled=self._workbench.journalled,
                saved=read.saved,
                tell=self._workbench.tell,
            )
            if place.upload is None:
                note_recent(read.scene.volume, place.path if read.saved is not None else None)
            else:
                opened.files = self._uploads.take_out(place.upload)
            return opened

        for sentence in read.told:
            self._workbench.tell(sentence)
        if place.upload is not None:
            volume = read.scene.volume
            warnings = (*volume.warnings, PASSING)
            volume.traits = replace(volume.traits, warnings=warnings)
        try:
            from_thread.run(self._workbench.exchange, begin)
        except (PalpateError, OSError, RuntimeError) as error:
            self._workbench.tell(f"The scan was not opened: {error}")
            raise

    def _add(self, place: Place, progress: Progress) -> None:
        """Shows a scan with the one that is open."""
        opened = from_thread.run(self._workbench.settled)
        if opened is None:
            raise OptionError("no scan is open; allowed: open one first")
        if is_scene(place.path):
            raise OptionError("a scene was chosen; allowed: a scan")
        volume = read(place.path, series=place.series, progress=progress)
        files = None
        if place.upload is None:
            note_recent(volume)
        else:
            # they go with it: a saved scene has to hold it
            volume.source = None
            files = self._uploads.take_out(place.upload)
        opened.show_second(placed(opened.session.scene.volume, volume), files=files)


def _listed(choice: Choice) -> ListedScan:
    return ListedScan(
        patient=choice.patient,
        study=choice.study,
        name=choice.name,
        modality=choice.modality,
        size=choice.size,
        spacing=choice.spacing,
        refused=choice.refused,
    )


def _no_picture() -> NoReturn:
    raise OptionError("a scene has no picture")


def _path_of(given: str) -> Path:
    """Returns the path that a person has typed.

    Raises:
        OptionError: It is empty, or none.
    """
    text = given.strip().strip("\"'")
    if not text or "\0" in text:
        raise OptionError("no path given; allowed: that of a folder or file on this machine")
    return Path(text).expanduser()


async def _body(request: Request, kind: type[Wanted]) -> Wanted:
    body = b""
    async for chunk in request.stream():
        body += chunk
        if len(body) > MOST_BODY_BYTES:
            raise OptionError(f"more than {MOST_BODY_BYTES} bytes given; allowed: fewer files")
    try:
        return msgspec.json.decode(body, type=kind)
    except msgspec.DecodeError as error:
        raise OptionError(f"this is not understood: {error}") from None


def _json(content: object) -> Response:
    return Response(msgspec.json.encode(content), media_type="application/json")


def _answered(handle: Callable[[Request], Any]) -> Callable[[Request], Any]:
    """Tells as a sentence what cannot be done."""

    async def answered(request: Request) -> ASGIApp:
        try:
            answer: ASGIApp = await handle(request)
        except (PalpateError, OSError) as error:
            return PlainTextResponse(str(error), status_code=400)
        return answer

    return answered
