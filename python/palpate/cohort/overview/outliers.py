"""Numbers that are far from the others of their kind, by a rule that outliers do not move.

Source: Iglewicz and Hoaglin, "How to Detect and Handle Outliers" (1993): modified z-scores.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

__all__ = ["FEWEST", "FURTHEST", "outliers"]

FURTHEST = 3.5
"""Largest modified z-score that is none."""
FEWEST = 5
"""Of fewer numbers nothing is said."""

OF_NORMAL = 0.6745
"""Median distance to the median of a normal distribution, by its standard deviation."""


def outliers(values: Sequence[float]) -> list[bool]:
    """Says which of some numbers are outliers; none where more than half are the same."""
    numbers = np.asarray(values, float)
    known = numbers[np.isfinite(numbers)]
    if len(known) < FEWEST:
        return [False] * len(numbers)
    middle = np.median(known)
    spread = np.median(np.abs(known - middle))
    if spread == 0.0:
        return [False] * len(numbers)
    far = OF_NORMAL * np.abs(numbers - middle) / spread > FURTHEST
    return [bool(each) for each in far]
