"""A surface as a command or a recipe asks for it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from palpate.base.errors import OptionError
from palpate.base.file_suffixes import MESH_SUFFIXES
from palpate.base.request import Request, words
from palpate.volumes.appearance import SurfaceSource

__all__ = ["SurfaceRequest"]

SMOOTHEST = 12
STEPS = (1, 2, 4)


class SurfaceRequest(Request, frozen=True, kw_only=True):
    """The options of ``palpate surface export``."""

    out: Annotated[
        Path,
        words(
            "Mesh to write (.stl, .ply, .obj, .glb).",
            form="FILE",
            argument=True,
            writes=MESH_SUFFIXES,
        ),
    ]
    segment: Annotated[
        str | None, words("Name or number of the segment, if there are several.")
    ] = None
    smoothing: Annotated[
        int | None, words("Degree of smoothing, 0 to 12; 0 writes the voxels as they are.")
    ] = None
    step: Annotated[int | None, words("Cell size: 1, 2 or 4 voxels.")] = None
    source: Annotated[
        SurfaceSource | None,
        words(
            "intensities (of a threshold; smooth) or bits (the voxels; with steps); by default "
            "intensities, and bits with `smoothing=0`.",
            name="from",
        ),
    ] = None

    def check(self) -> None:
        """Refuses what no surface can be made with.

        Raises:
            OptionError: A number is not allowed.
        """
        if self.smoothing is not None and not 0 <= self.smoothing <= SMOOTHEST:
            raise OptionError(f"smoothing {self.smoothing} given; allowed: 0 to {SMOOTHEST}")
        if self.step is not None and self.step not in STEPS:
            raise OptionError(f"step {self.step} given; allowed: 1, 2, 4")
