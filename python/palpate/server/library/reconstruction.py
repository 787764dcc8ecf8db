"""Projections on pages: what is told of them, the grid that they would give, the scan they make."""

from __future__ import annotations

from typing import Any

import msgspec

from palpate.base.progress import Progress
from palpate.reconstruction.projections import ProjectionStack
from palpate.reconstruction.reconstruction import missing_library
from palpate.reconstruction.request import (
    ReconstructionRequest,
    grid_of,
    reconstruct_file,
    suggested,
)
from palpate.volumes.volume import Volume

__all__ = ["WantedReconstruction", "grid_told", "made_of", "told_of"]


class WantedReconstruction(msgspec.Struct, frozen=True):
    """What a page asks to make of projections."""

    find: int
    request: ReconstructionRequest
    beside: bool = False
    """Whether the scan is shown with the open one, and not in its place."""


def told_of(stack: ProjectionStack) -> dict[str, Any]:
    """Returns what a page is told of projections: their kind, what is likely, what is missing."""
    return {
        "name": stack.name,
        "shape": stack.shape,
        "suggested": suggested(stack),
        "missing": missing_library(),
    }


def grid_told(stack: ProjectionStack, request: ReconstructionRequest) -> dict[str, Any]:
    """Returns the size of the scan that would come, and its voxels' edges [mm].

    Raises:
        OptionError: What is asked cannot be.
    """
    grid = grid_of(stack, request)
    return {"size": grid.size, "voxel": grid.voxel}


def made_of(stack: ProjectionStack, request: ReconstructionRequest, progress: Progress) -> Volume:
    """Returns the scan that projections tell.

    Raises:
        PalpateError: It cannot be made.
    """
    return reconstruct_file(stack.path, request, name=stack.name, progress=progress)
