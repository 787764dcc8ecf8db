"""A picture of the engine as the page puts it on the screen, before an even ground.

It does what ``composite.frag`` and ``upscale.frag`` do: coarse pictures are put together first and
enlarged then, others the other way round.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from palpate.pictures.looks import looks
from palpate.pictures.transfer import linear_from_hex

__all__ = ["enlarged", "on_page", "screen_from_linear"]

Pixels = NDArray[np.float64]

TOGETHER_FIRST = 3.0
"""Divisor above which a picture is put together before it is enlarged (compositor.ts)."""
BENT_FROM = 0.7
"""Linear value from which on highlights are bent."""


def on_page(colours: NDArray[np.floating], size: tuple[int, int]) -> Pixels:
    """Returns screen values from 0 to 1, shape [rows, columns, 3].

    Args:
        colours: Linear RGB multiplied by opacity, and opacity; shape [rows, columns, 4].
        size: Columns and rows of the view.
    """
    drawn = np.asarray(colours, np.float64)
    if size[0] > TOGETHER_FIRST * drawn.shape[1]:
        return enlarged(_put_together(drawn), size)
    return _put_together(enlarged(drawn, size))


def enlarged(pixels: Pixels, size: tuple[int, int]) -> Pixels:
    """Returns a picture in other columns and rows, bilinear between the pixels' middles."""
    for axis, count in ((1, size[0]), (0, size[1])):
        had = pixels.shape[axis]
        if had == count:
            continue
        at = np.clip((np.arange(count) + 0.5) * had / count - 0.5, 0.0, had - 1.0)
        lower = np.minimum(at.astype(int), max(0, had - 2))
        share = (at - lower).reshape([-1 if each == axis else 1 for each in range(pixels.ndim)])
        upper = np.minimum(lower + 1, had - 1)
        pixels = pixels.take(lower, axis) * (1.0 - share) + pixels.take(upper, axis) * share
    return pixels


def screen_from_linear(colours: NDArray[np.floating]) -> Pixels:
    """Returns sRGB of linear values, clipped to 0 to 1 (IEC 61966-2-1)."""
    clipped = np.clip(np.asarray(colours, np.float64), 0.0, 1.0)
    bent = 1.055 * clipped ** (1.0 / 2.4) - 0.055
    return np.where(clipped <= 0.0031308, 12.92 * clipped, bent)


def _put_together(drawn: Pixels) -> Pixels:
    ground = np.array(linear_from_hex(looks().ground.centre))
    light, opacity = drawn[..., :3], drawn[..., 3:]
    over = np.maximum(light - BENT_FROM, 0.0)
    room = 1.0 - BENT_FROM
    light = np.minimum(light, BENT_FROM) + room * (1.0 - np.exp(-over / room))
    return screen_from_linear(light + (1.0 - opacity) * ground)
