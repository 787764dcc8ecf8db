"""Small pictures of slices, for lists of scans: 8-bit grey, as PNG.

Source of the file format: W3C, Portable Network Graphics (Third Edition), chapters 5 and 11.
"""

from __future__ import annotations

import struct
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["png_of", "preview"]

EDGE = 96
"""Of the longer side [pixel]."""
LARGEST = 1e38
SHOWN = 1.0, 99.5
"""Percentiles of the values that are black and white."""


def preview(
    values: NDArray[Any], pixel: tuple[float, float], *, edge: int = EDGE
) -> NDArray[np.uint8]:
    """Returns a slice [rows, columns] with square pixels, at most ``edge`` on its longer side.

    Args:
        values: Of the slice.
        pixel: Between columns, between rows [mm].
        edge: The longer side [pixel].
    """
    rows, columns = values.shape
    wide, high = columns * pixel[0], rows * pixel[1]
    scale = edge / max(wide, high)
    across = _picked(columns, max(1, round(wide * scale)))
    down = _picked(rows, max(1, round(high * scale)))
    with np.errstate(invalid="ignore"):
        small = values[np.ix_(down, across)].astype(np.float64)
    small[~np.isfinite(small)] = 0.0
    # numbers read the wrong way may be of any size
    np.clip(small, -LARGEST, LARGEST, out=small)
    low, high_value = np.percentile(small, SHOWN)
    shade = (small - low) / max(float(high_value - low), 1e-6)
    return np.asarray(np.rint(np.clip(shade, 0.0, 1.0) * 255.0), np.uint8)


def png_of(picture: NDArray[np.uint8]) -> bytes:
    """Returns a grey picture [rows, columns] as a PNG file."""
    rows, columns = picture.shape
    # each row begins with its filter: none
    lines = np.zeros((rows, columns + 1), np.uint8)
    lines[:, 1:] = picture
    head = struct.pack(">IIBBBBB", columns, rows, 8, 0, 0, 0, 0)
    parts = ((b"IHDR", head), (b"IDAT", zlib.compress(lines.tobytes(), 6)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
        for kind, body in parts
    )


def _picked(count: int, wanted: int) -> NDArray[np.intp]:
    return ((np.arange(wanted) + 0.5) * count / wanted).astype(np.intp)
