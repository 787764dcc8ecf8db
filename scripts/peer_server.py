"""Serves another program's page: its files, some of them replaced, and a DICOM server behind it.

All of it comes from one address, so that the page may ask the DICOM server as if it were its own.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Awaitable, Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import httpx
import uvicorn
from browser import END_LIMIT, START_LIMIT, free_port
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import FileResponse, Response
from starlette.routing import Route

Answers = Callable[[Request], Awaitable[Response]]

OF_ONE_HOP = {"connection", "content-length", "host", "keep-alive", "transfer-encoding"}
"""Headers that are not passed on."""


@contextmanager
def served(files: Mapping[str, Path], *, dicom: str | None = None) -> Iterator[str]:
    """Serves files to this machine; gives the address.

    Args:
        files: where they are, by their names in addresses. What is not among them is answered
            with ``index.html``: the page itself knows its addresses.
        dicom: address of a DICOMweb service, which then stands at ``/dicom-web``.
    """
    routes = [Route("/{name:path}", _answers_with(files))]
    if dicom is not None:
        routes.insert(0, Route("/dicom-web/{rest:path}", _passes_on_to(dicom)))
    port = free_port()
    how = uvicorn.Config(Starlette(routes=routes), port=port, log_level="error", lifespan="off")
    server = uvicorn.Server(how)
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    ends = time.monotonic() + START_LIMIT
    while not server.started:
        if time.monotonic() > ends:
            raise TimeoutError(f"no server within {START_LIMIT} s")
        time.sleep(0.05)
    try:
        yield f"http://127.0.0.1:{port}/"
    finally:
        server.should_exit = server.force_exit = True
        thread.join(END_LIMIT)


def files_below(folder: Path) -> dict[str, Path]:
    """Returns all files of a folder by their names in addresses."""
    found = (path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path for path in found}


def _answers_with(files: Mapping[str, Path]) -> Answers:
    async def answer(request: Request) -> Response:
        name = request.path_params["name"]
        return FileResponse(files.get(name, files["index.html"]))

    return answer


def _passes_on_to(dicom: str) -> Answers:
    # Orthanc closes connections that rest, maybe just as one is taken up again
    limits = httpx.Limits(max_connections=8, max_keepalive_connections=0)
    client = httpx.AsyncClient(base_url=dicom, trust_env=False, timeout=START_LIMIT, limits=limits)

    async def answer(request: Request) -> Response:
        asked = {k: v for k, v in request.headers.items() if k not in OF_ONE_HOP}
        rest = "/" + request.path_params["rest"]
        got = await client.get(rest, params=str(request.query_params), headers=asked)
        kept = {k: v for k, v in got.headers.items() if k not in {*OF_ONE_HOP, "content-encoding"}}
        return Response(got.content, got.status_code, kept)

    return answer
