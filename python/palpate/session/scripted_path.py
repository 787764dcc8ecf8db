"""A path for the device instead of a hand: positions at times.

Frame: scene, LPS [mm]; times in s since the start of the path. Between two positions the device
moves in a straight line at constant speed; after the last one it stays there.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate.base.errors import OptionError

__all__ = ["ScriptedPath"]


class ScriptedPath:
    """Positions at increasing times; ``move`` and ``hold`` return a longer path."""

    def __init__(self, points: ArrayLike, times: ArrayLike = (0.0,)) -> None:
        """Takes positions and their times.

        Args:
            points: One position, or several, in the scene, LPS [mm], shape [count, 3].
            times: A time for each position [s], increasing from 0.

        Raises:
            OptionError: Numbers are not finite, times do not increase from 0, or counts differ.
        """
        self.points: NDArray[np.float64] = np.atleast_2d(np.asarray(points, dtype=np.float64))
        self.times: NDArray[np.float64] = np.atleast_1d(np.asarray(times, dtype=np.float64))
        if self.points.shape != (len(self.times), 3):
            raise OptionError(
                f"path has points of shape {list(self.points.shape)} and {len(self.times)} times; "
                "allowed: one point (x, y, z) for each time"
            )
        if not (np.isfinite(self.points).all() and np.isfinite(self.times).all()):
            raise OptionError("path has NaN or infinite numbers; allowed: finite ones")
        if self.times[0] != 0.0 or (np.diff(self.times) <= 0.0).any():
            raise OptionError("path has times that do not rise from 0; allowed: 0 < t1 < t2 < …")

    def __repr__(self) -> str:
        return f"<ScriptedPath: {len(self.times)} positions in {self.duration:g} s>"

    @property
    def duration(self) -> float:
        """Time of the last position [s]."""
        return float(self.times[-1])

    @property
    def rows(self) -> NDArray[np.float64]:
        """Times and positions in rows (t, x, y, z), shape [count, 4]."""
        return np.column_stack([self.times, self.points])

    def move(self, to: ArrayLike, *, seconds: float) -> ScriptedPath:
        """Returns this path followed by a straight move.

        Args:
            to: Where the move ends, in the scene, LPS [mm].
            seconds: How long it takes [s].
        """
        points = np.vstack([self.points, np.asarray(to, dtype=np.float64)])
        return ScriptedPath(points, np.append(self.times, self.duration + seconds))

    def hold(self, seconds: float) -> ScriptedPath:
        """Returns this path followed by a rest of so many seconds."""
        return self.move(self.points[-1], seconds=seconds)

    def at(self, times: ArrayLike) -> NDArray[np.float64]:
        """Returns the positions of the device at times [s], shape [count, 3]."""
        asked = np.atleast_1d(np.asarray(times, dtype=np.float64))
        axes = [np.interp(asked, self.times, self.points[:, axis]) for axis in range(3)]
        return np.column_stack(axes)
