"""What is carried through a transform, as a command or a recipe asks for it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from palpate.base.interpolation import InterpolationChoice
from palpate.base.request import Request, words
from palpate.base.segment_file_options import AnotherPatient, Resample
from palpate.registration.request import INTERPOLATED

__all__ = ["TransformRequest"]


class TransformRequest(Request, frozen=True, kw_only=True):
    """The options of ``palpate transform``, but those of the files that are carried."""

    transform: Annotated[
        Path,
        words("Transform (.tfm or .h5) from points of FIXED to MOVING.", form="FILE", reads=True),
    ]
    inverse: Annotated[
        bool,
        words("Carry from FIXED to MOVING; by default it is from MOVING to FIXED."),
    ] = False
    like: Annotated[
        Path | None,
        words(
            "Scan with the grid for images: FIXED, or MOVING with `inverse=True`. Surfaces and "
            "points need none.",
            form="SCAN",
            reads=True,
        ),
    ] = None
    of: Annotated[
        Path | None,
        words(
            "Scan that the segments of a DICOM SEG or RTSTRUCT belong to.", form="SCAN", reads=True
        ),
    ] = None
    resample: Resample = False
    another_patient: AnotherPatient = False
    interpolation: Annotated[InterpolationChoice, words(INTERPOLATED)] = "automatic"
    series: Annotated[str | int | None, words("DICOM series of the input scan.")] = None
    like_series: Annotated[str | int | None, words("DICOM series of the scan with the grid.")] = (
        None
    )
    frame: Annotated[Literal["LPS", "RAS"] | None, words("Frame of a mesh: LPS or RAS.")] = None
    unit: Annotated[Literal["mm", "m"] | None, words("Unit of a mesh: mm or m.")] = None
