"""Pictures of the engine on their way to one page, and how fast that way is.

They go in parts of some hundredths of a second, and no more of them at a time than fill the way:
what waits beside them never waits for a whole picture. Each part is acknowledged as it arrives. A
few bytes go first: they tell how long the way is, and from the first part on times between arrivals
tell how many bytes it takes in a second (as with packet pairs: Keshav, "A control-theoretic
approach to flow control", 1991).
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

from palpate.protocol import PicturePart

__all__ = ["PictureLane"]

FIRST_RATE, FIRST_NEAR_RATE = 1e6, 50e6
"""Bytes a second before anything was measured, from afar and on one machine."""
PART_SECONDS = 0.025
"""Of a part on its way: so long may a state wait behind it."""
LEAST_PART, MOST_PART = 2048, 1 << 17
HEAD = 64
"""Bytes that go before a picture, to be measured from."""
MEASURED = 8
"""Parts of which the rate is the mean, and heads of which the delay is the shortest."""
MOST_DELAY = 0.5
"""Seconds there and back that are filled with parts."""
SHORTEST = 1e-4
"""Seconds between arrivals, below which clocks and threads are measured and not the way."""


class PictureLane:
    """The newest picture for a page, in parts; on the event loop."""

    def __init__(
        self, clock: Callable[[], float] = time.perf_counter, *, is_near: bool = False
    ) -> None:
        """Has no picture; the page ``is_near`` where it seems to be on this machine."""
        self._clock = clock
        self._serial = 0
        self._number = 0
        self._going: memoryview | None = None
        self._waiting: tuple[int, bytes] | None = None
        self._sent: deque[tuple[int, float]] = deque()
        self._arrived_at = 0.0
        self._measured: deque[tuple[int, float]] = deque(maxlen=MEASURED)
        self._delays: deque[float] = deque(maxlen=MEASURED)
        self.rate = FIRST_NEAR_RATE if is_near else FIRST_RATE
        """Bytes a second that the way to the page takes; may be read by any thread."""

    def put(self, number: int, packed: bytes) -> None:
        """Sends the packed picture of a request next, in place of one that waits.

        One that is on its way for an earlier request is not sent to its end.
        """
        if number != self._number:
            self._going = None
        self._waiting = (number, packed)

    @property
    def is_ready(self) -> bool:
        """Whether there is a part that may be sent now."""
        unanswered = sum(size for size, _ in self._sent)
        has_any = self._going is not None or self._waiting is not None
        filling = self.rate * min(MOST_DELAY, min(self._delays, default=0.0))
        return has_any and unanswered < self._part_size + filling

    def next(self) -> PicturePart:
        """Takes the next part; only where one is ready."""
        going, size = self._going, self._part_size
        if going is None:
            assert self._waiting is not None  # noqa: S101  # ready means one of them
            (self._number, packed), self._waiting = self._waiting, None
            self._serial += 1
            going, size = memoryview(packed), HEAD
        part, rest = going[:size], going[size:]
        self._going = rest if len(rest) > 0 else None
        self._sent.append((len(part), self._clock()))
        return PicturePart(serial=self._serial, last=self._going is None, packed=bytes(part))

    def taken(self) -> None:
        """Notes that the part which was sent first has arrived."""
        if not self._sent:
            return
        (size, sent), now = self._sent.popleft(), self._clock()
        began, self._arrived_at = max(sent, self._arrived_at), now
        if size <= HEAD:
            self._delays.append(now - sent)
        else:
            self._measured.append((size, max(SHORTEST, now - began)))
            sizes, seconds = zip(*self._measured, strict=True)
            self.rate = sum(sizes) / sum(seconds)

    @property
    def _part_size(self) -> int:
        return min(MOST_PART, max(LEAST_PART, int(self.rate * PART_SECONDS)))
