"""Routes below ``/api/library``: pages search for scans, upload files, and open what they chose."""

from __future__ import annotations

from pathlib import Path

import msgspec
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route, Router
from starlette.types import ASGIApp, Receive, Scope, Send

from palpate.base.errors import OptionError
from palpate.base.progress import Progress
from palpate.io.dicomweb.address import is_web_address
from palpate.labels.kind import labels_in
from palpate.reconstruction.request import ReconstructionRequest
from palpate.saved.recent import Recent, forget_recent, recent_scans
from palpate.server.answers import errors_as_text, json_body, json_response
from palpate.server.job import Emit, Job
from palpate.server.library.conversions import (
    layout_preview,
    reconstructed,
    reconstruction_grid,
)
from palpate.server.library.opening import Opener
from palpate.server.library.requests import (
    LayoutRequest,
    OpenRequest,
    PicturesRequest,
    Place,
    ReconstructRequest,
    SearchRequest,
    SegmentsRequest,
    VolumeRequest,
    path_of,
)
from palpate.server.library.search_results import SearchResults
from palpate.server.library.upload import (
    MOST_UPLOAD_BYTES,
    MOST_UPLOAD_FILES,
    UploadedFile,
    Uploads,
)
from palpate.server.workbench import Workbench

__all__ = ["Library"]


class About(msgspec.Struct, frozen=True):
    """What a page needs to know first."""

    scan: str | None
    """Name of the open scan."""
    loading: str | None = msgspec.field(name="coming")
    """Name of the scan that is being read."""
    changed: bool
    """Whether the open scan has changes."""
    kept: bool
    """Whether those are kept on disk."""
    can_open: bool
    notices: list[str] = msgspec.field(name="told")
    """Sentences that no page was shown yet."""
    recent: list[Recent]
    most_files: int = MOST_UPLOAD_FILES
    most_bytes: int = MOST_UPLOAD_BYTES


class Library:
    """Finds scans and puts them on a workbench."""

    def __init__(self, workbench: Workbench) -> None:
        """Opens scans on a workbench."""
        self._workbench = workbench
        self._uploads = Uploads()
        self._results = SearchResults()
        self._opener = Opener(workbench, self._results, self._uploads)
        self._routes = Router(
            [
                Route(path, errors_as_text(handle), methods=[method])
                for path, method, handle in (
                    ("/", "GET", self._about),
                    ("/coming", "POST", self._loading),
                    ("/find", "POST", self._search),
                    ("/pictures", "POST", self._pictures),
                    ("/open", "POST", self._open),
                    ("/volume", "POST", self._volume),
                    ("/layout", "POST", self._layout),
                    ("/reconstruct", "POST", self._reconstruct),
                    ("/reconstruct/grid", "POST", self._grid),
                    ("/segments", "POST", self._segments),
                    ("/uploads", "POST", self._begin_upload),
                    ("/uploads/{upload:int}", "DELETE", self._drop_upload),
                    ("/uploads/{upload:int}/{file:int}", "PUT", self._receive_file),
                    ("/recent", "DELETE", self._forget),
                )
            ]
        )

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answers a request below ``/api/library``."""
        await self._routes(scope, receive, send)

    def close(self) -> None:
        """Removes files that were dropped and never opened."""
        self._uploads.close()

    async def _about(self, _: Request) -> ASGIApp:
        loading = self._workbench.loading
        opened = None if loading is not None else await self._workbench.settled()
        changed = opened is not None and await run_in_threadpool(lambda: opened.changed)
        return json_response(
            About(
                scan=None if opened is None else opened.name,
                loading=None if loading is None else loading.name,
                changed=changed,
                kept=opened is not None and opened.keeps_changes,
                can_open=not self._workbench.fixed,
                # its own notices come with it
                notices=[] if loading is not None else self._workbench.take_notices(),
                recent=await run_in_threadpool(recent_scans),
            )
        )

    async def _loading(self, _: Request) -> ASGIApp:
        loading = self._workbench.loading

        def follow(progress: Progress, _: Emit) -> None:
            if loading is not None:
                loading.follow(progress)

        return Job(follow)

    async def _forget(self, _: Request) -> ASGIApp:
        await run_in_threadpool(forget_recent)
        return Response(status_code=204)

    # --- uploads -----------------------------------------------------------

    async def _begin_upload(self, request: Request) -> ASGIApp:
        wanted = await json_body(request, list[UploadedFile])
        return json_response({"upload": await run_in_threadpool(self._uploads.begin, wanted)})

    async def _receive_file(self, request: Request) -> ASGIApp:
        upload, file = request.path_params["upload"], request.path_params["file"]
        await self._uploads.of(upload).take(file, request)
        return Response(status_code=204)

    async def _drop_upload(self, request: Request) -> ASGIApp:
        await run_in_threadpool(self._uploads.drop, request.path_params["upload"])
        return Response(status_code=204)

    # --- searching and opening --------------------------------------------------------------

    async def _search(self, request: Request) -> ASGIApp:
        wanted = await json_body(request, SearchRequest)
        if (wanted.path is None) == (wanted.upload is None):
            raise OptionError("one place is needed; allowed: a path, or an upload")
        if wanted.upload is not None:
            held = self._uploads.of(wanted.upload)
            place = Place(held.path, wanted.upload, loose=held.loose)
        else:
            given = wanted.path or ""
            if is_web_address(given):
                return Job(lambda progress, emit: self._results.search_web(given, progress, emit))
            place = Place(path_of(given))
        return Job(
            lambda progress, emit: self._results.search(
                place, progress, emit, taken_as=wanted.taken_as
            )
        )

    async def _pictures(self, request: Request) -> ASGIApp:
        wanted = await json_body(request, PicturesRequest)
        return Job(
            lambda progress, emit: self._results.emit_pictures(
                wanted.find, wanted.choices, progress=progress, emit=emit
            )
        )

    async def _open(self, request: Request) -> ASGIApp:
        self._check_free()
        wanted = await json_body(request, OpenRequest)
        place = Place(Path(), demo=True) if wanted.demo else self._results.place_of(wanted)
        return Job(
            lambda progress, emit: self._opener.open(
                place, beside=wanted.beside, progress=progress, emit=emit
            )
        )

    async def _volume(self, request: Request) -> ASGIApp:
        self._check_free()
        wanted = await json_body(request, VolumeRequest)
        change = self._opener.reread_second if wanted.beside else self._opener.reread
        return Job(lambda progress, _: change(wanted, progress))

    def _check_free(self) -> None:
        if self._workbench.fixed:
            raise OptionError("this scan is recorded; allowed: palpate open for another one")

    async def _layout(self, request: Request) -> ASGIApp:
        wanted = await json_body(request, LayoutRequest)
        headerless = self._results.headerless(wanted.find)
        return json_response(await run_in_threadpool(layout_preview, headerless, wanted))

    async def _grid(self, request: Request) -> ASGIApp:
        wanted = await json_body(request, ReconstructRequest)
        stack, _ = self._results.projections(wanted.find)
        grid = await run_in_threadpool(reconstruction_grid, stack, self._with_geometry(wanted))
        return json_response(grid)

    def _with_geometry(self, wanted: ReconstructRequest) -> ReconstructionRequest:
        """Returns the request with the path of its geometry file."""
        if wanted.geometry is None:
            return wanted.request
        path = self._uploads.of(wanted.geometry).path
        return msgspec.structs.replace(wanted.request, geometry=path)

    async def _reconstruct(self, request: Request) -> ASGIApp:
        self._check_free()
        wanted = await json_body(request, ReconstructRequest)
        stack, upload = self._results.projections(wanted.find)
        asked = self._with_geometry(wanted)
        place = Place(
            stack.path,
            given=upload is None,
            make=lambda progress: reconstructed(stack, asked, progress),
        )

        def work(progress: Progress, _: Emit) -> None:
            self._opener.show(place, beside=wanted.beside, progress=progress)
            for used in (upload, wanted.geometry):
                if used is not None:
                    self._uploads.drop(used)

        return Job(work)

    # --- segments of the open scan ---------------------------------------------------------

    async def _segments(self, request: Request) -> ASGIApp:
        wanted = await json_body(request, SegmentsRequest)
        if [wanted.path, wanted.upload, wanted.find].count(None) != 2:
            raise OptionError("one place is needed; allowed: a path, an upload, or one of a list")
        if wanted.find is not None:
            path = self._results.place_of(OpenRequest(find=wanted.find, choice=wanted.choice)).path
        elif wanted.upload is None:
            path = path_of(wanted.path or "")
        else:
            path = labels_in(self._uploads.of(wanted.upload).path)

        def work(progress: Progress, _: Emit) -> None:
            self._opener.add_segments(
                path,
                resample=wanted.resample,
                another_patient=wanted.another_patient,
                progress=progress,
            )
            # those that are refused may be asked for again, resampled
            if wanted.upload is not None:
                self._uploads.drop(wanted.upload)

        return Job(work)
