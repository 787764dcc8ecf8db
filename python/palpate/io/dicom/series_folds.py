"""Long lists of scans made short: volumes of one series, such as 64 directions, are one entry."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

__all__ = ["LEAST", "folds"]

LEAST = 5
"""Volumes of one series that are listed as one."""


def folds(keys: Sequence[object]) -> list[range]:
    """Returns which places of a list are one entry, in their order.

    Args:
        keys: Of each place: what it is a volume of, or None where it stands alone.
    """
    found: list[range] = []
    for key, run in groupby(range(len(keys)), key=lambda place: keys[place]):
        places = list(run)
        together = key is not None and len(places) >= LEAST
        found += (
            [range(places[0], places[-1] + 1)]
            if together
            else [range(place, place + 1) for place in places]
        )
    return found
