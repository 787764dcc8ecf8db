"""A picture in strips side by side: none takes long, and none needs much memory."""

from __future__ import annotations

import math
from dataclasses import dataclass

import msgspec

from palpate.base.errors import OptionError
from palpate.pictures.camera import Camera
from palpate.pictures.choices import Size

__all__ = ["Strip", "strips_of"]

MOST_RAYS = 1 << 18
"""Of a strip: a tenth of a second on two cores."""
NARROWEST = 16
"""Columns of a strip."""
MOST_ASIDE = 1.0
"""Of an eye that a camera can have."""
MOST_WHOLE = 1 << 24
"""Pixels of a picture that is not divided."""


@dataclass(frozen=True)
class Strip:
    """All rows of some columns of a picture."""

    camera: Camera
    """Sees these columns alone."""
    size: Size
    """Columns and rows."""


def strips_of(camera: Camera, size: Size, *, samples: int) -> list[Strip]:
    """Divides a picture; every ray stays where it is.

    A strip is the picture of an eye that looks straight ahead through a window beside it
    (Bourke, "Calculating stereo pairs", 1999). So far aside that a camera cannot look there, the
    picture stays whole.

    Args:
        camera: Of the whole picture.
        size: Its columns and rows.
        samples: Rays for each pixel.

    Returns:
        Strips from the left to the right.

    Raises:
        OptionError: The picture has to stay whole, and has too many pixels for that.
    """
    columns, rows = size
    width = max(NARROWEST, MOST_RAYS // (rows * samples) // NARROWEST * NARROWEST)
    strips = []
    for first in range(0, columns, width):
        count = min(width, columns - first)
        # how far the strip's middle is from the picture's [half the picture's width]
        beside = (2 * first + count) / columns - 1.0
        strips.append(Strip(_beside(camera, size, beside), (count, rows)))
    if all(abs(strip.camera.aside) <= MOST_ASIDE for strip in strips):
        return strips
    if columns * rows > MOST_WHOLE:
        raise OptionError(
            f"picture of {columns} × {rows} pixels given; allowed where it is so much wider than "
            f"high: {MOST_WHOLE} in all"
        )
    return [Strip(camera, size)]


def _beside(camera: Camera, size: Size, beside: float) -> Camera:
    """Returns a camera with the same eye and another middle of the picture."""
    shift = beside * math.tan(camera.field / 2.0) * size[0] / size[1]
    if camera.parallel is not None:
        return _moved(camera, shift * camera.distance)
    moved = _moved(camera, shift * camera.distance)
    return msgspec.structs.replace(moved, aside=camera.aside - shift)


def _moved(camera: Camera, right: float) -> Camera:
    """Returns a camera that looks at a point so far to the right of its target [mm]."""
    x, y, z = (
        place + right * axis for place, axis in zip(camera.target, camera.right, strict=True)
    )
    return msgspec.structs.replace(camera, target=(x, y, z))
