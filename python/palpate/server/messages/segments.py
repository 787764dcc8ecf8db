"""Messages on segments: their properties, how they are moved and cut, and the gap between two."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable

import msgspec
import numpy as np

from palpate import protocol
from palpate.base.errors import OptionError, PalpateError
from palpate.server.messages.outbox import Outbox
from palpate.server.messages.segment_list import SegmentList
from palpate.server.messages.table import MessageTable, Runs
from palpate.session.painted_cut import PaintedCut
from palpate.session.session import Session

__all__ = ["GapWatch", "SegmentMessages"]

PACE = 0.05
"""Seconds between two measurements, at least."""


class GapWatch:
    """Measures the gap of a pair of segments beside the event loop whenever one of them changes.

    One pair is watched, that which a page chose last.
    """

    def __init__(self, session: Session, publish: Callable[[protocol.Gap], None]) -> None:
        """Takes what publishes a gap to all pages, from any thread."""
        self._session = session
        self._publish = publish
        self._pair: tuple[int, int] | None = None
        self._measured: object = None

    def choose(self, pair: tuple[int, int] | None) -> None:
        """Watches a pair of segments, or none."""
        self._pair = pair
        self._measured = None

    async def run(self, scene_of_now: Callable[[], object]) -> None:
        """Measures until it is cancelled, each time that ``scene_of_now`` returns another value."""
        while True:
            started = time.monotonic()
            now, pair = scene_of_now(), self._pair
            if pair is not None and now != self._measured:
                self._measured = now
                await asyncio.to_thread(self._measure, pair)
            await asyncio.sleep(max(0.0, PACE - (time.monotonic() - started)))

    def _measure(self, pair: tuple[int, int]) -> None:
        try:
            gap = self._session.gap(*pair)
        except (PalpateError, RuntimeError):
            # one of them is gone or empty: there is no gap, and no reason to disturb
            self._publish(protocol.Gap(*pair, minimum=None, mean=None, overlap=None))
            return
        self._publish(protocol.Gap(*pair, minimum=gap.minimum, mean=gap.mean, overlap=gap.overlap))


class SegmentMessages:
    """Does what pages ask of segments, but for work that takes its time."""

    def __init__(
        self,
        session: Session,
        segments: SegmentList,
        gaps: GapWatch,
        *,
        publish: Callable[[protocol.ToPage], None],
    ) -> None:
        """Takes the list of segments, and what publishes to all pages from any thread."""
        self._session = session
        self._segments = segments
        self._gaps = gaps
        self._publish = publish

    def add_to(self, table: MessageTable) -> None:
        """Adds the rows of segments."""
        table.add(protocol.NewSegment, self._new, runs=Runs.IN_ORDER)
        table.add(protocol.SegmentProperties, self._change, runs=Runs.IN_ORDER)
        table.add(protocol.ShowSegments, self._show, runs=Runs.IN_ORDER)
        table.add(protocol.SegmentFeel, self._set_feel, runs=Runs.IN_ORDER)
        table.add(protocol.RemoveSegment, self._remove, runs=Runs.IN_ORDER)
        table.add(protocol.MoveSegment, self._move, runs=Runs.IN_ORDER)
        table.add(protocol.Grab, self._grab, runs=Runs.IN_ORDER)
        table.add(protocol.TurnGrabbed, self._turn_grabbed, runs=Runs.IN_ORDER)
        table.add(protocol.CutAlong, self._cut_along, runs=Runs.IN_ORDER)
        table.add(protocol.WatchGap, self._watch_gap, runs=Runs.IN_ORDER)

    def _new(self, message: protocol.NewSegment, _: Outbox) -> None:
        self._segments.add_empty(message.name)

    def _change(self, message: protocol.SegmentProperties, _: Outbox) -> None:
        self._segments.change(message)

    def _show(self, message: protocol.ShowSegments, _: Outbox) -> None:
        self._segments.show(message.changes)

    def _set_feel(self, message: protocol.SegmentFeel, _: Outbox) -> None:
        self._session.set_feel(message.id, **msgspec.structs.asdict(message.feel))

    def _remove(self, message: protocol.RemoveSegment, _: Outbox) -> None:
        self._session.remove_segment(message.id)

    def _move(self, message: protocol.MoveSegment, _: Outbox) -> None:
        pose = np.reshape(message.pose, (4, 4))
        self._session.move_segment(message.id, pose, goes_on=message.goes_on)

    def _grab(self, message: protocol.Grab, _: Outbox) -> None:
        self._session.grab(message.id, collides=message.collides)

    def _turn_grabbed(self, message: protocol.TurnGrabbed, _: Outbox) -> None:
        self._session.turn_grabbed(message.rotation)

    def _cut_along(self, wanted: protocol.CutAlong, _: Outbox) -> None:
        cut = PaintedCut(line=wanted.line, eye=wanted.eye, view=wanted.view, closed=wanted.closed)
        if not wanted.preview:
            self._segments.cut(wanted.id, lambda: self._session.cut_along(wanted.id, cut))
            return
        parts: tuple[float, float] | tuple[None, None]
        try:
            parts = self._session.preview_cut(wanted.id, cut)
        except OptionError:
            # the page says so where the line is
            parts = None, None
        self._publish(protocol.CutPreview(wanted.id, *parts))

    def _watch_gap(self, message: protocol.WatchGap, _: Outbox) -> None:
        self._gaps.choose(message.pair)
