"""Thresholds that a person drags: computed beside the event loop, the latest first.

While one is computed, newer ones for the same segment replace each other; so a drag of any
speed costs at most one threshold at a time, and its last position always arrives.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from palpate.protocol import Threshold

__all__ = ["ThresholdJobs"]


class ThresholdJobs:
    """Waiting thresholds, at most one per segment and any number of new ones."""

    def __init__(self, work: Callable[[Threshold], None]) -> None:
        """Takes the function that makes a threshold, which may take its time."""
        self._work = work
        self._waiting: list[Threshold] = []
        self._filled = asyncio.Event()

    def ask(self, threshold: Threshold) -> None:
        """Adds a threshold; it replaces one that waits for the same segment."""
        if threshold.id is not None:
            self._waiting = [other for other in self._waiting if other.id != threshold.id]
        self._waiting.append(threshold)
        self._filled.set()

    async def run(self) -> None:
        """Makes thresholds until it is cancelled."""
        while True:
            await self._filled.wait()
            threshold = self._waiting.pop(0)
            if not self._waiting:
                self._filled.clear()
            await asyncio.to_thread(self._work, threshold)
