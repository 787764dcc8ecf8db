"""A picture of the engine as the message that takes it to a page.

Uncompressed: on one machine deflating takes longer than what it saves. Colours stay linear, in
half floats, since the page puts them over its ground and bends highlights after that.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from palpate import protocol
from palpate.pictures.session_pictures import DrawnArrays

__all__ = ["encoded_picture"]

NOTHING = 65535
"""Depth where nothing is."""


def encoded_picture(
    picture: DrawnArrays,
    *,
    number: int,
    divisor: float,
    samples: int,
    finished: bool,
    seconds: float,
) -> protocol.DrawnPicture:
    """Returns the message with a picture that took so many seconds."""
    depths, nearest, farthest = _encoded_depths(picture.depths)
    rows, columns = picture.depths.shape
    return protocol.DrawnPicture(
        number=number,
        size=(columns, rows),
        divisor=divisor,
        samples=samples,
        finished=finished,
        milliseconds=1000.0 * seconds,
        colours=picture.colours.astype("<f2").tobytes(),
        depths=depths.tobytes(),
        nearest=nearest,
        farthest=farthest,
    )


def _encoded_depths(depths: NDArray[np.float32]) -> tuple[NDArray[np.uint16], float, float]:
    """Returns depths as whole steps between the nearest and the farthest, and these two [mm]."""
    seen = np.isfinite(depths)
    if not seen.any():
        return np.full(depths.shape, NOTHING, "<u2"), 0.0, 1.0
    nearest = float(depths.min())
    farthest = max(float(depths.max(where=seen, initial=nearest)), nearest + 1e-3)
    scale = (NOTHING - 1) / (farthest - nearest)
    steps = np.where(seen, (depths - nearest) * scale + 0.5, NOTHING)
    return np.minimum(steps, NOTHING).astype("<u2"), nearest, farthest
