"""Thresholds that part a scan's values into classes, by Otsu's method.

Source: N. Otsu, "A threshold selection method from gray-level histograms", 1979; several
thresholds as ITK computes them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import EmptySegmentError, OptionError
from palpate.base.simpleitk import simpleitk
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume

__all__ = ["CLASSES", "otsu"]

CLASSES = (2, 3, 4)
"""Into how many classes a scan is parted; more take minutes."""

BINS = 256


def otsu(volume: Volume, *, classes: int = 2) -> list[Segment]:
    """Returns a segment for each class of values but the lowest, lower ones first.

    Each is a threshold, so that its range can be changed afterwards.

    Args:
        volume: The scan.
        classes: Into how many its values are parted: 2 to 4.

    Raises:
        OptionError: The number of classes is not offered.
        EmptySegmentError: The scan has fewer values than classes.
    """
    if classes not in CLASSES:
        allowed = ", ".join(map(str, CLASSES))
        raise OptionError(f"{classes} classes given; allowed: {allowed}")
    parted = _classes if volume.exact is None else _kept_classes
    ranges = parted(volume, classes)
    return [
        volume.threshold(first, last, name=f"Otsu {number} of {classes}")
        for number, (first, last) in enumerate(ranges[1:], start=2)
    ]


def _classes(volume: Volume, classes: int) -> list[tuple[float, float]]:
    """Returns the lowest and the highest value of each class, rising."""
    low, high = sorted(round((end - volume.intercept) / volume.slope) for end in volume.range)
    if high - low < classes - 1:
        raise EmptySegmentError(f"{volume.name} has too few values for {classes} classes")
    # a class ends with its threshold
    found = _thresholds(volume.array, classes)
    ends = sorted(min(max(math.floor(end), low), high - 1) for end in found)
    stored = [low - 1, *ends, high]
    return sorted(
        (
            min(volume.value_of(first + 1), volume.value_of(last)),
            max(volume.value_of(first + 1), volume.value_of(last)),
        )
        for first, last in pairwise(stored)
        if first < last
    )


def _kept_classes(volume: Volume, classes: int) -> list[tuple[float, float]]:
    """Returns the same of values that are kept as they were read."""
    values = volume.values()
    low, high = volume.range
    finite = values[~np.isnan(values)] if volume.missing else values.ravel()
    scale = 1.0
    if values.dtype == np.float64:
        # beyond single precision, in which ITK counts
        scale = max(abs(low), abs(high))
        finite = finite / scale
    found = sorted(scale * end for end in _thresholds(finite[None], classes))
    ends = [end for end in found if low <= end < high]
    if len(ends) < classes - 1:
        raise EmptySegmentError(f"{volume.name} has too few values for {classes} classes")
    # a class ends with the last value up to its threshold
    if values.dtype.kind == "f":
        lasts = [values.dtype.type(end) for end in ends]
        nexts = [np.nextafter(last, values.dtype.type(np.inf)) for last in lasts]
    else:
        lasts = [math.floor(end) for end in ends]
        nexts = [last + 1 for last in lasts]
    return list(zip([low, *map(float, nexts)], [*map(float, lasts), high], strict=True))


def _thresholds(values: NDArray[Any], classes: int) -> Sequence[float]:
    sitk = simpleitk()
    finder = sitk.OtsuMultipleThresholdsImageFilter()
    finder.SetNumberOfThresholds(classes - 1)
    finder.SetNumberOfHistogramBins(BINS)
    finder.Execute(sitk.GetImageFromArray(values))
    thresholds: Sequence[float] = finder.GetThresholds()
    return thresholds
