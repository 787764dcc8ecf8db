"""Pictures go to a page in parts: what the way takes is measured, and states never wait long."""

from __future__ import annotations

from collections import deque

import pytest
from palpate import protocol
from palpate.server.messages.picture_coding import NOT_PACKED, PictureCoder
from palpate.server.messages.picture_lane import PictureLane

KILOBYTE = 1000


class Way:
    """A link with a rate [bytes/s] and a delay there and back [s], beside a lane; time is made."""

    def __init__(self, rate: float, delay: float) -> None:
        self.now = 0.0
        self.lane = PictureLane(lambda: self.now)
        self.rate, self.delay = rate, delay
        self._free_at = 0.0
        self._answers: deque[float] = deque()
        self.longest = 0.0
        """Seconds that something sent right behind a part would have waited."""
        self.parts: list[protocol.PicturePart] = []

    def send(self, packed: bytes, number: int = 1) -> float:
        """Sends a picture whole; returns the seconds until its last part was acknowledged."""
        began = self.now
        self.lane.put(number, packed)
        while self.lane.is_ready or self._answers:
            if self.lane.is_ready:
                part = self.lane.next()
                self.parts.append(part)
                self._free_at = max(self._free_at, self.now) + len(part.packed) / self.rate
                self._answers.append(self._free_at + self.delay)
                self.longest = max(self.longest, self._free_at - self.now)
            else:
                self.now = self._answers.popleft()
                self.lane.taken()
        return self.now - began


@pytest.mark.parametrize("rate", [125e3, 2.5e6, 200e6])
@pytest.mark.parametrize("delay", [0.0005, 0.2])
def test_the_rate_of_a_way_is_measured_whatever_its_delay(rate: float, delay: float) -> None:
    way = Way(rate, delay)
    for _ in range(12):
        way.send(bytes(int(rate * 0.1)))
    assert 0.3 * rate <= way.lane.rate <= 1.05 * rate


def test_a_state_waits_no_longer_than_for_two_parts() -> None:
    way = Way(125e3, 0.05)
    way.send(bytes(30 * KILOBYTE))
    way.longest = 0.0
    way.send(bytes(500 * KILOBYTE))
    assert way.longest < 0.08


def test_parts_make_the_picture_again() -> None:
    way = Way(1e6, 0.01)
    picture = bytes(range(256)) * 500
    way.send(picture)
    assert b"".join(part.packed for part in way.parts) == picture
    assert [part.last for part in way.parts] == [False] * (len(way.parts) - 1) + [True]


def test_a_page_that_answers_nothing_is_sent_one_part_and_what_waits_is_the_newest() -> None:
    lane = PictureLane(lambda: 0.0)
    lane.put(1, bytes(10_000_000))
    sent = 0
    while lane.is_ready:
        sent += len(lane.next().packed)
    for number in range(2, 50):
        lane.put(number, bytes([number]) * 10_000)
    assert sent < 64 * KILOBYTE
    lane.taken()
    lane.taken()
    assert lane.next().packed == bytes([49]) * 64, "the one before was given up on its way"


@pytest.mark.parametrize(("rate", "seconds"), [(125e3, 0.25), (1e6, 0.15), (50e6, 0.15)])
def test_moving_pictures_are_packed_for_their_way(rate: float, seconds: float) -> None:
    pixels, coder = 806 * 696 // 9, PictureCoder()
    packing = coder.packing(pixels, rate, moving=True, last=False)
    size = 10 * pixels if packing.quality is None else 0.25 * pixels
    assert size / rate <= seconds
    assert (packing.quality is None) == (rate > 20e6)


def test_the_last_picture_is_never_coarse() -> None:
    assert PictureCoder().packing(500_000, 10e3, moving=False, last=True).quality == 95
    # a machine that is busy takes longer than a slow line would
    assert PictureCoder().packing(1_000_000, 20e6, moving=False, last=True) is NOT_PACKED
