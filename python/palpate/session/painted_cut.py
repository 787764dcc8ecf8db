"""A line that was painted on the picture, to cut a segment along.

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
    """A line on the picture of an eye, by points of the scene that lie under it."""

    line: ArrayLike
    """Points before the eye, shape [count, 3]; two or more."""
    eye: Triple
    """Where the eye is."""
    view: Triple
    """Where it looks, of any length but zero."""
    closed: bool = False
    """Whether its end is joined to its beginning; else both go on straight without end."""

    def given(self) -> tuple[NDArray[np.float64], Triple, Triple, bool]:
        """Returns what the engine takes."""
        points = np.ascontiguousarray(np.atleast_2d(np.asarray(self.line, dtype=np.float64)))
        return points, self.eye, self.view, self.closed
