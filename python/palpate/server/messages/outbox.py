"""Messages that wait for one page: in order, and the newest state.

A page that reads slowly never makes a queue of states: a newer state takes the place of the
waiting one and inherits its force samples, at most a second of them. Changes of the picture build
on one another and wait, up to a number of bytes. A page that falls farther behind does not get them
one by one: they are forgotten but for the boxes of voxels that they touch, and once the page reads
again it gets those boxes, and all surfaces, as they are then.

Pictures that the engine draws have a lane of their own, behind all others.
"""

from __future__ import annotations

import asyncio
from dataclasses import dataclass, field

import msgspec

from palpate.protocol import (
    Changed,
    GridPlace,
    Kept,
    Notice,
    State,
    ToPage,
    encode_to_page,
)
from palpate.server.messages.picture_lane import PictureLane
from palpate.server.page_words import page_words

__all__ = ["Box", "Missed", "Outbox"]

MOST_SAMPLES = 250
"""Force samples of one second, the most that a state carries."""

MOST_NOTICES = 20

MOST_BYTES = 64 << 20
"""Bytes of voxels and surfaces that wait for one page."""


@dataclass
class Box:
    """The smallest box of voxels around others, from ``low`` up to, but without, ``high``."""

    low: GridPlace = (0, 0, 0)
    """x, y, z."""
    high: GridPlace = (0, 0, 0)

    def add(self, low: GridPlace, high: GridPlace) -> None:
        """Grows around a box."""
        if self.is_empty:
            self.low, self.high = low, high
            return
        (x, y, z), (to_x, to_y, to_z) = self.low, self.high
        self.low = (min(x, low[0]), min(y, low[1]), min(z, low[2]))
        self.high = (max(to_x, high[0]), max(to_y, high[1]), max(to_z, high[2]))

    @property
    def is_empty(self) -> bool:
        """Whether it holds no voxel."""
        return any(low >= high for low, high in zip(self.low, self.high, strict=True))


@dataclass
class Missed:
    """Where a page does not know what the picture is, beside all surfaces."""

    stored: Box = field(default_factory=Box)
    labels: Box = field(default_factory=Box)

    def add(self, changed: Changed) -> None:
        """Takes a change that the page does not get."""
        for voxels in changed.voxels:
            if voxels.stored is not None:
                self.stored.add(voxels.low, voxels.high)
            if voxels.labels is not None:
                self.labels.add(voxels.low, voxels.high)


class Outbox:
    """Waiting messages of one page."""

    def __init__(self, *, missed: Missed | None = None, is_near: bool = False) -> None:
        """Starts empty; what a page has ``missed`` comes after all messages.

        ``is_near``: the page seems to be on this machine.
        """
        self._messages: list[ToPage] = []
        self._bytes = 0
        self._missed = missed
        self._state: State | None = None
        self._pictures = PictureLane(is_near=is_near)
        self._picture_is_next = False
        self._filled = asyncio.Event()
        self._mark()

    @property
    def waiting_bytes(self) -> int:
        """Voxels and surfaces that wait."""
        return self._bytes

    @property
    def is_behind(self) -> bool:
        """Whether changes are forgotten, since too many waited."""
        return self._missed is not None

    @property
    def picture_rate(self) -> float:
        """Bytes of pictures that the way to the page takes in a second; for any thread."""
        return self._pictures.rate

    def picture_taken(self) -> None:
        """Notes that a part of a picture has arrived."""
        self._pictures.taken()
        self._mark()

    def put_picture(self, number: int, packed: bytes) -> None:
        """Adds the packed picture of a request; it takes the place of one that waits."""
        self._pictures.put(number, packed)
        self._mark()

    def put(self, message: ToPage) -> None:
        """Adds a message; of lists and settings only the newest waits, and of states."""
        if isinstance(message, State):
            self._state = message if self._state is None else _joined(self._state, message)
        elif isinstance(message, Notice):
            notices = sum(isinstance(waiting, Notice) for waiting in self._messages)
            if notices < MOST_NOTICES:
                self._messages.append(
                    msgspec.structs.replace(message, text=page_words(message.text))
                )
        elif isinstance(message, Changed):
            self._put_changed(message)
        elif isinstance(message, Kept):
            self._messages.append(message)
        else:
            kind = type(message)
            self._messages = [waiting for waiting in self._messages if type(waiting) is not kind]
            self._messages.append(message)
        self._mark()

    async def next(self) -> bytes | Missed:
        """Waits for the next message and returns it packed; states come after all others.

        Parts of pictures come after states, or with them by turns where states never cease.

        Where the page has fallen behind it returns what was missed: changes wait again from then
        on, and the caller sends the page all that before the next message.
        """
        await self._filled.wait()
        following: ToPage | Missed
        if self._messages:
            following = self._messages.pop(0)
            if isinstance(following, Changed):
                self._bytes -= _size_of(following)
        elif self._missed is not None:
            following, self._missed = self._missed, None
        elif self._state is not None and not (self._picture_is_next and self._pictures.is_ready):
            following, self._state = self._state, None
            self._picture_is_next = True
        else:
            following = self._pictures.next()
            self._picture_is_next = False
        self._mark()
        return following if isinstance(following, Missed) else encode_to_page(following)

    def _put_changed(self, message: Changed) -> None:
        if self._missed is not None:
            self._missed.add(message)
            return
        if message.displaced is not None:
            self._forget_displaced()
        self._messages.append(message)
        self._bytes += _size_of(message)
        if self._bytes > MOST_BYTES:
            self._fall_behind()

    def _forget_displaced(self) -> None:
        """Drops older displacements of soft tissue: only the newest wait."""
        for place, waiting in enumerate(self._messages):
            if isinstance(waiting, Changed) and waiting.displaced is not None:
                self._bytes -= _displaced_size(waiting)
                self._messages[place] = msgspec.structs.replace(waiting, displaced=None)
        self._messages = [each for each in self._messages if not _is_nothing(each)]

    def _fall_behind(self) -> None:
        self._missed = Missed()
        kept: list[ToPage] = []
        for message in self._messages:
            if isinstance(message, Changed):
                self._missed.add(message)
            else:
                kept.append(message)
        self._messages, self._bytes = kept, 0

    def _mark(self) -> None:
        waits = self._messages or self._missed is not None or self._state is not None
        if waits or self._pictures.is_ready:
            self._filled.set()
        else:
            self._filled.clear()


def _is_nothing(message: ToPage) -> bool:
    """Says whether a message is a change of nothing."""
    return (
        isinstance(message, Changed)
        and message.applied is None
        and not (message.voxels or message.surfaces)
        and message.displaced is None
    )


def _displaced_size(changed: Changed) -> int:
    """Returns the bytes of a change's displacements."""
    return sum(len(box.moved) for box in changed.displaced or [])


def _size_of(changed: Changed) -> int:
    """Returns the bytes of a change's voxels and surfaces."""
    voxels = sum(len(box.stored or b"") + len(box.labels or b"") for box in changed.voxels)
    return (
        _displaced_size(changed)
        + voxels
        + sum(
            len(patch.vertices) + len(patch.normals) + len(patch.triangles)
            for surface in changed.surfaces
            for patch in surface.patches
        )
    )


def _joined(older: State, newer: State) -> State:
    """Returns the newer state with the samples of both."""
    samples = (older.samples + newer.samples)[-MOST_SAMPLES:]
    return msgspec.structs.replace(newer, samples=samples)
