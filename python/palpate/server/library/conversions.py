"""Files that become a scan once a page says how: headerless voxels, pictures and projections."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from palpate.base.errors import PalpateError
from palpate.base.progress import Progress
from palpate.io.headerless import Headerless, headerless_pictures, headerless_raw, laid_out
from palpate.io.preview import png_of, preview
from palpate.io.raw_voxels import RawLayout
from palpate.reconstruction.projections import ProjectionStack
from palpate.reconstruction.reconstruction import missing_library
from palpate.reconstruction.request import (
    ReconstructionRequest,
    grid_of,
    reconstruct_file,
    suggested,
)
from palpate.server.library.requests import LayoutRequest
from palpate.volumes.volume import Volume

__all__ = [
    "Headerless",
    "headerless_pictures",
    "headerless_raw",
    "headerless_summary",
    "layout_preview",
    "projections_summary",
    "reconstructed",
    "reconstruction_grid",
]

EDGE = 256
"""Longer side of the picture of the middle slice [pixel]."""


def headerless_summary(headerless: Headerless) -> dict[str, Any]:
    """Returns what a page shows of headerless files: how many, how large, the likely layout."""
    likely = headerless.layout
    return {
        "name": headerless.name,
        "files": headerless.files,
        "bytes": headerless.held,
        "size": headerless.size,
        "voxel": headerless.voxel,
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


def layout_preview(headerless: Headerless, wanted: LayoutRequest) -> dict[str, Any]:
    """Returns the size of the scan that a layout gives, and its middle slice as PNG.

    Raises:
        PalpateError: The files are not laid out like that.
    """
    layout = None if wanted.raw is None else RawLayout.of(wanted.raw)
    with _without_folders(headerless.path, headerless.path.parent):
        size, middle = laid_out(headerless.path, layout)
    across, down = (wanted.voxel_size or (1.0, 1.0))[:2]
    # a size that cannot be is refused where the scan is opened
    fits = min(across, down) > 0.0 and 0.1 < across / down < 10.0
    pixel = (across, down) if fits else (1.0, 1.0)
    png = b64encode(png_of(preview(middle, pixel, edge=EDGE))).decode("ascii")
    return {"size": size, "png": png}


def projections_summary(stack: ProjectionStack) -> dict[str, Any]:
    """Returns what a page shows of projections: their size, a likely request, a missing library."""
    return {
        "name": stack.name,
        "shape": stack.shape,
        "suggested": suggested(stack),
        "missing": missing_library(),
    }


def reconstruction_grid(stack: ProjectionStack, request: ReconstructionRequest) -> dict[str, Any]:
    """Returns the size of the scan that a request gives, and the edges of its voxels [mm].

    Raises:
        OptionError: The request is not allowed.
    """
    with _without_folders(*_folders(stack, request)):
        grid = grid_of(stack, request)
    return {"size": grid.size, "voxel": grid.voxel}


def reconstructed(
    stack: ProjectionStack, request: ReconstructionRequest, progress: Progress
) -> Volume:
    """Returns the scan that is reconstructed from projections.

    Raises:
        PalpateError: It cannot be made.
    """
    with _without_folders(*_folders(stack, request)):
        return reconstruct_file(stack.path, request, name=stack.name, progress=progress)


def _folders(stack: ProjectionStack, request: ReconstructionRequest) -> list[Path]:
    return [path.parent for path in (stack.path, request.geometry) if path is not None]


@contextmanager
def _without_folders(*folders: Path) -> Iterator[None]:
    """Tells errors with names of files alone: where they are is known, or is a folder of ours."""
    try:
        yield
    except PalpateError as error:
        reason = str(error)
        # a folder may lie within another
        for folder in sorted(map(str, folders), key=len, reverse=True):
            reason = reason.replace(f"{folder}/", "")
        raise type(error)(reason) from None
