"""A picture of the engine as the message that takes it to a page.

The page puts colours over its ground and bends highlights after that. So they stay linear, in half
floats; or, in a WebP picture, as sRGB of a share of the brightest that the page tells from white.
"""

from __future__ import annotations

import io
import zlib
from functools import cache

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from palpate import protocol
from palpate.pictures.session_pictures import DrawnArrays
from palpate.server.messages.picture_coding import NOT_PACKED, Packing

__all__ = ["encoded_picture"]

NOTHING = 65535
"""Depth where nothing is."""
MOST_STEPS = 32766
"""From the nearest depth to the farthest."""
HAZE = 32768
"""The first of the depths of what is seen through."""
BRIGHTEST = 2.2
"""Linear; bent highlights (``softened`` in composite.frag) end in white within 1/255 before it."""
EFFORT = 0
"""Of WebP: more takes twice as long for a fifth less."""
DEFLATE_LEVEL = 1


def encoded_picture(
    picture: DrawnArrays,
    *,
    number: int,
    divisor: float,
    samples: int,
    finished: bool,
    seconds: float,
    over: int | None = None,
    packing: Packing = NOT_PACKED,
) -> protocol.DrawnPicture:
    """Returns the message with a picture that took so many seconds, to be put over an edit's."""
    rows, columns = picture.depths.shape
    rows //= picture.eyes
    halves = picture.colours.astype("<f2")
    # each eye's rows are left out by themselves
    of_eyes = picture.depths.reshape(picture.eyes, rows, columns)
    depths, nearest, farthest = _encoded_depths(of_eyes, packing)
    quality = packing.quality
    return protocol.DrawnPicture(
        number=number,
        size=(columns, rows),
        eyes=picture.eyes,
        part=picture.part,
        over=over,
        state=picture.state,
        divisor=divisor,
        samples=samples,
        finished=finished,
        milliseconds=1000.0 * seconds,
        coding="raw" if quality is None else "webp",
        colours=halves.tobytes() if quality is None else _webp(halves, quality),
        brightest=BRIGHTEST,
        depths=depths.tobytes() if quality is None else _deflated(depths),
        depth_every=packing.depth_every,
        nearest=nearest,
        farthest=farthest,
    )


def _webp(halves: NDArray[np.float16], quality: int) -> bytes:
    """Returns a WebP picture of colours, shape [rows, columns, 4], and below them opacity."""
    rows, columns, _ = halves.shape
    light, opacity = _tables()
    bits = halves.view("<u2")
    pixels = np.empty((2 * rows, columns, 3), np.uint8)
    np.take(light, bits[..., :3], out=pixels[:rows])
    pixels[rows:] = opacity[bits[..., 3:]]
    packed = io.BytesIO()
    Image.fromarray(pixels).save(packed, "WEBP", quality=quality, method=EFFORT)
    return packed.getvalue()


@cache
def _tables() -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Returns the byte of each half float (by its bits) as light and as opacity."""
    values = np.arange(1 << 16, dtype="<u2").view("<f2").astype(np.float64)
    values = np.nan_to_num(values, nan=0.0)
    light = np.clip(values / BRIGHTEST, 0.0, 1.0)
    bent = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    bytes_of = [np.rint(255.0 * share).astype(np.uint8) for share in (bent, values.clip(0.0, 1.0))]
    return bytes_of[0], bytes_of[1]


def _encoded_depths(
    depths: NDArray[np.float32], packing: Packing
) -> tuple[NDArray[np.uint16], float, float]:
    """Returns depths as whole steps between the nearest and the farthest, and these two [mm].

    Depths have shape [eyes, rows, columns], as the steps do.
    """
    every = packing.depth_every
    depths = depths[:, ::every, ::every]
    is_haze, depths = depths < 0, np.abs(depths)
    seen = np.isfinite(depths)
    if not seen.any():
        return np.full(depths.shape, NOTHING, "<u2"), 0.0, 1.0
    nearest = float(depths.min())
    span = max(float(depths.max(where=seen, initial=nearest)) - nearest, 1e-3)
    if packing.quality is not None:
        # few steps are packed smaller
        span = max(span, packing.depth_step * MOST_STEPS)
    rounded = (depths - nearest) * (MOST_STEPS / span) + 0.5
    steps = np.where(seen, rounded, NOTHING).astype("<u2")
    steps[seen & is_haze] |= np.uint16(HAZE)
    return steps, nearest, nearest + span


def _deflated(depths: NDArray[np.uint16]) -> bytes:
    """Returns differences along rows, first low bytes and then high ones, deflated."""
    differences = np.diff(depths, axis=-1, prepend=np.uint16(0))
    planes = np.stack([differences & 255, differences >> 8]).astype(np.uint8)
    return zlib.compress(planes.tobytes(), DEFLATE_LEVEL)
