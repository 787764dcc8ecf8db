"""Messages on segments whose work takes its time: thresholds, growing, shapes, removal.

It is done beside the event loop. Of thresholds that are dragged the latest goes first: while one is
computed, newer ones for the same segment replace each other; so a drag of any speed costs at most
one threshold at a time, and its last position always arrives. All other work is done in the order
it was asked for, and can be stopped: what is not finished then changes nothing. A look for a table
that nobody has asked for gives way to all of it, and says nothing where it finds none.
"""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np

from palpate import protocol
from palpate.base.errors import OptionError, PalpateError
from palpate.segmentation.crop import outside
from palpate.segmentation.operations import (
    Growing,
    grow_levels,
    grown_from_seeds,
    otsu,
    smoothed_together,
)
from palpate.segmentation.segment_steps import ShapeStep
from palpate.segmentation.table import skin_value, table
from palpate.server.messages.going_part import GoingPart
from palpate.server.messages.grown_preview import GrownPreview
from palpate.server.messages.segment_list import SegmentList
from palpate.server.messages.segment_steps import wanted_steps
from palpate.server.messages.shown_islands import show_islands
from palpate.server.messages.shown_scissors import show_scissors
from palpate.server.messages.table import MessageTable, Runs
from palpate.server.page_words import page_words
from palpate.session.appearance import UNMOVED
from palpate.session.session import Session
from palpate.session.steps import ShapeChange
from palpate.volumes.appearance import Colour
from palpate.volumes.segment import Segment

__all__ = ["SegmentWork", "ThresholdJobs", "Wanted"]

Wanted = (
    protocol.Otsu
    | protocol.GrowSegment
    | protocol.ChangeGrown
    | protocol.EndGrown
    | protocol.GrowSeeds
    | protocol.ChangeShape
    | protocol.ShowIslands
    | protocol.ShowScissors
    | protocol.EndGoing
    | protocol.ChangeSteps
    | protocol.Threshold
    | protocol.FindTable
    | protocol.SuggestTable
    | protocol.RemoveTable
    | protocol.RemoveFromScan
    | protocol.CropScan
)

DECISIONS = (protocol.EndGrown, protocol.EndGoing)
"""On what is shown: a person has made them, so nothing stops them."""

Told = Callable[[str, float | None], None]
"""Takes what is done, and its share if that is known."""

TABLE_COLOUR: Colour = (1.0, 0.62, 0.18)
"""Of a table, until it is removed."""


class ThresholdJobs:
    """Waiting thresholds, at most one per segment and any number of new ones."""

    def __init__(
        self,
        work: Callable[[protocol.Threshold], None],
        *,
        elsewhere: Callable[[protocol.Threshold], bool] = lambda _: False,
    ) -> None:
        """Takes the function that makes a threshold, which may take its time.

        What is taken ``elsewhere`` is not made here.
        """
        self._work = work
        self._elsewhere = elsewhere
        self._waiting: list[protocol.Threshold] = []
        self._filled = asyncio.Event()

    def add_to(self, table: MessageTable) -> None:
        """Adds the row of thresholds."""
        table.add(protocol.Threshold, lambda message, _: self.ask(message), runs=Runs.BESIDE)

    def ask(self, threshold: protocol.Threshold) -> None:
        """Adds a threshold; it replaces one that waits for the same segment."""
        if threshold.id is not None:
            self._waiting = [other for other in self._waiting if other.id != threshold.id]
        if self._elsewhere(threshold):
            return
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


class StoppedError(Exception):
    """A person has stopped the work."""


class SegmentWork:
    """Pieces of work that wait, and the one that is done."""

    def __init__(
        self,
        session: Session,
        segments: SegmentList,
        publish: Callable[[protocol.ToPage], None],
    ) -> None:
        """Takes where messages go, which may come from any thread."""
        self._session = session
        self._segments = segments
        self._publish = publish
        self._waiting: deque[Wanted] = deque()
        self._filled = asyncio.Event()
        self._stops = 0
        self._busy = False
        self._table: Segment | None = None
        self._table_shown: protocol.TableFound | None = None
        self._going = GoingPart(session, segments)
        self._grown = GrownPreview(session, segments)
        self._kinds: dict[type[Wanted], Callable[[Any, Told], None]] = {
            protocol.Otsu: self._otsu,
            protocol.GrowSegment: self._grow,
            protocol.ChangeGrown: self._change_grown,
            protocol.EndGrown: self._end_grown,
            protocol.GrowSeeds: self._grow_seeds,
            protocol.ChangeShape: self._change,
            protocol.ShowIslands: self._show_islands,
            protocol.ShowScissors: self._show_scissors,
            protocol.EndGoing: self._end_going,
            protocol.ChangeSteps: self._change_steps,
            protocol.Threshold: self._threshold,
            protocol.FindTable: self._find_table,
            protocol.SuggestTable: self._suggest_table,
            protocol.RemoveTable: self._remove_table,
            protocol.RemoveFromScan: self._remove_from_scan,
            protocol.CropScan: self._crop,
        }

    def add_to(self, rows: MessageTable) -> None:
        """Adds the rows of the work."""
        for kind in self._kinds.keys() - {protocol.Threshold}:
            rows.add(kind, lambda message, _: self.ask(message), runs=Runs.BESIDE)
        rows.add(protocol.StopSegmentWork, lambda _message, _: self.stop(), runs=Runs.ON_LOOP)

    def takes(self, threshold: protocol.Threshold) -> bool:
        """Takes a threshold where steps follow it, which can take long; says whether it did."""
        if not self._segments.has_steps(threshold.id):
            return False
        self.ask(threshold)
        return True

    def ask(self, wanted: Wanted) -> None:
        """Adds a piece of work; it is done after those that wait.

        A threshold replaces one that waits for the same segment, and a level of a grown region one
        that waits; nobody waits for a table that is only suggested.
        """
        if isinstance(wanted, protocol.SuggestTable) and self.is_busy:
            return
        if isinstance(wanted, protocol.Threshold):
            self._waiting = deque(
                other
                for other in self._waiting
                if not isinstance(other, protocol.Threshold) or other.id != wanted.id
            )
        if isinstance(wanted, protocol.ChangeGrown):
            self._waiting = deque(
                other for other in self._waiting if not isinstance(other, protocol.ChangeGrown)
            )
        self._waiting.append(wanted)
        self._filled.set()

    @property
    def is_busy(self) -> bool:
        """Whether something is done or waits."""
        return self._busy or bool(self._waiting)

    def previews(self) -> list[protocol.ToPage]:
        """Returns what a page that comes is to be told of what waits for a decision."""
        waiting = (self._grown.told, self._going.told, self._table_told)
        return [told for told in waiting if told is not None]

    @property
    def _table_told(self) -> protocol.TableFound | None:
        """What was told of a table that is shown, as long as its segment is there."""
        shown = self._table_shown
        there = {state["id"] for state in self._session.segments() if state["voxels"]}
        return shown if shown is not None and shown.id in there else None

    def stop(self) -> None:
        """Stops what is done as soon as it can be, and forgets what waits, but for decisions."""
        self._waiting = deque(other for other in self._waiting if isinstance(other, DECISIONS))
        self._stops += 1

    async def run(self) -> None:
        """Works until it is cancelled."""
        while True:
            await self._filled.wait()
            self._filled.clear()
            while self._waiting:
                wanted = self._waiting.popleft()
                work = self._look if isinstance(wanted, protocol.SuggestTable) else self._work
                self._busy = True
                await asyncio.to_thread(work, wanted, self._stops)
                self._busy = False

    def _look(self, wanted: Wanted, stops: int) -> None:
        """Does work that nobody has asked for, as long as nothing else is wanted."""

        def progress(_what: str, _share: float | None) -> None:
            if self._waiting or self._stops != stops:
                raise StoppedError

        with suppress(StoppedError, PalpateError, RuntimeError, MemoryError):
            self._kinds[type(wanted)](wanted, progress)

    def _work(self, wanted: Wanted, stops: int) -> None:
        """Does a piece of work, unless there are more ``stops`` meanwhile."""

        def progress(what: str, share: float | None) -> None:
            if self._stops != stops and not isinstance(wanted, DECISIONS):
                raise StoppedError
            text = what if share is None else f"{what}, {share:.0%}"
            self._publish(protocol.SegmentWork(text[:1].upper() + text[1:]))

        try:
            self._kinds[type(wanted)](wanted, progress)
        except StoppedError:
            self._publish(protocol.Notice(level="info", text="Stopped: nothing was changed."))
            # pages show again what is
            self._segments.steps_changed()
        except (PalpateError, RuntimeError, MemoryError) as error:
            self._publish(
                protocol.Notice(level="error", text=page_words(str(error)) or "not enough memory")
            )
        finally:
            self._publish(protocol.SegmentWork(None))

    def _otsu(self, wanted: protocol.Otsu, progress: Told) -> None:
        progress("parting values", None)
        made = otsu(self._session.scene.volume, classes=wanted.classes)
        progress("adding segments", None)
        for segment in made:
            self._segments.add(segment)

    def _suggest_table(self, _: protocol.SuggestTable, progress: Told) -> None:
        self._found_table(progress)
        self._publish(protocol.TableSuggested())

    def _remove_table(self, _: protocol.RemoveTable, progress: Told) -> None:
        found = self._found_table(progress)
        progress("removing the table from the scan", None)
        self._session.remove_from_scan(found)

    def _found_table(self, progress: Told) -> Segment:
        """Returns the table of the scan as it was opened, if some of it is still there."""
        volume = self._session.scene.volume
        self._table = self._table or table(volume, progress=progress)
        left = self._session.threshold(skin_value(volume), volume.range[1])
        if not np.any(self._table.mask() & left.mask()):
            raise OptionError("the table is not in the scan any more")
        return self._table

    def _find_table(self, _: protocol.FindTable, progress: Told) -> None:
        found = self._found_table(progress)
        progress("adding the segment", None)
        number = self._segments.add_preview(found, colour=TABLE_COLOUR)
        self._table_shown = protocol.TableFound(number)
        self._publish(self._table_shown)

    def _remove_from_scan(self, wanted: protocol.RemoveFromScan, progress: Told) -> None:
        part = self._now(wanted.id)
        pose = next(each["pose"] for each in self._session.segments() if each["id"] == wanted.id)
        if pose is not None and pose != UNMOVED:
            raise OptionError(f"{part.name} was moved; allowed: one that stands as in the scan")
        self._table_shown = None
        progress(f"removing {part.name} from the scan", None)
        self._session.remove_from_scan(part)
        left = self._session.segment(wanted.id).voxel_count
        self._session.remove_segment(wanted.id)
        self._session.group_steps(wanted.id, [part.voxel_count, left, None])

    def _crop(self, wanted: protocol.CropScan, progress: Told) -> None:
        progress("cropping the scan", None)
        volume = self._session.scene.volume
        self._session.remove_from_scan(outside(volume, wanted.low, wanted.high))

    def _grow(self, wanted: protocol.GrowSegment, progress: Told) -> None:
        progress("looking for the region", None)
        self._grown.drop()
        growing = Growing(spread=wanted.spread, passage=wanted.passage, most_ml=wanted.most_ml)
        number = 1 + sum(1 for state in self._session.segments())
        volume = self._session.scene.volume
        levels = grow_levels(volume, wanted.seed, growing=growing, progress=progress)
        progress("showing the region", None)
        self._publish(self._grown.show(levels, name=f"Region {number}"))

    def _change_grown(self, wanted: protocol.ChangeGrown, _: Told) -> None:
        told = self._grown.change(wanted.level)
        if told is not None:
            self._publish(told)

    def _end_grown(self, wanted: protocol.EndGrown, _: Told) -> None:
        if wanted.keeps:
            self._grown.keep()
        else:
            self._grown.drop()

    def _grow_seeds(self, wanted: protocol.GrowSeeds, progress: Told) -> None:
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

    def _change(self, wanted: protocol.ChangeShape, progress: Told) -> None:
        if wanted.kind == "joint":
            self._smooth_together(wanted, progress)
            return
        if wanted.other is None:
            step = ShapeStep(kind=wanted.kind, amount=wanted.amount)
        else:
            self._check_unmoved(wanted.id, wanted.other)
            step = ShapeStep.with_other(wanted.kind, self._now(wanted.other))
        name = self._segments.name_of(wanted.id)
        self._tell(
            name,
            self._session.change_shape(wanted.id, step, name=name, progress=progress),
        )

    def _change_steps(self, wanted: protocol.ChangeSteps, progress: Told) -> None:
        name = self._segments.name_of(wanted.id)
        now = self._session.steps(wanted.id, name=name, progress=progress)
        steps = wanted_steps(now, wanted.steps, name=name)
        self._tell(name, self._session.set_steps(wanted.id, steps, name=name, progress=progress))

    def _threshold(self, wanted: protocol.Threshold, progress: Told) -> None:
        self._tell(wanted.name, self._segments.threshold(wanted, progress=progress))

    def _tell(self, name: str, change: ShapeChange) -> None:
        """Tells pages what came of a change of shape."""
        for sentence in change.warnings:
            self._publish(protocol.Notice(level="warning", text=f"{name}: {sentence}."))
        if not change.changed:
            self._publish(protocol.Notice(level="info", text=f"Nothing of {name} changes by that."))
        self._segments.steps_changed()

    def _show_islands(self, wanted: protocol.ShowIslands, progress: Told) -> None:
        progress(f"looking for islands of {self._segments.name_of(wanted.id)}", None)
        self._tell_going(show_islands(wanted, self._going, progress))

    def _show_scissors(self, wanted: protocol.ShowScissors, progress: Told) -> None:
        progress("looking at what is cut out", None)
        self._tell_going(show_scissors(wanted, self._going, progress))

    def _tell_going(self, told: protocol.Islands | protocol.Scissors) -> None:
        self._going.told = told
        self._publish(told)

    def _end_going(self, wanted: protocol.EndGoing, progress: Told) -> None:
        progress("removing what is shown" if wanted.removes else "leaving all as it is", None)
        self._going.end(removes=wanted.removes)

    def _smooth_together(self, wanted: protocol.ChangeShape, progress: Told) -> None:
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
            self._publish(protocol.Notice(level="info", text=text))

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
