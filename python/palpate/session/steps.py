"""Steps of segments in a session: a source, and changes of shape that can each change later."""

from __future__ import annotations

from typing import NamedTuple

import msgspec
import numpy as np

from palpate.base.errors import EmptySegmentError, OptionError
from palpate.base.progress import Progress, silent
from palpate.segmentation.mask_shape import Mask
from palpate.segmentation.operations import with_mask
from palpate.segmentation.segment_steps import (
    HandEdit,
    SegmentSteps,
    ShapeStep,
    apply_step,
    apply_steps,
)
from palpate.segmentation.voxel_set import VoxelSet, digest_of
from palpate.session.engine import Engine, option_errors
from palpate.session.known_steps import KeptList, KnownSteps, Listed, Made
from palpate.session.segment_state import EngineSegmentState
from palpate.session.segments import SessionSegments
from palpate.volumes.segment import Segment

__all__ = ["SessionSteps", "ShapeChange"]


class ShapeChange(NamedTuple):
    """What came of a change."""

    changed: bool
    """Whether voxels changed."""
    warnings: tuple[str, ...] = ()
    """What the grid cannot express of it."""


class SessionSteps:
    """The lists of steps of a session's segments."""

    def __init__(self, engine: Engine, segments: SessionSegments, known: KnownSteps) -> None:
        """Takes the engine, its segments, and what is known of their lists."""
        self._engine = engine
        self._segments = segments
        self._known = known

    def listed(self, state: EngineSegmentState) -> Listed:
        """Returns the list of a segment in this state, and whether it was edited by hand since."""
        return self._known.of(state)

    def steps(
        self, segment_id: int, *, name: str = "the segment", progress: Progress = silent
    ) -> SegmentSteps | None:
        """Returns how a segment is made: its source, and the steps after it.

        What was painted, erased or drilled since the last step is a step at the end.

        Args:
            segment_id: Number of the segment.
            name: What messages call it.
            progress: Told of work, which there is where the segment was edited by hand.

        Returns:
            None where nothing is known but its voxels: no threshold made it, and no step changed
            it; or it was cut, or replaced by ``replace_segment``.

        Raises:
            OptionError: There is no such segment.
        """
        listed = self._known.of(self._state(segment_id), closely=True)
        if listed.steps is None or not listed.by_hand:
            return listed.steps
        before = listed.steps.without_last_hand_edit()
        now = self._segments.segment(segment_id, name=name)
        try:
            made = self._made(before, now, progress).mask() != 0
        except (EmptySegmentError, OptionError):
            # steps that leave nothing: all of it was made by hand
            made = np.zeros(now.volume.shape, bool)
        edit = HandEdit.between(made, now.mask() != 0)
        return before if edit.added.is_empty and edit.removed.is_empty else before.then(edit)

    def change_shape(
        self,
        segment_id: int,
        step: ShapeStep,
        *,
        name: str = "the segment",
        progress: Progress = silent,
    ) -> ShapeChange:
        """Changes the shape of a segment: one more step at the end of its list, one step of undo.

        Args:
            segment_id: Number of the segment.
            step: How.
            name: What messages call the segment.
            progress: Told of the work; what it raises leaves everything as it was.

        Returns:
            Where no voxel changes there is no further step either.

        Raises:
            OptionError: There is no such segment, it is locked, the step does not fit, nothing
                would be left, or the segment was changed meanwhile.
        """
        self._check_unlocked(segment_id)
        listed = self.steps(segment_id, name=name, progress=progress)
        before = self._segments.segment(segment_id, name=name)
        progress(f"changing the shape of {name}", None)
        after = apply_step(before, step)
        progress(f"changing the shape of {name}", None)
        if np.array_equal(before.mask(), after.mask()):
            return ShapeChange(changed=False, warnings=after.warnings)
        longer = listed or SegmentSteps(VoxelSet.of(before.mask() != 0))
        self._exchange(segment_id, (before, listed), (after, longer.then(step)))
        return ShapeChange(changed=True, warnings=after.warnings)

    def set_steps(
        self,
        segment_id: int,
        steps: SegmentSteps,
        *,
        name: str = "the segment",
        progress: Progress = silent,
    ) -> ShapeChange:
        """Makes a segment anew from a source and steps: one step of undo.

        Where no voxel changes the list alone is exchanged, which is no step of undo.

        Args:
            segment_id: Number of the segment.
            steps: The source and the steps, for example those of ``steps`` with another value.
            name: What messages call the segment.
            progress: Told before each step; what it raises leaves everything as it was.

        Raises:
            OptionError: There is no such segment, it is locked, a step does not fit, nothing would
                be left, or the segment was changed meanwhile.
            EmptySegmentError: The threshold selects nothing.
        """
        self._check_unlocked(segment_id)
        listed = self.steps(segment_id, name=name, progress=progress)
        before = self._segments.segment(segment_id, name=name)
        after = self._made(steps, before, progress)
        progress(f"changing {name}", None)
        was = self._state(segment_id)["range"]
        if np.array_equal(before.mask(), after.mask()) and after.range == was:
            self._known.amend(segment_id, _recognised(before, was), steps)
            return ShapeChange(changed=False, warnings=after.warnings)
        self._exchange(segment_id, (before, listed), (after, steps))
        return ShapeChange(changed=True, warnings=after.warnings)

    def set_threshold(
        self,
        segment_id: int,
        low: float,
        high: float,
        *,
        name: str = "the segment",
        progress: Progress = silent,
    ) -> ShapeChange:
        """Makes a segment anew from another threshold, with the steps that it has.

        A segment that no threshold made becomes that threshold, without steps. One step of undo.

        Args:
            segment_id: Number of the segment.
            low: Lowest value [unit of the scan].
            high: Highest value.
            name: What messages call the segment.
            progress: Told before each step; what it raises leaves everything as it was.

        Raises:
            OptionError: As for ``set_steps``, or the values are no range.
            EmptySegmentError: The threshold selects nothing.
        """
        self._check_unlocked(segment_id)
        listed = self._known.of(self._state(segment_id))
        is_threshold = listed.steps is not None and listed.steps.threshold is not None
        if is_threshold and (listed.by_hand or (listed.steps and listed.steps.steps)):
            now = self.steps(segment_id, name=name, progress=progress)
            following = () if now is None else now.steps
            steps = SegmentSteps((low, high), following)
            return self.set_steps(segment_id, steps, name=name, progress=progress)
        made = self._segments.threshold(low, high, name=name)
        self._segments.replace_segment(segment_id, made)
        return ShapeChange(changed=True)

    def kept_steps(self, *, all_of_them: bool = False) -> bytes | None:
        """Returns the lists of all segments, for ``restore_steps``; None where there are none.

        Args:
            all_of_them: Whether those are among them that undo and redo can bring back.
        """
        for state in self._segments.segments():
            self._known.of(state)
        kept = self._known.kept(all_of_them=all_of_them)
        return msgspec.msgpack.encode(kept) if kept else None

    def restore_steps(self, kept: bytes) -> None:
        """Takes lists of steps that ``kept_steps`` returned.

        Raises:
            OptionError: The bytes are something else.
        """
        try:
            lists = msgspec.msgpack.decode(kept, type=list[KeptList])
        except msgspec.DecodeError as error:
            raise OptionError(f"steps of segments cannot be read: {error}") from None
        self._known.restore(lists)

    def _made(self, steps: SegmentSteps, on_grid_of: Segment, progress: Progress) -> Segment:
        """Returns the segment that a list makes."""
        if isinstance(steps.source, VoxelSet):
            source = with_mask(on_grid_of, steps.source.mask(on=on_grid_of.volume.shape))
        else:
            progress(f"threshold of {on_grid_of.name}", None)
            source = self._segments.threshold(*steps.source, name=on_grid_of.name)
        return apply_steps(source, steps.steps, progress=progress)

    def _exchange(
        self,
        segment_id: int,
        before: tuple[Segment, SegmentSteps | None],
        after: tuple[Segment, SegmentSteps | None],
    ) -> None:
        """Replaces the voxels of a segment that are still as they were, and notes both lists."""
        was = self._state(segment_id)["range"]
        old, new = before[0], after[0]
        now = self._segments.segment(segment_id)
        if not np.array_equal(old.mask(), now.mask()):
            raise OptionError(f"{old.name} was changed meanwhile; allowed: to try again")
        if new.voxel_count == 0:
            raise OptionError(f"nothing would be left of {old.name}; allowed: a smaller change")
        # before pages are told of the change, so that they are told of its list too
        self._known.record(
            segment_id,
            (_recognised(old, was), before[1]),
            (_recognised(new, new.range), after[1]),
        )
        try:
            with option_errors():
                self._engine.replace_segment(segment_id, new._internal, new.range)  # noqa: SLF001
        except BaseException:
            self._known.take_back(segment_id)
            raise
        # what is done by hand from now on comes after this list
        self._known.of(self._state(segment_id))

    def _check_unlocked(self, segment_id: int) -> None:
        """Refuses what is locked before work begins that may take long."""
        if self._state(segment_id)["locked"]:
            raise OptionError(
                f"a change of segment {segment_id} given, which is locked; allowed: unlock it first"
            )

    def _state(self, segment_id: int) -> EngineSegmentState:
        for state in self._engine.segments_state():
            if state["id"] == segment_id:
                return state
        with option_errors():
            self._engine.segment(segment_id)
        raise OptionError(f"segment {segment_id} given; allowed: one that is there")


def _recognised(segment: Segment, threshold: tuple[float, float] | None) -> Made:
    mask: Mask = segment.mask() != 0
    return Made(segment.voxel_count, digest_of(mask), threshold)
