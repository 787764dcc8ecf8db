"""Pictures as PNG and JPEG files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from palpate.base.whole_file import whole_file

if TYPE_CHECKING:
    from PIL.Image import Image

__all__ = ["image_of", "write_picture"]

QUALITY = 92
"""Of JPEG: blocks are not seen."""


def image_of(picture: NDArray[np.uint8]) -> Image:
    """Returns a picture, shape [rows, columns, 4], without opacity where all of it is opaque."""
    from PIL import Image

    opaque = bool((picture[..., 3] == 255).all())
    return Image.fromarray(np.ascontiguousarray(picture[..., :3]) if opaque else picture)


def write_picture(picture: NDArray[np.uint8], path: Path) -> None:
    """Writes a picture, shape [rows, columns, 4]; its name tells the format.

    Raises:
        OSError: The disk refuses it.
    """
    with whole_file(path) as unfinished:
        image_of(picture).save(unfinished, quality=QUALITY)
