"""Pictures as PNG and JPEG files."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from palpate.base.whole_file import whole_file

if TYPE_CHECKING:
    from PIL.Image import Image

__all__ = ["image_of", "png_bytes", "write_picture"]

QUALITY = 92
"""Of JPEG: blocks are not seen."""


def image_of(picture: NDArray[np.uint8]) -> Image:
    """Returns a picture, shape [rows, columns, 3 or 4], without opacity where all is opaque."""
    from PIL import Image

    opaque = picture.shape[-1] == 3 or bool((picture[..., 3] == 255).all())
    return Image.fromarray(np.ascontiguousarray(picture[..., :3]) if opaque else picture)


def png_bytes(picture: NDArray[np.uint8]) -> bytes:
    """Returns a picture, shape [rows, columns, 3 or 4], as a PNG file."""
    file = BytesIO()
    image_of(picture).save(file, "PNG")
    return file.getvalue()


def write_picture(picture: NDArray[np.uint8], path: Path) -> None:
    """Writes a picture, shape [rows, columns, 4]; its name tells the format.

    Raises:
        OSError: The disk refuses it.
    """
    with whole_file(path) as unfinished:
        image_of(picture).save(unfinished, quality=QUALITY)
