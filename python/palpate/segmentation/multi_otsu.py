"""Thresholds that part a scan's values into classes, by Otsu's method.

Source: N. Otsu, "A threshold selection method from gray-level histograms", 1979; several
thresholds as ITK computes them.
"""

from __future__ import annotations

import math
from itertools import pairwise

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
    low, high = sorted(round((end - volume.intercept) / volume.slope) for end in volume.range)
    if high - low < classes - 1:
        raise EmptySegmentError(f"{volume.name} has too few values for {classes} classes")
    sitk = simpleitk()
    finder = sitk.OtsuMultipleThresholdsImageFilter()
    finder.SetNumberOfThresholds(classes - 1)
    finder.SetNumberOfHistogramBins(BINS)
    finder.Execute(sitk.GetImageFromArray(volume.array))
    # a class ends with its threshold
    ends = sorted(min(max(math.floor(end), low), high - 1) for end in finder.GetThresholds())
    stored = [low - 1, *ends, high]
    ranges = sorted(
        (
            min(volume.value_of(first + 1), volume.value_of(last)),
            max(volume.value_of(first + 1), volume.value_of(last)),
        )
        for first, last in pairwise(stored)
        if first < last
    )
    return [
        volume.threshold(first, last, name=f"Otsu {number} of {classes}")
        for number, (first, last) in enumerate(ranges[1:], start=2)
    ]
