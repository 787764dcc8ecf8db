"""Whether this process stood still: stopped by a terminal, or by a machine that had no room for it.

What pages asked meanwhile waits in their connections. A person who saw nothing happen does not
mean it any more, so it must not be carried out blindly afterwards.

Neither side's clock is trusted: a beat that is late says so by this process' own clock, which
stands still while the machine sleeps, as pages do. A process that is merely busy uses its
processor meanwhile, a stopped one does not.
"""

from __future__ import annotations

import time
from collections.abc import Callable

__all__ = ["Standstill"]

LONGEST_BEAT = 1.0
"""Seconds between two beats from which on it may have stood still."""
BUSY = 0.2
"""Share of that time on a processor from which on it was busy instead."""


class Standstill:
    """Watches the time between beats."""

    def __init__(
        self,
        clock: Callable[[], float] = time.monotonic,
        processor_clock: Callable[[], float] = time.process_time,
    ) -> None:
        """Begins with a beat; both clocks give seconds, the second those on a processor."""
        self._clocks = (clock, processor_clock)
        self._last = (clock(), processor_clock())

    def beat(self) -> float:
        """Returns for how many seconds the process stood still since the last beat: mostly 0."""
        clock, processor_clock = self._clocks
        now = (clock(), processor_clock())
        gap, busy = now[0] - self._last[0], now[1] - self._last[1]
        self._last = now
        return gap if gap > LONGEST_BEAT and busy < BUSY * gap else 0.0
