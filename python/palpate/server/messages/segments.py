"""The gap that pages watch: measured beside the event loop, while something moves.

One pair of segments is watched, whichever page chose it last.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable

from palpate import protocol
from palpate.base.errors import PalpateError
from palpate.session.session import Session

__all__ = ["GapWatch"]

PACE = 0.05
"""Seconds between two measurements, at least."""


class GapWatch:
    """Measures the chosen pair again whenever poses or voxels have changed."""

    def __init__(self, session: Session, tell: Callable[[protocol.Gap], None]) -> None:
        """Tells what is measured to ``tell``, from another thread."""
        self._session = session
        self._tell = tell
        self._pair: tuple[int, int] | None = None
        self._seen: object = None

    def choose(self, pair: tuple[int, int] | None) -> None:
        """Watches a pair of segments, or none."""
        self._pair = pair
        self._seen = None

    async def run(self, scene_of_now: Callable[[], object]) -> None:
        """Measures until it is cancelled; ``scene_of_now`` differs where segments do."""
        while True:
            started = time.monotonic()
            now, pair = scene_of_now(), self._pair
            if pair is not None and now != self._seen:
                self._seen = now
                await asyncio.to_thread(self._measure, pair)
            await asyncio.sleep(max(0.0, PACE - (time.monotonic() - started)))

    def _measure(self, pair: tuple[int, int]) -> None:
        try:
            gap = self._session.gap(*pair)
        except (PalpateError, RuntimeError):
            # one of them is gone or empty: there is no gap, and no reason to disturb
            self._tell(protocol.Gap(*pair, minimum=None, mean=None, overlap=None))
            return
        self._tell(protocol.Gap(*pair, minimum=gap.minimum, mean=gap.mean, overlap=gap.overlap))
