"""What pages open scans with: the list of a place's scans, files that are dropped, and the opening.

Segments of files come to the open scan here too.

Routes below ``/api/library``. Files of scans that were dropped or came from a server go when their
scan is closed.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import msgspec
from anyio import from_thread
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route, Router
from starlette.types import ASGIApp, Receive, Scope, Send

from palpate.base.errors import OptionError, PalpateError, SceneFormatError, SeriesChoiceError
from palpate.base.progress import Progress
from palpate.io.dicomweb.address import is_web_address
from palpate.io.reading import read
from palpate.labels.kind import labels_in
from palpate.labels.labels import read_labels
from palpate.saved.autosave import autosave_of, note_scene
from palpate.saved.opening import Opening, is_scene, opening, opening_of
from palpate.saved.recent import Recent, forget_recent, note_recent, recent_scans
from palpate.server.answers import answered, as_json, body_of
from palpate.server.job import Job, Tell
from palpate.server.library.conversions import WantedLayout, layout_told
from palpate.server.library.opening import add_labels
from palpate.server.library.reconstruction import WantedReconstruction, grid_told, made_of
from palpate.server.library.search_results import (
    Finds,
    Place,
    WantedFind,
    WantedScan,
    WantedSegments,
    path_of,
)
from palpate.server.library.upload import (
    MOST_UPLOAD_BYTES,
    MOST_UPLOAD_FILES,
    Uploads,
    WantedFile,
)
from palpate.server.open_scan import OpenScan
from palpate.server.workbench import Workbench
from palpate.volumes.second_scan import placed

__all__ = ["Library"]

PASSING = "its files are a copy that goes when it is closed: a saved scene has the scan in it"
"""Said of a scan that was dropped, or came from a server."""
MADE = "it is in no file: a saved scene has the scan in it, and Export writes it"
"""Said of a scan that was reconstructed."""

Files = TemporaryDirectory[str]
"""Of a scan, for as long as it is open."""

Show = Callable[[Place, Files | None, Progress], None]
"""Shows a scan, whose files are its own or stay where they are."""


class About(msgspec.Struct, frozen=True):
    """What a page asks first."""

    scan: str | None
    """Name of the open scan."""
    coming: str | None
    """Name of what is being read, to be shown once it is."""
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


class Library:
    """Finds scans and puts them on a workbench."""

    def __init__(self, workbench: Workbench) -> None:
        """Opens scans on a workbench."""
        self._workbench = workbench
        self._uploads = Uploads()
        self._finds = Finds()
        self._routes = Router(
            [
                Route("/", answered(self._about)),
                Route("/coming", answered(self._coming), methods=["POST"]),
                Route("/find", answered(self._find), methods=["POST"]),
                Route("/open", answered(self._open), methods=["POST"]),
                Route("/layout", answered(self._layout), methods=["POST"]),
                Route("/reconstruct", answered(self._reconstruct), methods=["POST"]),
                Route("/reconstruct/grid", answered(self._grid), methods=["POST"]),
                Route("/segments", answered(self._segments), methods=["POST"]),
                Route("/uploads", answered(self._begin_upload), methods=["POST"]),
                Route("/uploads/{upload:int}", answered(self._drop_upload), methods=["DELETE"]),
                Route("/uploads/{upload:int}/{file:int}", answered(self._take), methods=["PUT"]),
                Route("/recent", answered(self._forget), methods=["DELETE"]),
            ]
        )

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answers a request below ``/api/library``."""
        await self._routes(scope, receive, send)

    def close(self) -> None:
        """Removes files that were dropped and never opened."""
        self._uploads.close()

    async def _about(self, _: Request) -> ASGIApp:
        coming = self._workbench.coming
        opened = None if coming is not None else await self._workbench.settled()
        changed = opened is not None and await run_in_threadpool(lambda: opened.changed)
        return as_json(
            About(
                scan=None if opened is None else opened.name,
                coming=None if coming is None else coming.name,
                changed=changed,
                kept=opened is not None and opened.keeps_changes,
                can_open=not self._workbench.fixed,
                # what is told of it comes with it
                told=[] if coming is not None else self._workbench.take_told(),
                recent=await run_in_threadpool(recent_scans),
            )
        )

    async def _coming(self, _: Request) -> ASGIApp:
        coming = self._workbench.coming

        def follow(progress: Progress, _: Tell) -> None:
            if coming is not None:
                coming.follow(progress)

        return Job(follow)

    async def _forget(self, _: Request) -> ASGIApp:
        await run_in_threadpool(forget_recent)
        return Response(status_code=204)

    # --- files that are dropped -----------------------------------------------------------

    async def _begin_upload(self, request: Request) -> ASGIApp:
        wanted = await body_of(request, list[WantedFile])
        return as_json({"upload": await run_in_threadpool(self._uploads.begin, wanted)})

    async def _take(self, request: Request) -> ASGIApp:
        upload, file = request.path_params["upload"], request.path_params["file"]
        await self._uploads.of(upload).take(file, request)
        return Response(status_code=204)

    async def _drop_upload(self, request: Request) -> ASGIApp:
        await run_in_threadpool(self._uploads.drop, request.path_params["upload"])
        return Response(status_code=204)

    # --- finding and opening --------------------------------------------------------------

    async def _find(self, request: Request) -> ASGIApp:
        wanted = await body_of(request, WantedFind)
        if (wanted.path is None) == (wanted.upload is None):
            raise OptionError("one place is needed; allowed: a path, or an upload")
        if wanted.upload is not None:
            held = self._uploads.of(wanted.upload)
            place = Place(held.path, wanted.upload, loose=held.loose)
        else:
            given = wanted.path or ""
            if is_web_address(given):
                return Job(lambda progress, tell: self._finds.look_at_web(given, progress, tell))
            place = Place(path_of(given))
        return Job(
            lambda progress, tell: self._finds.look(place, progress, tell, taken_as=wanted.taken_as)
        )

    async def _open(self, request: Request) -> ASGIApp:
        self._check_free()
        wanted = await body_of(request, WantedScan)
        place = self._finds.chosen(wanted)
        show = self._add if wanted.beside else self._exchange
        return Job(lambda progress, tell: self._bring(place, show, progress=progress, tell=tell))

    def _check_free(self) -> None:
        if self._workbench.fixed:
            raise OptionError("this scan is recorded; allowed: palpate open for another one")

    async def _layout(self, request: Request) -> ASGIApp:
        wanted = await body_of(request, WantedLayout)
        bare = self._finds.bare(wanted.find)
        return as_json(await run_in_threadpool(layout_told, bare, wanted))

    async def _grid(self, request: Request) -> ASGIApp:
        wanted = await body_of(request, WantedReconstruction)
        stack, _ = self._finds.projections(wanted.find)
        return as_json(grid_told(stack, wanted.request))

    async def _reconstruct(self, request: Request) -> ASGIApp:
        self._check_free()
        wanted = await body_of(request, WantedReconstruction)
        stack, upload = self._finds.projections(wanted.find)
        place = Place(
            stack.path,
            given=upload is None,
            make=lambda progress: made_of(stack, wanted.request, progress),
        )
        show = self._add if wanted.beside else self._exchange

        def work(progress: Progress, _: Tell) -> None:
            show(place, None, progress)
            if upload is not None:
                self._uploads.drop(upload)

        return Job(work)

    def _bring(self, place: Place, show: Show, *, progress: Progress, tell: Tell) -> None:
        """Shows a scan, after its files have come from where they are.

        Where they hold several volumes, such as times, these are told instead, to choose from.
        """
        if place.fetch is None:
            try:
                show(place, None, progress)
            except SceneFormatError:
                if (autosave := autosave_of(place.path)) is not None:
                    self._finds.offer(autosave, tell)
                raise
            return
        with ExitStack() as unless_shown:
            files = TemporaryDirectory(prefix="palpate-")
            unless_shown.callback(files.cleanup)
            folder = Path(files.name) / "scan"
            folder.mkdir()
            place.fetch(folder, progress)
            try:
                show(replace(place, path=folder), files, progress)
            except SeriesChoiceError:
                unless_shown.pop_all()
                kept = self._uploads.keep(files)
                self._finds.look(Place(folder, kept), progress, tell)
            unless_shown.pop_all()

    def _exchange(self, place: Place, fetched: Files | None, progress: Progress) -> None:
        """Shows a scan in place of the one that is open."""
        if place.upload is not None:
            # its files may be those of a scan by now
            self._uploads.of(place.upload)
        read = _read(place, progress)
        # from here on it cannot be taken back
        progress("starting", None)

        def begin() -> OpenScan:
            opened = OpenScan.begin(
                read.scene,
                rate=self._workbench.rate,
                journalled=self._workbench.journalled,
                recover=None if place.autosave is None else True,
                saved=read.saved,
                tell=self._workbench.tell,
            )
            if place.upload is not None:
                opened.files = self._uploads.take_out(place.upload)
            elif fetched is not None:
                opened.files = fetched
            else:
                note_recent(read.scene.volume, place.path if read.saved is not None else None)
            if read.saved is not None:
                note_scene(read.saved.scan, place.path, passing=place.upload is not None)
            return opened

        for sentence in read.messages:
            self._workbench.tell(sentence)
        volume = read.scene.volume
        warnings = volume.traits.warnings
        if place.make is not None:
            warnings = (*warnings, MADE)
        elif place.upload is not None or fetched is not None:
            warnings = (*warnings, PASSING)
        name = place.name or volume.traits.name
        volume.traits = replace(volume.traits, name=name, warnings=warnings, given=place.given)
        try:
            from_thread.run(self._workbench.exchange, begin)
        except (PalpateError, OSError, RuntimeError) as error:
            self._workbench.tell(f"The scan was not opened: {error}")
            raise

    def _add(self, place: Place, fetched: Files | None, progress: Progress) -> None:
        """Shows a scan with the one that is open."""
        opened = from_thread.run(self._workbench.settled)
        if opened is None:
            raise OptionError("no scan is open; allowed: open one first")
        if is_scene(place.path):
            raise OptionError("a scene was chosen; allowed: a scan")
        if place.make is None:
            volume = read(
                place.path,
                series=place.series,
                raw=place.raw,
                voxel_size=place.voxel_size,
                progress=progress,
            )
        else:
            volume = place.make(progress)
        volume.traits = replace(volume.traits, name=place.name or volume.traits.name)
        files = fetched if place.upload is None else self._uploads.take_out(place.upload)
        if files is None:
            note_recent(volume)
        else:
            # they go with it: a saved scene has to hold it
            volume.source = None
        opened.show_second(placed(opened.session.scene.volume, volume), files=files)

    # --- segments of the open scan ---------------------------------------------------------

    async def _segments(self, request: Request) -> ASGIApp:
        wanted = await body_of(request, WantedSegments)
        if [wanted.path, wanted.upload, wanted.find].count(None) != 2:
            raise OptionError("one place is needed; allowed: a path, an upload, or one of a list")
        if wanted.find is not None:
            path = self._finds.chosen(WantedScan(find=wanted.find, choice=wanted.choice)).path
        elif wanted.upload is None:
            path = path_of(wanted.path or "")
        else:
            path = labels_in(self._uploads.of(wanted.upload).path)
        return Job(lambda progress, _: self._add_segments(path, wanted, progress))

    def _add_segments(self, path: Path, wanted: WantedSegments, progress: Progress) -> None:
        """Adds the segments of a file or folder to the open scan."""
        opened = from_thread.run(self._workbench.settled)
        if opened is None:
            raise OptionError("no scan is open; allowed: open one first")
        volume = opened.session.scene.volume
        found = read_labels(path, volume, resample=wanted.resample, progress=progress)
        # from here on it cannot be taken back
        progress("adding segments", None)
        add_labels(opened.live, found)
        # those that are refused may be asked for again, resampled
        if wanted.upload is not None:
            self._uploads.drop(wanted.upload)


def _read(place: Place, progress: Progress) -> Opening:
    """Reads what is at a place, or makes it."""
    if place.make is not None:
        return opening_of(place.make(progress))
    if place.autosave is not None:
        return opening_of(place.autosave.read(progress))
    return opening(
        place.path,
        series=place.series,
        raw=place.raw,
        voxel_size=place.voxel_size,
        progress=progress,
    )
