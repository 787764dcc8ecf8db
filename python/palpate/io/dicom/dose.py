"""Doses of radiotherapy (RTDOSE): where their planes lie, and what their numbers mean.

A dose is one file with a frame for each plane, whose places stand in Grid Frame Offset Vector:
from the first plane along the normal where it begins with 0, else as z of the patient. Values are
stored numbers times Dose Grid Scaling.

Frame: LPS [mm]. Source: DICOM PS3.3, C.8.8.3 (RT dose), C.8.8.3.2 (both kinds of offsets).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import VolumeFormatError

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

    from palpate.io.dicom.header import Frame, Series

__all__ = ["RTDOSE", "DoseTags", "dose_tags_of", "dose_told"]

RTDOSE = "RTDOSE"
UNITS = {"GY": "Gy", "RELATIVE": "relative"}
WHOLE_PLANS = ("PLAN", "MULTI_PLAN", "PLAN_OVERVIEW", "")
"""Summation types of all that is to be given."""
DOSE_TYPES = {
    "EFFECTIVE": "the dose is corrected for biological effect (DoseType EFFECTIVE)",
    "ERROR": "the values are a difference of doses (DoseType ERROR)",
}
SAME_PLACE = 0.01
"""By how much an offset and a position that are the same may differ [mm]."""
STRAIGHT = 1e-4
"""By how much the normal of planes across z may lean."""


@dataclass(frozen=True)
class DoseTags:
    """What a dose says of itself beside its pixels."""

    unit: str
    summation: str
    """What was summed up, such as "PLAN"; "" where it does not tell."""
    refused: str
    """Why it cannot be read; "" where it can."""
    told: tuple[str, ...]
    frames: tuple[Frame, ...]
    """With their places and their scale."""


def dose_tags_of(dataset: Dataset, frames: tuple[Frame, ...]) -> DoseTags:
    """Returns what a dose says of itself.

    Args:
        dataset: Of the file.
        frames: As they are told for all kinds of files.
    """
    units = _text(dataset, "DoseUnits")
    summation = _text(dataset, "DoseSummationType")
    scaling = _scaling(dataset)
    places, refused = _places(dataset, frames)
    if scaling is None:
        refused = "has no DoseGridScaling above 0; allowed: doses that tell their scale"
    elif dataset.get("ModalityLUTSequence"):
        refused = "has a ModalityLUTSequence; allowed: doses by DoseGridScaling alone"
    elif units not in UNITS:
        refused = f"has DoseUnits {units or 'missing'}; allowed: {', '.join(UNITS)}"
    scale = None if scaling is None else (scaling, 0.0)
    laid = [replace(frame, scale=scale) for frame in frames]
    if places is not None:
        laid = [
            replace(frame, position=tuple(map(float, place)))
            for frame, place in zip(laid, places, strict=True)
        ]
    told = _told(units, summation, _text(dataset, "DoseType"))
    return DoseTags(UNITS.get(units, ""), summation, refused, told, tuple(laid))


def dose_told(what: str, series: Series) -> list[str]:
    """Returns what is to be told of a dose; nothing of other scans.

    Raises:
        VolumeFormatError: It does not tell where its planes lie, or what its numbers mean.
    """
    told: dict[str, None] = {}
    for header in series.headers:
        if header.dose is None:
            continue
        if header.dose.refused:
            raise VolumeFormatError(f"{what} {header.dose.refused}")
        told |= dict.fromkeys(header.dose.told)
    return list(told)


def _told(units: str, summation: str, dose_type: str) -> tuple[str, ...]:
    said = []
    if summation not in WHOLE_PLANS:
        said.append(f"the dose is not that of a whole plan (DoseSummationType {summation})")
    if units == "RELATIVE":
        said.append("the dose is relative to a dose that its file does not tell, not in Gy")
    if dose_type in DOSE_TYPES:
        said.append(DOSE_TYPES[dose_type])
    return tuple(said)


def _places(dataset: Dataset, frames: Sequence[Frame]) -> tuple[NDArray[np.float64] | None, str]:
    """Returns where planes lie, shape [planes, 3], or why that is not known."""
    first = frames[0]
    if len(frames) == 1:
        return None, ""
    if first.position is None or first.orientation is None:
        return None, "has no ImagePositionPatient or ImageOrientationPatient; allowed: both"
    offsets = _offsets(dataset)
    if len(offsets) != len(frames):
        return None, (
            f"has {len(offsets)} offsets in GridFrameOffsetVector for {len(frames)} planes; "
            "allowed: one for each"
        )
    position, cosines = np.array(first.position), np.array(first.orientation)
    normal = np.cross(cosines[:3], cosines[3:])
    if offsets[0] == 0.0:
        return position + offsets[:, None] * normal, ""
    if abs(offsets[0] - position[2]) <= SAME_PLACE and 1.0 - abs(normal[2]) <= STRAIGHT:
        places = np.repeat(position[None], len(offsets), axis=0)
        places[:, 2] = offsets
        return places, ""
    return None, (
        f"has a GridFrameOffsetVector from {offsets[0]:g} mm on, which is neither 0 nor the z of "
        "ImagePositionPatient with planes across z; allowed: these two"
    )


def _offsets(dataset: Dataset) -> NDArray[np.float64]:
    try:
        offsets = np.array([float(one) for one in dataset.get("GridFrameOffsetVector") or ()])
    except (TypeError, ValueError):
        return np.empty(0)
    return offsets if np.isfinite(offsets).all() else np.empty(0)


def _scaling(dataset: Dataset) -> float | None:
    try:
        scaling = float(str(dataset.get("DoseGridScaling")))
    except (TypeError, ValueError):
        return None
    return scaling if math.isfinite(scaling) and scaling > 0.0 else None


def _text(dataset: Dataset, name: str) -> str:
    return str(dataset.get(name) or "").strip()
