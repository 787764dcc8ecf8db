"""How coarse pictures are while the view moves, so that enough of them come in a second."""

from __future__ import annotations

import math

__all__ = ["FIRST_DIVISOR", "PicturePace"]

FIRST_DIVISOR = 3.0
"""Of the resolution, before any picture was timed."""
FINEST, COARSEST = 2.0, 4.0
WANTED = 0.075
"""Seconds of a picture: ten in a second, with their way to the page."""
LEARNED = 0.3
"""Fraction of what is known that each new picture replaces."""
STEP = 0.25
"""Divisors are multiples of it: the page's picture does not change its size with each of them."""


class PicturePace:
    """Learns what pictures take; tells by what the resolution is divided while the view moves."""

    def __init__(self) -> None:
        """Knows nothing yet."""
        self._undivided: float | None = None

    @property
    def divisor(self) -> float:
        """Of the resolution, for the next picture."""
        if self._undivided is None:
            return FIRST_DIVISOR
        fitting = math.sqrt(self._undivided / WANTED)
        return min(COARSEST, max(FINEST, STEP * math.ceil(fitting / STEP)))

    @property
    def slows(self) -> bool:
        """Whether pictures have taken too long to be drawn as finely as they may be."""
        return self._undivided is not None and self.divisor > FINEST

    def learn(self, divisor: float, seconds: float) -> None:
        """Takes what a picture took that was drawn in haste."""
        undivided = seconds * divisor**2
        known = undivided if self._undivided is None else self._undivided
        self._undivided = known + LEARNED * (undivided - known)
