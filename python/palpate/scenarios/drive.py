"""A drive that moves a tool straight in up to a force limit, lets it rest, and moves it out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from palpate.base.errors import OptionError

__all__ = ["Drive", "GivenDrive"]

Triple = tuple[float, float, float]

GivenDrive = tuple[Triple, Triple, float, float, float, float]
"""Start, target, speed, force limit, rest and stiffness, as the engine takes them."""


@dataclass(frozen=True, kw_only=True)
class Drive:
    """Path of a tool and how it is pushed; points in the patient, LPS [mm]."""

    start: ArrayLike
    """Start of the tool [mm], outside of all rigid segments."""
    target: ArrayLike
    """End of the path [mm]."""
    speed: float = 5.0
    """Speed [mm/s]."""
    force_limit: float = 6.0
    """Force at which the drive stops [N]."""
    rest_secs: float = 1.0
    """Rest before the way out [s]."""
    stiffness: float = 1.0
    """Stiffness of the spring between drive and tool [N/mm]."""

    def given(self) -> GivenDrive:
        """Returns the form that the engine takes.

        Raises:
            OptionError: A point does not have three coordinates.
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
