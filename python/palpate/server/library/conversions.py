"""Raw voxels and pictures on pages: what is told of them, and what a layout makes of them."""

from __future__ import annotations

from base64 import b64encode
from typing import Any

import msgspec

from palpate.base.errors import PalpateError
from palpate.io.headerless import Bare, bare_pictures, bare_raw, laid_out
from palpate.io.preview import png_of, preview
from palpate.io.raw_voxels import RawLayout

__all__ = ["Bare", "WantedLayout", "bare_pictures", "bare_raw", "bare_told", "layout_told"]

EDGE = 256
"""Of the picture of the middle slice [pixel]."""


class WantedLayout(msgspec.Struct, frozen=True):
    """How a page says that files are laid out."""

    find: int
    raw: str | None = None
    """As ``palpate.read`` takes it; None of pictures."""
    voxel_size: tuple[float, float, float] | None = None
    """[mm]; it says how high the picture of a slice is."""


def bare_told(bare: Bare) -> dict[str, Any]:
    """Returns what a page is told of files: how many, how large, what is likely."""
    likely = bare.layout
    return {
        "name": bare.name,
        "files": bare.files,
        "bytes": bare.held,
        "size": bare.size,
        "voxel": bare.voxel,
        "layout": likely
        and {
            "columns": likely.columns,
            "rows": likely.rows,
            "slices": likely.slices,
            "kind": likely.kind.name,
            "order": "big" if likely.kind.str.startswith(">") else "little",
            "skip": likely.skip,
        },
    }


def layout_told(bare: Bare, wanted: WantedLayout) -> dict[str, Any]:
    """Returns the size of the scan that would come, and its middle slice.

    Raises:
        PalpateError: The files are not laid out like that.
    """
    layout = None if wanted.raw is None else RawLayout.of(wanted.raw)
    try:
        size, middle = laid_out(bare.path, layout)
    except PalpateError as error:
        # where files are is known, or is a folder of our own
        said = str(error).replace(f"{bare.path}/", "").replace(f"{bare.path.parent}/", "")
        raise type(error)(said) from None
    across, down = (wanted.voxel_size or (1.0, 1.0))[:2]
    # a size that cannot be is refused where the scan is opened
    fits = min(across, down) > 0.0 and 0.1 < across / down < 10.0
    pixel = (across, down) if fits else (1.0, 1.0)
    png = b64encode(png_of(preview(middle, pixel, edge=EDGE))).decode("ascii")
    return {"size": size, "png": png}
