"""A registration as a command or a recipe asks for it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import msgspec

from palpate.base.errors import OptionError
from palpate.base.file_suffixes import IMAGE_SUFFIXES
from palpate.base.interpolation import InterpolationChoice
from palpate.base.request import Request, words
from palpate.registration.choices import Kind, MetricChoice, Start

if TYPE_CHECKING:
    from palpate.registration.options import SearchOptions

__all__ = ["INTERPOLATED", "RegisterRequest"]

INTERPOLATED = (
    "linear (for scans), nearest or labels (the label with the largest share; for label maps), or "
    "automatic: nearest for label maps, otherwise linear."
)


class RegisterRequest(Request, frozen=True, kw_only=True):
    """The options of ``palpate register``, but those of the fixed scan."""

    moving: Annotated[
        Path, words("Moving scan, registered to the fixed one.", argument=True, reads=True)
    ]
    output: Annotated[
        Path | None, words("Transform to write (.tfm).", short="o", writes=(".tfm",))
    ] = None
    write_inverse: Annotated[
        Path | None,
        words(
            "Write the inverse transform, from points of MOVING to FIXED (.tfm).", writes=(".tfm",)
        ),
    ] = None
    interpolation: Annotated[InterpolationChoice, words(INTERPOLATED)] = "automatic"
    resampled: Annotated[
        Path | None,
        words(
            "Write the moving scan, resampled on the grid of the fixed one (.nii.gz, .nii, "
            ".nrrd, .mha).",
            writes=IMAGE_SUFFIXES,
        ),
    ] = None
    picture: Annotated[
        Path | None,
        words(
            "Write a checkerboard of both scans (.png): top before, bottom after registration.",
            writes=(".png",),
        ),
    ] = None
    report: Annotated[
        Path | None,
        words("Write figures, matrix and the course of the metric (.json).", writes=(".json",)),
    ] = None
    kind: Annotated[
        Kind,
        words("rigid, affine or bspline; each starts from the result of the one before."),
    ] = "rigid"
    metric: Annotated[
        MetricChoice,
        words(
            "mutual-information (for different modalities), correlation, mean-squares, or "
            "automatic: correlation for two CT scans, otherwise mutual information."
        ),
    ] = "automatic"
    start: Annotated[
        Start | None,
        words(
            "Initial alignment: geometry (as the files state), centre (of the grids), moments "
            "(centres of mass) or landmarks; by default landmarks if given, otherwise centre."
        ),
    ] = None
    landmarks: Annotated[
        Path | None, words("CSV file with pairs of points in mm.", form="FILE", reads=True)
    ] = None
    fixed_mask: Annotated[
        Path | None, words("Label map: use only these voxels of the fixed scan.", reads=True)
    ] = None
    moving_mask: Annotated[
        Path | None, words("Label map: use only these voxels of the moving scan.", reads=True)
    ] = None
    resample: Annotated[
        bool,
        words("Resample masks of files from another grid to that of the scan (nearest neighbour)."),
    ] = False
    another_patient: Annotated[
        bool,
        words("Take DICOM segments of another patient, study or frame of reference as they are."),
    ] = False
    knots: Annotated[float | None, words("Spacing of the B-spline's control points in mm.")] = None
    iterations: Annotated[
        int | None, words("Maximum number of iterations per stage and level.")
    ] = None
    samples: Annotated[int | None, words("Number of voxels sampled per level.")] = None
    seed: Annotated[int | None, words("Random seed of the sampling.")] = None
    moving_series: Annotated[str | int | None, words("DICOM series of the moving scan.")] = None
    moving_frame: Annotated[
        int | None, words("Volume of a moving image file that holds several.")
    ] = None

    @property
    def search(self) -> SearchOptions:
        """How the transform is searched."""
        from palpate.registration.options import SearchOptions

        given = {
            "knots": self.knots,
            "iterations": self.iterations,
            "bent_iterations": self.iterations,
            "samples": self.samples,
            "bent_samples": self.samples,
            "seed": self.seed,
        }
        return msgspec.convert(
            {name: each for name, each in given.items() if each is not None}, SearchOptions
        )

    def check(self) -> None:
        """Refuses what cannot be searched with, whatever the scans are.

        Raises:
            OptionError: A number is out of range, or landmarks lack.
        """
        self.search.check()
        if self.landmarks is not None:
            from palpate.registration.landmarks_file import read_landmarks

            read_landmarks(self.landmarks)
        if self.start == "landmarks" and self.landmarks is None:
            raise OptionError(
                "start 'landmarks' given without landmarks; allowed: with landmarks=FILE"
            )
