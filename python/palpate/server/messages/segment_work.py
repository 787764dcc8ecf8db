"""Work on segments that takes its time: growing them, and changing their shape.

One piece after another is done beside the event loop. A person may stop it: what is not finished
then changes nothing.
"""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable

import numpy as np

from palpate import protocol
from palpate.base.errors import OptionError, PalpateError
from palpate.segmentation.operations import (
    Growing,
    changed_shape,
    grown,
    grown_from_seeds,
    otsu,
    smoothed_together,
)
from palpate.server.messages.segment_list import ShownSegments
from palpate.session.session import Session
from palpate.volumes.segment import Segment

__all__ = ["SegmentWork", "Wanted"]

Wanted = protocol.Otsu | protocol.GrowSegment | protocol.GrowSeeds | protocol.ChangeShape


class StoppedError(Exception):
    """A person has stopped the work."""


class SegmentWork:
    """Pieces of work that wait, and the one that is done."""

    def __init__(
        self,
        session: Session,
        segments: ShownSegments,
        tell: Callable[[protocol.ToPage], None],
    ) -> None:
        """Takes where messages go, which may come from any thread."""
        self._session = session
        self._segments = segments
        self._tell = tell
        self._waiting: deque[Wanted] = deque()
        self._filled = asyncio.Event()
        self._stops = 0

    def take(self, message: protocol.FromPage) -> bool:
        """Adds what a page asks for, or stops; says whether the message was for this."""
        match message:
            case protocol.StopSegmentWork():
                self.stop()
            case (
                protocol.Otsu()
                | protocol.GrowSegment()
                | protocol.GrowSeeds()
                | protocol.ChangeShape()
            ):
                self._waiting.append(message)
                self._filled.set()
            case _:
                return False
        return True

    def stop(self) -> None:
        """Stops what is done as soon as it can be, and forgets what waits."""
        self._waiting.clear()
        self._stops += 1

    async def run(self) -> None:
        """Works until it is cancelled."""
        while True:
            await self._filled.wait()
            self._filled.clear()
            while self._waiting:
                await asyncio.to_thread(self._work, self._waiting.popleft(), self._stops)

    def _work(self, wanted: Wanted, stops: int) -> None:
        """Does a piece of work, unless there are more ``stops`` meanwhile."""

        def progress(what: str, share: float | None) -> None:
            if self._stops != stops:
                raise StoppedError
            told = what if share is None else f"{what}, {share:.0%}"
            self._tell(protocol.SegmentWork(told[:1].upper() + told[1:]))

        try:
            match wanted:
                case protocol.Otsu(classes):
                    progress("parting values", None)
                    made = otsu(self._session.scene.volume, classes=classes)
                    progress("adding segments", None)
                    for segment in made:
                        self._segments.add(segment)
                case protocol.GrowSegment():
                    self._grow(wanted, progress)
                case protocol.GrowSeeds():
                    self._grow_seeds(wanted, progress)
                case protocol.ChangeShape():
                    self._change(wanted, progress)
        except StoppedError:
            self._tell(protocol.Notice(level="info", text="Stopped: nothing was changed."))
        except (PalpateError, RuntimeError, MemoryError) as error:
            self._tell(protocol.Notice(level="error", text=str(error) or "not enough memory"))
        finally:
            self._tell(protocol.SegmentWork(None))

    def _grow(
        self, wanted: protocol.GrowSegment, progress: Callable[[str, float | None], None]
    ) -> None:
        growing = Growing(spread=wanted.spread, passage=wanted.passage, most_ml=wanted.most_ml)
        number = 1 + sum(1 for state in self._session.segments())
        segment = grown(
            self._session.scene.volume,
            [wanted.seed],
            name=f"Region {number}",
            growing=growing,
            progress=progress,
        )
        progress("adding the segment", None)
        self._segments.add(segment)

    def _grow_seeds(
        self, wanted: protocol.GrowSeeds, progress: Callable[[str, float | None], None]
    ) -> None:
        first = wanted.ids[0]
        for other in wanted.ids[1:]:
            self._check_unmoved(first, other)
        seeds = [self._now(segment_id) for segment_id in wanted.ids]
        made = grown_from_seeds(
            self._session.scene.volume, seeds, smoothing=wanted.smoothing, progress=progress
        )
        progress("adding segments", None)
        for segment in made:
            self._segments.add(segment)

    def _change(
        self, wanted: protocol.ChangeShape, progress: Callable[[str, float | None], None]
    ) -> None:
        before = self._now(wanted.id)
        progress(f"changing the shape of {before.name}", None)
        if wanted.kind == "joint":
            self._smooth_together(wanted, progress)
            return
        other = None if wanted.other is None else self._now(wanted.other)
        if other is not None and wanted.other is not None:
            self._check_unmoved(wanted.id, wanted.other)
        after = changed_shape(before, wanted.kind, amount=wanted.amount, other=other)
        progress(f"changing the shape of {before.name}", None)
        old = before.mask()
        if np.array_equal(old, after.mask()):
            self._tell(
                protocol.Notice(level="info", text=f"Nothing of {before.name} changes by that.")
            )
        elif after.voxel_count == 0:
            raise OptionError(f"nothing would be left of {before.name}; allowed: a smaller change")
        elif not np.array_equal(old, self._now(wanted.id).mask()):
            raise OptionError(f"{before.name} was changed meanwhile; allowed: to try again")
        else:
            self._session.replace_segment(wanted.id, after)

    def _smooth_together(
        self, wanted: protocol.ChangeShape, progress: Callable[[str, float | None], None]
    ) -> None:
        """Smooths a segment together with all that are shown and stand with it."""
        ids = [wanted.id, *self._shown_beside(wanted.id)]
        locked = {state["id"] for state in self._session.segments() if state["locked"]}
        for segment_id in locked.intersection(ids):
            raise OptionError(
                f"{self._segments.name_of(segment_id)} is locked; allowed: to unlock it, or to "
                "hide it meanwhile"
            )
        before = [self._now(segment_id) for segment_id in ids]
        progress(f"smoothing {len(ids)} segments together", None)
        after = smoothed_together(before, deviation=wanted.amount)
        progress(f"smoothing {len(ids)} segments together", None)
        for old, new in zip(before, after, strict=True):
            if new.voxel_count == 0:
                raise OptionError(
                    f"nothing would be left of {old.name}; allowed: a smaller deviation, or to "
                    "hide it meanwhile"
                )
        for segment_id, old in zip(ids, before, strict=True):
            if not np.array_equal(old.mask(), self._now(segment_id).mask()):
                raise OptionError(f"{old.name} was changed meanwhile; allowed: to try again")
        for segment_id, new in zip(ids, after, strict=True):
            self._session.replace_segment(segment_id, new)
        if len(ids) > 1:
            text = f"{len(ids)} segments were smoothed: undo takes them back one by one."
            self._tell(protocol.Notice(level="info", text=text))

    def _shown_beside(self, segment_id: int) -> list[int]:
        states = {state["id"]: state for state in self._session.segments()}
        own = states.pop(segment_id, None)
        return [
            other
            for other, state in states.items()
            if own is not None
            and state["voxels"] > 0
            and self._segments.is_shown(other)
            and (state["pose"], state["grid"]) == (own["pose"], own["grid"])
        ]

    def _now(self, segment_id: int) -> Segment:
        return self._session.segment(segment_id, name=self._segments.name_of(segment_id))

    def _check_unmoved(self, first: int, second: int) -> None:
        """Refuses to join voxels that stand elsewhere than their grids have them."""
        poses = {state["id"]: state["pose"] for state in self._session.segments()}
        if poses.get(first) != poses.get(second):
            raise OptionError(
                f"{self._segments.name_of(first)} and {self._segments.name_of(second)} were moved "
                "apart; allowed: segments that stand together as in the scan"
            )
