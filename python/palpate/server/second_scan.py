"""The second scan for pages: its message, and routes that move it or bring its segments."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

from msgspec.structs import replace
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route

from palpate import protocol
from palpate.base.errors import OptionError, PalpateError
from palpate.base.simpleitk import Transform
from palpate.labels.labels import Label, Labels, read_labels
from palpate.registration.carry import Carrier
from palpate.server.answers import whole_body
from palpate.server.messages.hello import scan_of
from palpate.server.page_words import page_words
from palpate.volumes.scene import Scene
from palpate.volumes.second_scan import SecondScan, doubts_of, placed, read_transform
from palpate.volumes.volume import Volume

__all__ = ["second_message", "second_routes"]

MOST_BYTES = 1 << 28
"""Bytes of a file; of transforms a field of displacements takes most."""
TRANSFORM_ENDINGS = (".tfm", ".txt", ".h5", ".hdf5")

Show = Callable[[SecondScan | None], None]
Add = Callable[[Labels], None]
"""Takes segments on the grid of the first scan."""


def second_message(
    first: Volume, second: SecondScan | None, *, version: int
) -> protocol.SecondScan:
    """Returns the message for pages; another ``version`` has other values."""
    if second is None:
        return protocol.SecondScan(scan=None, second_from_first=[], is_moved=False, version=version)
    scan = scan_of(second.volume)
    return protocol.SecondScan(
        scan=replace(scan, warnings=[*doubts_of(first, second), *scan.warnings]),
        second_from_first=[float(number) for number in second.second_from_first.ravel()],
        is_moved=second.is_moved,
        version=version,
    )


def second_routes(scene: Scene, show: Show, add: Add) -> list[Route]:
    """Returns what pages ask for: a transform's file or none, no second scan, its segments."""

    async def lay(request: Request) -> Response:
        try:
            transform = None
            if request.method == "PUT":
                name = request.query_params.get("name", "")
                body = await whole_body(request, most=MOST_BYTES)
                transform = await run_in_threadpool(_transform_of, name, body)
            await run_in_threadpool(_lay, scene, show, transform)
        except (PalpateError, OSError) as error:
            return PlainTextResponse(page_words(str(error)), status_code=400)
        return Response(status_code=204)

    async def bring(request: Request) -> Response:
        try:
            body = await whole_body(request, most=MOST_BYTES)
            name = request.query_params.get("name", "")
            add(await run_in_threadpool(_carried, scene, name, body))
        except (PalpateError, OSError) as error:
            return PlainTextResponse(page_words(str(error)), status_code=400)
        return Response(status_code=204)

    async def remove(_: Request) -> Response:
        await run_in_threadpool(show, None)
        return Response(status_code=204)

    return [
        Route("/second/transform", lay, methods=["PUT", "DELETE"]),
        Route("/second/segments", bring, methods=["PUT"]),
        Route("/second", remove, methods=["DELETE"]),
    ]


def _lay(scene: Scene, show: Show, transform: Transform | None) -> None:
    show(placed(scene.volume, _second_of(scene).as_read, transform))


def _second_of(scene: Scene) -> SecondScan:
    if scene.second is None:
        raise OptionError("there is no second scan; allowed: add one first")
    return scene.second


def _carried(scene: Scene, name: str, content: bytes) -> Labels:
    """Returns the second scan's segments in a file, where it lies in the first scan now."""
    second = _second_of(scene)
    with TemporaryDirectory(prefix="palpate-") as folder:
        path = Path(folder) / (Path(name).name or "segments")
        path.write_bytes(content)
        found = read_labels(path, second.as_read)
    carrier = Carrier(second.transform, grid=scene.volume)
    segments, told = carrier.segments([one.segment for one in found.labels])
    labels = tuple(
        Label(segment, one.colour)
        for one, segment in zip(found.labels, segments, strict=True)
        if segment is not None
    )
    return Labels(labels, (*found.warnings, *told))


def _transform_of(name: str, content: bytes) -> Transform:
    """Reads a transform from the content of a file that the page's person calls ``name``."""
    ending = Path(name).suffix.lower()
    if ending not in TRANSFORM_ENDINGS:
        raise OptionError(f"{name!r} given; allowed: {', '.join(TRANSFORM_ENDINGS)}")
    with TemporaryDirectory(prefix="palpate-") as folder:
        path = Path(folder) / f"transform{ending}"
        path.write_bytes(content)
        return read_transform(path, called=name)
