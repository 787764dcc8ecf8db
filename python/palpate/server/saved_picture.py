"""Pictures for files: the view at any size, drawn by the engine strip by strip and sent as drawn.

A page gets ``DrawnPicture`` messages in one answer, each after its length in bytes (uint32,
little-endian): the strips of a picture from the left to the right, one picture after another, each
strip with the ``number`` of its picture. A page that closes the connection ends the work.
"""

from __future__ import annotations

import struct
import time
from collections.abc import AsyncIterator, Callable
from typing import Annotated

import msgspec
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response, StreamingResponse

from palpate import protocol
from palpate.base.errors import OptionError
from palpate.pictures.appearance import Appearance
from palpate.pictures.camera import Camera
from palpate.pictures.choices import MOST_PIXELS
from palpate.pictures.session_pictures import Fineness
from palpate.pictures.still_pictures import StillPictures
from palpate.pictures.strips import Strip, strips_of
from palpate.protocol import encode_to_page
from palpate.server.answers import json_body
from palpate.server.messages.encoded_picture import encoded_picture

__all__ = ["PictureWish", "saved_picture"]

Edge = Annotated[int, msgspec.Meta(ge=1, le=MOST_PIXELS)]
MOST_FRAMES = 3600
"""Of a film."""


class PictureWish(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Pictures of one look and size from each camera.

    ``size`` has columns and rows [pixels]. Each pixel is the mean of ``samples`` rays, of
    ``steps_per_voxel`` steps for each smallest voxel edge.
    """

    look: protocol.PictureLook
    cameras: Annotated[list[protocol.SeenFrom], msgspec.Meta(min_length=1, max_length=MOST_FRAMES)]
    size: tuple[Edge, Edge]
    steps_per_voxel: Annotated[float, msgspec.Meta(ge=0.1, le=16.0)]
    samples: Annotated[int, msgspec.Meta(ge=1, le=64)]
    jitter: bool


async def saved_picture(request: Request, still: Callable[[], StillPictures]) -> Response:
    """Answers with what a page would save.

    Raises:
        OptionError: It cannot be drawn.
    """
    wish = await json_body(request, PictureWish)
    pictures = [
        strips_of(_converted(camera), wish.size, samples=wish.samples) for camera in wish.cameras
    ]
    drawing = _Drawing(still(), wish)
    try:
        # what is not allowed is told before anything is sent
        first = await run_in_threadpool(drawing.packed, 0, pictures[0][0])
    except (ValueError, RuntimeError, MemoryError) as error:
        drawing.close()
        raise OptionError(str(error) or "not enough memory for a picture of the engine") from None
    return StreamingResponse(drawing.all(pictures, first), media_type="application/octet-stream")


class _Drawing:
    """What is drawn for one answer."""

    def __init__(self, renderer: StillPictures, wish: PictureWish) -> None:
        self._renderer = renderer
        self._wish = wish
        self._look = msgspec.convert(wish.look, Appearance, from_attributes=True)
        self._fineness = Fineness(
            steps_per_voxel=wish.steps_per_voxel, samples=wish.samples, jitter=wish.jitter
        )

    def close(self) -> None:
        self._renderer.close()

    async def all(self, pictures: list[list[Strip]], first: bytes) -> AsyncIterator[bytes]:
        """Yields the strips of pictures; the ``first`` is drawn already."""
        try:
            yield first
            for number, strips in enumerate(pictures):
                for strip in strips[1:] if number == 0 else strips:
                    yield await run_in_threadpool(self.packed, number, strip)
        finally:
            self.close()

    def packed(self, number: int, strip: Strip) -> bytes:
        """Draws a strip of a picture, and returns it as it is sent."""
        began = time.perf_counter()
        picture = self._renderer.draw_at_rest(
            self._look, strip.camera, strip.size, fineness=self._fineness
        )
        message = encode_to_page(
            encoded_picture(
                picture,
                number=number,
                divisor=1.0,
                samples=self._wish.samples,
                finished=True,
                seconds=time.perf_counter() - began,
            )
        )
        return struct.pack("<I", len(message)) + message


def _converted(camera: protocol.SeenFrom) -> Camera:
    return msgspec.convert(camera, Camera, from_attributes=True)
