"""A line that was drawn on the picture, to split a segment along it.

Frame: scene, LPS [mm].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["PaintedCut"]

Triple = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class PaintedCut:
    """A line on the picture seen from an eye, given by points of the scene below it."""

    line: ArrayLike
    """Points in front of the eye, shape [count, 3]; two or more."""
    eye: Triple
    """Position of the eye."""
    view: Triple
    """Direction of view, of any length but zero."""
    closed: bool = False
    """Whether the line is closed; else it continues straight beyond both ends."""

    def given(self) -> tuple[NDArray[np.float64], Triple, Triple, bool]:
        """Returns the form that the engine takes."""
        points = np.ascontiguousarray(np.atleast_2d(np.asarray(self.line, dtype=np.float64)))
        return points, self.eye, self.view, self.closed
