"""What one page is still to be told: messages in order, and the newest state.

A page that reads slowly never makes a queue of states: a newer state takes the place of the
waiting one and inherits its force samples, at most a second of them.
"""

from __future__ import annotations

import asyncio

import msgspec

from palpate.protocol import Changed, Notice, State, ToPage, encode_to_page

__all__ = ["Outbox"]

MOST_SAMPLES = 250
"""Force samples of one second, the most that a state carries."""

MOST_NOTICES = 20


class Outbox:
    """Waiting messages of one page."""

    def __init__(self) -> None:
        """Starts empty."""
        self._messages: list[ToPage] = []
        self._state: State | None = None
        self._filled = asyncio.Event()

    def tell(self, message: ToPage) -> None:
        """Adds a message; of lists and settings only the newest waits, and of states."""
        if isinstance(message, State):
            self._state = message if self._state is None else _joined(self._state, message)
        elif isinstance(message, Notice):
            notices = sum(isinstance(waiting, Notice) for waiting in self._messages)
            if notices < MOST_NOTICES:
                self._messages.append(message)
        elif isinstance(message, Changed):
            # each builds on the one before
            self._messages.append(message)
        else:
            kind = type(message)
            self._messages = [waiting for waiting in self._messages if type(waiting) is not kind]
            self._messages.append(message)
        self._filled.set()

    async def next(self) -> bytes:
        """Waits for the next message and returns it packed; states come after all others."""
        await self._filled.wait()
        if self._messages:
            message = self._messages.pop(0)
        else:
            assert self._state is not None  # noqa: S101  # filled means one of both
            message, self._state = self._state, None
        if not self._messages and self._state is None:
            self._filled.clear()
        return encode_to_page(message)


def _joined(older: State, newer: State) -> State:
    """Returns the newer state with the samples of both."""
    samples = (older.samples + newer.samples)[-MOST_SAMPLES:]
    return msgspec.structs.replace(newer, samples=samples)
