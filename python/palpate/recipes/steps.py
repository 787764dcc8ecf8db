"""Steps of recipes: the options of the commands, and what a recipe adds to them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Literal

import msgspec

from palpate.base.errors import OptionError
from palpate.base.file_suffixes import IMAGE_SUFFIXES
from palpate.base.request import Request, options_of, words
from palpate.export.request import ExportRequest
from palpate.io.request import ReadRequest
from palpate.pictures.request import PictureRequest
from palpate.reconstruction.request import ReconstructionRequest
from palpate.registration.request import RegisterRequest
from palpate.registration.transform_request import TransformRequest
from palpate.segmentation.measures.comparison_request import CompareRequest
from palpate.segmentation.measures.landmarks_request import LandmarksRequest
from palpate.segmentation.request import SegmentRequest
from palpate.session.touch_request import TouchRequest
from palpate.volumes.surface_request import SurfaceRequest

__all__ = [
    "ImportStep",
    "Recipe",
    "ReconstructStep",
    "RegisterStep",
    "TransformStep",
    "steps_of",
]


class ImportStep(ReadRequest, frozen=True, kw_only=True):
    """The scan, as ``palpate import`` reads it."""

    path: Annotated[Path, words("The scan.", reads=True)]


class ReconstructStep(ReconstructionRequest, frozen=True, kw_only=True):
    """The scan out of projections, as by ``palpate reconstruct``."""

    path: Annotated[Path, words("The projections.", reads=True)]
    output: Annotated[Path | None, words("Scan to write, in HU.", writes=IMAGE_SUFFIXES)] = None


class RegisterStep(RegisterRequest, frozen=True, kw_only=True):
    """Another scan that is brought to the first one, as by ``palpate register``."""

    go_on_with: Annotated[
        Literal["fixed", "moving"],
        words("The scan that segments are made of; moving is on the grid of the fixed one."),
    ] = "fixed"


class TransformStep(TransformRequest, frozen=True, kw_only=True):
    """A file that is carried as by ``palpate transform``, once all other files are written.

    Without ``like``, the grid for images is that of the recipe's scan.
    """

    path: Annotated[Path, words("The file that is carried.", reads=True)]
    # which ending fits depends on what is carried
    output: Annotated[Path, words("File to write.", writes=("",))]

    def check(self) -> None:
        """Refuses what could not be done, whatever the files are.

        Raises:
            OptionError: The moving scan is not given where its grid is needed.
        """
        if self.inverse and self.like is None:
            raise OptionError(
                "inverse without like given; allowed: inverse with like, the moving scan"
            )


class Recipe(Request, frozen=True, kw_only=True):
    """What is to be done, in this order."""

    scan: Annotated[ImportStep | None, words("The scan.", name="import")] = None
    reconstruct: Annotated[
        ReconstructStep | None, words("The scan out of projections, in the place of import.")
    ] = None
    register: Annotated[RegisterStep | None, words("A second scan, registered to it.")] = None
    segment: Annotated[list[SegmentRequest], words("Segments to make.")]
    surface: Annotated[list[SurfaceRequest], words("Surfaces to write.")] = msgspec.field(
        default_factory=list
    )
    export: Annotated[list[ExportRequest], words("Files to write.")] = msgspec.field(
        default_factory=list
    )
    compare: Annotated[list[CompareRequest], words("References to compare segments with.")] = (
        msgspec.field(default_factory=list)
    )
    landmarks: Annotated[list[LandmarksRequest], words("Landmarks of segments to list.")] = (
        msgspec.field(default_factory=list)
    )
    touch: Annotated[
        list[TouchRequest], words("Segments to press, stroke or drill by a script.")
    ] = msgspec.field(default_factory=list)
    transform: Annotated[list[TransformStep], words("Files to carry.")] = msgspec.field(
        default_factory=list
    )
    picture: Annotated[list[PictureRequest], words("Pictures and films to draw.")] = msgspec.field(
        default_factory=list
    )
    report: Annotated[
        Path | None, words("Report of pictures and volumes to write.", writes=(".html",))
    ] = None


def steps_of(recipe: Recipe) -> Iterator[tuple[str, Request]]:
    """Yields each step with its place, such as ``$.segment[0]``, in order; then the recipe."""
    for option in options_of(Recipe):
        step = getattr(recipe, option.field)
        if isinstance(step, Request):
            yield f"$.{option.name}", step
        elif isinstance(step, list):
            for number, each in enumerate(step):
                yield f"$.{option.name}[{number}]", each
    yield "$", recipe
