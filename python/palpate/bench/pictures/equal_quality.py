"""Renderers side by side at equal quality.

The error of a picture is the root mean square difference of its screen values from those of the
same renderer with 16 times as many steps as one per voxel: light and colours may be each one's own.
For equal errors the other renderer gets the fewest steps with which it is as near to its own fine
picture as ours is with those of the page. Times are then taken in rounds of changing order, since
other work on the machine comes and goes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median

import numpy as np
from numpy.typing import NDArray

__all__ = ["FINE", "Compared", "TimedPicture", "compared", "steps_for", "times_of"]

FINE = 16.0
"""Steps per voxel of a picture that others are compared with."""
LEAST, MOST = 0.25, 8.0
"""Steps per voxel that are tried."""
NARROW = 0.15
"""Where the search ends [octaves of steps]."""


@dataclass(frozen=True)
class TimedPicture:
    """A picture, and the time that it was drawn."""

    seconds: float
    screen: NDArray[np.floating]
    """Screen values from 0 to 1, shape [rows, columns, 3]."""


Drawing = Callable[[float], TimedPicture]
"""Draws with so many steps per voxel."""


@dataclass(frozen=True)
class Compared:
    """Two renderers at equal errors."""

    ours: float
    """Median time [s]."""
    theirs: float
    same: float
    """Theirs, with one step per voxel, as ours [s]."""
    steps: float
    """Theirs, per voxel."""
    ours_off: float
    """Error, with values from 0 to 1."""
    theirs_off: float

    def report(self) -> dict[str, float]:
        """Returns the figures of the rows."""
        return {
            "ours": self.ours,
            "ours off": self.ours_off,
            "theirs": self.theirs,
            "same": self.same,
            "same ratio": self.same / self.ours,
            "steps": self.steps,
            "theirs off": self.theirs_off,
            "ratio": self.theirs / self.ours,
        }


def compared(ours: Drawing, theirs: Drawing, *, rounds: int) -> Compared:
    """Returns how long two renderers take at equal errors; ours draws one step per voxel.

    Theirs gets ``MOST`` steps where even they leave it farther from its own fine picture.
    """
    ours_off, theirs_off = _errors_of(ours), _errors_of(theirs)
    target = ours_off(1.0)
    steps = steps_for(theirs_off, target)
    runs = [
        lambda: ours(1.0).seconds,
        lambda: theirs(steps).seconds,
        lambda: theirs(1.0).seconds,
    ]
    our_time, their_time, same = times_of(runs, rounds)
    return Compared(our_time, their_time, same, steps, target, theirs_off(steps))


def steps_for(error: Callable[[float], float], target: float) -> float:
    """Returns about the fewest steps per voxel with which an error is at most the target.

    Args:
        error: Falls with the steps, or stays.
        target: Largest error.

    Returns:
        From ``LEAST`` to ``MOST``, which may still be too few.
    """
    low, high = math.log2(LEAST), math.log2(MOST)
    if error(LEAST) <= target:
        return LEAST
    while high - low > NARROW:
        middle = (low + high) / 2.0
        if error(2.0**middle) <= target:
            high = middle
        else:
            low = middle
    return float(2.0**high)


def times_of(runs: list[Callable[[], float]], rounds: int) -> list[float]:
    """Returns the median time of each run [s], in the order of the runs; the first round warms up.

    Every other round goes backward.
    """
    taken: list[list[float]] = [[] for _ in runs]
    for number in range(rounds + 1):
        for which in list(range(len(runs)))[:: 1 if number % 2 else -1]:
            seconds = runs[which]()
            if number > 0:
                taken[which].append(seconds)
    return [median(each) for each in taken]


def _errors_of(draw: Drawing) -> Callable[[float], float]:
    """Returns a function from steps to the error."""
    fine = draw(FINE).screen

    def error(steps: float) -> float:
        return float(np.sqrt(np.mean((draw(steps).screen - fine) ** 2)))

    return error
