"""What the part of a cut segment is called: by the side of the body on which it lies."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
from numpy.typing import ArrayLike

__all__ = ["part_name"]

SIDES = (("right", "left"), ("front", "back"), ("lower", "upper"))
"""Along L, P and S: of the negative and of the positive direction."""
LEAST_SHARE = 0.1
"""Middles that are nearer than this share of the whole lie on no side of one another."""
LONGEST = 80
"""Characters of the whole's name that are kept."""


def part_name(whole: str, offset: ArrayLike | None, size: float, *, taken: Collection[str]) -> str:
    """Returns a name that no other segment has.

    Args:
        whole: Name of the segment that was cut.
        offset: From the middle of the rest to that of the part, LPS [mm]; None where the sides of
            the body are not known.
        size: Largest extent of the rest [mm].
        taken: Names of all segments.

    Example:
        >>> part_name("skull", (0.0, 2.0, 40.0), 150.0, taken=["skull"])
        'skull, upper part'
    """
    named = f"{whole[:LONGEST]}, {_side(offset, size)}part"
    count = 1
    name = named
    while name in taken:
        count += 1
        name = f"{named} {count}"
    return name


def _side(offset: ArrayLike | None, size: float) -> str:
    if offset is None:
        return ""
    away = np.asarray(offset, np.float64)
    axis = int(np.abs(away).argmax())
    if abs(away[axis]) <= LEAST_SHARE * size:
        return ""
    return SIDES[axis][int(away[axis] > 0.0)] + " "
