"""A drive that takes a tool straight in until the force stops it, rests, and takes it out again."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from palpate.base.errors import OptionError

__all__ = ["Drive", "GivenDrive"]

Triple = tuple[float, float, float]

GivenDrive = tuple[Triple, Triple, float, float, float, float]
"""As the engine takes it."""


@dataclass(frozen=True, kw_only=True)
class Drive:
    """Where a tool goes and how it is pushed; points in the patient."""

    start: ArrayLike
    """Where the tool begins [mm], outside of all that is solid."""
    target: ArrayLike
    """Where it goes to [mm]."""
    speed: float = 5.0
    """How fast [mm/s]."""
    force_limit: float = 6.0
    """Where it stops [N]."""
    rest_secs: float = 1.0
    """How long it rests before it goes out [s]."""
    stiffness: float = 1.0
    """Of the spring between drive and tool [N/mm]."""

    def given(self) -> GivenDrive:
        """Returns what the engine takes.

        Raises:
            OptionError: A point is none.
        """
        ends = _point(self.start), _point(self.target)
        numbers = (self.speed, self.force_limit, self.rest_secs, self.stiffness)
        speed, force_limit, rest_secs, stiffness = map(float, numbers)
        return (*ends, speed, force_limit, rest_secs, stiffness)


def _point(given: ArrayLike) -> Triple:
    numbers = np.asarray(given, dtype=float)
    if numbers.shape != (3,):
        raise OptionError(f"point {given!r} given; allowed: three numbers [mm]")
    x, y, z = numbers.tolist()
    return x, y, z
