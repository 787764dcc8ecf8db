"""Where the slices of nuclear medicine lie: from the first one on, along their normal.

Frame: LPS [mm]. Source: DICOM PS3.3, C.8.4.11 (NM detector), C.8.4.15 (NM reconstruction), whose
spacing between slices runs the other way where it is below 0; C.8.4.8 (vectors of frames).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

__all__ = ["detector_place"]

Place = tuple[tuple[float, ...], tuple[float, ...]]


def detector_place(dataset: Dataset, index: int) -> Place | None:
    """Returns position and orientation of a reconstructed frame; None where nothing tells them."""
    detectors = dataset.get("DetectorInformationSequence")
    kind = dataset.get("ImageType") or []
    if not detectors or not (len(kind) > 2 and "RECON" in str(kind[2])):
        return None
    try:
        first = np.array([float(number) for number in detectors[0].ImagePositionPatient])
        told = [float(number) for number in detectors[0].ImageOrientationPatient]
        step = float(dataset.get("SpacingBetweenSlices") or dataset.get("SliceThickness") or 0.0)
    except (AttributeError, TypeError, ValueError):
        return None
    if len(first) != 3 or len(told) != 6 or step == 0.0 or not math.isfinite(step):
        return None
    normal = np.cross(told[:3], told[3:])
    position = first + _slice_of(dataset, index) * step * normal
    return tuple(float(number) for number in position), tuple(told)


def _slice_of(dataset: Dataset, index: int) -> int:
    """Returns which slice a frame shows, from 0."""
    vector = dataset.get("SliceVector")
    if vector is not None and not isinstance(vector, int):
        return int(vector[index]) - 1 if index < len(vector) else index
    slices = dataset.get("NumberOfSlices")
    return index % int(slices) if slices else index
