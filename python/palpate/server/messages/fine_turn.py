"""Turns of pages whose fine pictures take all cores for long: one after another, as they came."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Condition

__all__ = ["FineTurn"]

LOOK_SECONDS = 0.02
"""Between two looks whether somebody who waits has given up."""


class FineTurn:
    """A lock that is given in the order in which it was asked for."""

    def __init__(self) -> None:
        """Nobody has it."""
        self._changed = Condition()
        self._line: deque[object] = deque()

    @property
    def is_taken(self) -> bool:
        """Whether somebody has it."""
        return len(self._line) > 0

    @contextmanager
    def taken(self, given_up: Callable[[], bool]) -> Iterator[bool]:
        """Waits for the turn, and has it; yields False where that was given up meanwhile."""
        ticket = object()
        with self._changed:
            self._line.append(ticket)
            while self._line[0] is not ticket and not given_up():
                self._changed.wait(LOOK_SECONDS)
            has_it = self._line[0] is ticket
        try:
            yield has_it
        finally:
            with self._changed:
                self._line.remove(ticket)
                self._changed.notify_all()
