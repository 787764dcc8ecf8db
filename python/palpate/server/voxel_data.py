"""Voxels as the page asks for them: the scan's values, and the labels of its segments.

Layout: x fastest, then y, then z; values int16 little-endian, labels one byte. With ``step``
every step-th voxel of each axis, from the first on.
"""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from starlette.concurrency import run_in_threadpool
from starlette.responses import StreamingResponse

from palpate.base.errors import OptionError
from palpate.volumes.segment import Segment

__all__ = ["MOST_STEP", "labels_of", "parse_step", "voxels_response"]

MOST_STEP = 64
CHUNK_BYTES = 1 << 20


def parse_step(given: str | None) -> int:
    """Returns the step that a query asks for; 1 where it asks for none.

    Raises:
        OptionError: It is no whole number, or out of range.
    """
    if given is None:
        return 1
    if not (given.isascii() and given.isdecimal() and 1 <= int(given[:4]) <= MOST_STEP):
        raise OptionError(f"step {given[:40]!r} given; allowed: a whole number 1 to {MOST_STEP}")
    return int(given)


def voxels_response(array: NDArray[Any], *, step: int) -> StreamingResponse:
    """Streams voxels of an array [z, y, x], slab by slab."""
    depth, height, width = (-(-length // step) for length in array.shape)
    size = depth * height * width * array.itemsize
    return StreamingResponse(
        _slabs(array, step),
        media_type="application/octet-stream",
        headers={
            "Content-Length": str(size),
            "X-Palpate-Dimensions": f"{width} {height} {depth}",
        },
    )


async def _slabs(array: NDArray[Any], step: int) -> AsyncIterator[bytes]:
    # big enough to be quick, small enough that the page can show how far it is
    slice_bytes = array.shape[1] * array.shape[2] * array.itemsize
    slices = step * max(1, CHUNK_BYTES * step * step // slice_bytes)
    for first in range(0, array.shape[0], slices):
        part = array[first : first + slices : step, ::step, ::step]
        yield await run_in_threadpool(_little_endian, part)


def _little_endian(part: NDArray[Any]) -> bytes:
    return part.astype(part.dtype.newbyteorder("<"), copy=False).tobytes()


def labels_of(
    segments: dict[int, Segment], shape: tuple[int, int, int]
) -> tuple[NDArray[np.uint8], frozenset[int]]:
    """Returns the number of a voxel's segment, 0 where it has none; the last of several.

    Also returns the numbers of those that share voxels with others.
    """
    labels = np.zeros(shape, np.uint8)
    overlapping: set[int] = set()
    for segment_id, segment in segments.items():
        box = segment.bounding_box
        if box is not None:
            # most are small: the rest of their masks is never looked at
            x, y, z = (slice(low, high) for low, high in zip(*box, strict=True))
            inside = segment.mask()[z, y, x] != 0
            below = np.flatnonzero(np.bincount(labels[z, y, x][inside], minlength=256)[1:]) + 1
            if below.size > 0:
                overlapping.update(below.tolist(), (segment_id,))
            labels[z, y, x][inside] = segment_id
    return labels, frozenset(overlapping)
