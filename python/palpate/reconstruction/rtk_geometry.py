"""Geometry files of RTK (XML), held against what they state twice and what can be reconstructed.

Source: RTK's documentation, "3D Circular Projection Geometry". Lengths are taken as mm.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import VolumeFormatError
from palpate.base.request import shown
from palpate.reconstruction.rtk_xml import MATRIX, stated_in
from palpate.reconstruction.scanner import Scanner
from palpate.reconstruction.views import View, largest_gap

__all__ = ["read_geometry"]

MATRIX_TOLERANCE = 1e-3
"""Largest difference between numbers of a stored matrix and that of the parameters, as in RTK."""
LARGEST_GAP = 20.0
"""Largest angle without a projection [degrees]; from there on RTK takes a scan as a short one."""
MOST_TILT = 10.0
"""Largest tilt of the detector [degrees]; the error in the air around a ball of water is 8 HU
without a tilt, 19 HU with this one and 53 HU with twice as much."""
OPEN = 1e6
"""Place of a jaw from which on it is none [mm]; RTK writes the largest number."""
JAWS = ("CollimationUInf", "CollimationUSup", "CollimationVInf", "CollimationVSup")


def read_geometry(
    path: str | PathLike[str],
    *,
    pixel: tuple[float, float],
    offset: tuple[float, float] = (0.0, 0.0),
) -> Scanner:
    """Reads the geometry of projections from a file of RTK.

    The frame is that of IEC 61217: at angle 0 the source is in front of a patient in supine
    position.

    Args:
        path: An XML file ``RTKThreeDCircularGeometry`` of version 2 or 3.
        pixel: Pixel size of the detector along u and v [mm].
        offset: u and v of the detector's middle [mm], where RTK's images do not lie around 0; what
            the file states of each projection is added.

    Returns:
        Geometry for ``palpate.reconstruction.reconstruct``.

    Raises:
        FileNotFoundError: ``path`` does not exist.
        VolumeFormatError: It is no such file, contradicts itself, or cannot be reconstructed from.
    """
    path = Path(path)
    views = [
        _view(stated, f"{path}, projection {number}")
        for number, stated in enumerate(stated_in(path), 1)
    ]
    parallel = views[0].source_to_detector == 0.0
    for number, view in enumerate(views, 1):
        if (view.source_to_detector == 0.0) != parallel:
            raise VolumeFormatError(
                f"{path}, projection {number}: a parallel beam among cone beams, or the reverse; "
                "allowed: SourceToDetectorDistance 0 in all projections, or in none"
            )
    if parallel:
        return _of_parallel_beams(views, path, pixel=pixel, offset=offset)
    _check_cone(views, path)
    angles = [view.angle for view in views]
    return Scanner(
        beam="cone", angles=angles, pixel=pixel, offset=offset, zero="front", views=tuple(views)
    )


# --- one projection -----------------------------------------------------------------------


def _view(stated: Mapping[str, str], where: str) -> View:
    """Returns what a projection states.

    Raises:
        VolumeFormatError: It lacks something, contradicts itself, or cannot be reconstructed from.
    """
    for name in ("GantryAngle", MATRIX):
        if name not in stated:
            raise VolumeFormatError(f"{where}: {name} is missing; allowed: one in each projection")
    given = {
        name: _number(name, text, where)
        for name, text in stated.items()
        if name != MATRIX and name not in JAWS
    }
    _check_jaws(stated, where)
    if given.get("RadiusCylindricalDetector", 0.0) != 0.0:
        raise VolumeFormatError(
            f"{where}: RadiusCylindricalDetector {given['RadiusCylindricalDetector']:g} given; "
            "allowed: 0, as filtered back-projection takes detectors as flat"
        )
    view = View(
        angle=given["GantryAngle"],
        out_of_plane=given.get("OutOfPlaneAngle", 0.0),
        in_plane=given.get("InPlaneAngle", 0.0),
        source_to_axis=given.get("SourceToIsocenterDistance", 0.0),
        source_to_detector=given.get("SourceToDetectorDistance", 0.0),
        source_offset=(given.get("SourceOffsetX", 0.0), given.get("SourceOffsetY", 0.0)),
        detector_offset=(
            given.get("ProjectionOffsetX", 0.0),
            given.get("ProjectionOffsetY", 0.0),
        ),
    )
    _check_matrix(view, stated[MATRIX], where)
    return view


def _check_jaws(stated: Mapping[str, str], where: str) -> None:
    for name in JAWS:
        text = stated.get(name, "inf")
        try:
            open_ = float(text) >= OPEN
        except ValueError:
            open_ = False
        if not open_:
            raise VolumeFormatError(
                f"{where}: {name} {shown(text)} given; allowed: none, as pixels behind a jaw of "
                "the collimator do not show the patient"
            )


def _number(name: str, text: str, where: str) -> float:
    try:
        value = float(text.replace("_", "?"))
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise VolumeFormatError(f"{where}: {name} {shown(text)} given; allowed: a number")
    return value


def _check_matrix(view: View, text: str, where: str) -> None:
    """Refuses a matrix that is not that of the parameters, as RTK does."""
    numbers = [_number(MATRIX, word, where) for word in text.split()]
    if len(numbers) != 12:
        raise VolumeFormatError(f"{where}: {MATRIX} of {len(numbers)} numbers; allowed: 3 x 4")
    found: NDArray[np.float64] = np.abs(np.reshape(numbers, (3, 4)) - view.matrix)
    row, column = np.unravel_index(np.argmax(found), found.shape)
    if found[row, column] > MATRIX_TOLERANCE:
        raise VolumeFormatError(
            f"{where}: {MATRIX} has {numbers[4 * row + column]:.9g} in row {row + 1}, column "
            f"{column + 1}, and the angles and distances give {view.matrix[row, column]:.9g}; "
            f"allowed: a difference of {MATRIX_TOLERANCE:g}"
        )


# --- all projections ----------------------------------------------------------------------


def _of_parallel_beams(
    views: list[View], path: Path, *, pixel: tuple[float, float], offset: tuple[float, float]
) -> Scanner:
    """Returns the geometry of parallel beams: angles, and one place of the detector.

    Raises:
        VolumeFormatError: A detector is tilted or moves, or a source is not before its middle.
    """
    aside = views[0].detector_offset
    for number, view in enumerate(views, 1):
        for name, value, allowed in (
            ("OutOfPlaneAngle", view.out_of_plane % 360.0, 0.0),
            ("InPlaneAngle", view.in_plane % 360.0, 0.0),
            ("SourceOffsetX", view.source_offset[0], 0.0),
            ("SourceOffsetY", view.source_offset[1], 0.0),
            ("ProjectionOffsetX", view.detector_offset[0], aside[0]),
            ("ProjectionOffsetY", view.detector_offset[1], aside[1]),
        ):
            if value != allowed:
                raise VolumeFormatError(
                    f"{path}, projection {number}: {name} {value:g} with parallel beams given; "
                    f"allowed: {allowed:g}, as each row of the detector is reconstructed alone"
                )
    # RTK stores angles from 0 to 360
    angles = np.unwrap([view.angle for view in views], period=360.0)
    middle = (offset[0] + aside[0], offset[1] + aside[1])
    return Scanner(
        beam="parallel", angles=angles.tolist(), pixel=pixel, offset=middle, zero="front"
    )


def _check_cone(views: list[View], path: Path) -> None:
    """Refuses what Feldkamp's method cannot reconstruct from."""
    for number, view in enumerate(views, 1):
        if not 0.0 < view.source_to_axis < view.source_to_detector:
            raise VolumeFormatError(
                f"{path}, projection {number}: SourceToIsocenterDistance {view.source_to_axis:g} "
                f"and SourceToDetectorDistance {view.source_to_detector:g} given; allowed: above "
                "0, the axis nearer than the detector"
            )
        # in the plane a detector may stand on its head
        for name, angle, turn in (
            ("OutOfPlaneAngle", view.out_of_plane, 360.0),
            ("InPlaneAngle", view.in_plane, 180.0),
        ):
            if abs(math.remainder(angle, turn)) > MOST_TILT:
                raise VolumeFormatError(
                    f"{path}, projection {number}: {name} {angle:g} given; allowed: tilts of at "
                    f"most {MOST_TILT:g} degrees, as rows are filtered across the rotation axis"
                )
    gap = largest_gap(views)
    if gap > LARGEST_GAP:
        raise VolumeFormatError(
            f"{path} has no projection within {gap:.1f} degrees; allowed: gaps of at most "
            f"{LARGEST_GAP:g} over a full circle"
        )
