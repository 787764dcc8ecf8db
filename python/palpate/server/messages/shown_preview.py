"""A segment that shows what is not decided yet, until it is taken away again.

It is not touched. Where nothing else was done since, undo takes it away, so that it leaves no step
behind; while it changes, its steps are taken back now and then, so that they do not push older ones
out of what undo keeps.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from palpate.server.messages.segment_list import SegmentList
from palpate.session.appearance import UNMOVED
from palpate.session.session import Session
from palpate.volumes.appearance import Colour
from palpate.volumes.segment import Segment

__all__ = ["MOST_STEPS", "ShownPreview"]

MOST_STEPS = 16
"""Steps of undo that a preview has at most, as long as nothing else is done meanwhile."""


class ShownPreview:
    """At most one preview at a time."""

    def __init__(self, session: Session, segments: SegmentList, *, colour: Colour) -> None:
        """Takes the session, what pages are told of its segments, and the preview's colour."""
        self._session = session
        self._segments = segments
        self._colour = colour
        self._id = 0
        self._counts: list[int] = []
        """Its voxels after each step of undo that has made it; empty where there is none."""

    @property
    def is_there(self) -> bool:
        """Whether one is shown: undo may have taken it away."""
        return bool(self._counts) and self._count() is not None

    def show(self, part: Segment, *, pose: list[float] | None = None) -> int:
        """Shows a part in the place of what was shown before; returns its segment.

        Args:
            part: What is shown.
            pose: Where the segment stands that the part belongs to, by rows; None is as scanned.
        """
        self.hide()
        self._id = self._segments.add_preview(part, colour=self._colour)
        self._counts = [part.voxel_count]
        if pose is not None and pose != UNMOVED:
            self._session.move_segment(self._id, np.reshape(pose, (4, 4)))
            self._counts.append(part.voxel_count)
        return self._id

    def change(self, part: Segment) -> int:
        """Shows a part that is more or less than what is shown; returns its segment."""
        if part.voxel_count == self._counts[-1]:
            return self._id
        if len(self._counts) == MOST_STEPS:
            # back to the first; where something else was done since, all of them stay
            whole = self._take_back(self._counts[-2::-1])
            self._counts = self._counts[:1] if whole else self._counts[-1:]
        self._session.replace_segment(self._id, part)
        self._counts.append(part.voxel_count)
        return self._id

    def hide(self) -> None:
        """Takes what is shown away, by undo where nothing was done since."""
        there = self.is_there
        counts, self._counts = self._counts, []
        if there and not self._take_back([*counts[-2::-1], None]):
            self._session.remove_segment(self._id)

    def _take_back(self, befores: Sequence[int | None]) -> bool:
        """Undoes steps if all of them are of the preview; says whether they are.

        ``befores`` are its voxels before each of them, the last step first.
        """
        for undone, before in enumerate(befores, start=1):
            self._session.undo()
            if self._count() != before:
                for _ in range(undone):
                    self._session.redo()
                return False
        return True

    def _count(self) -> int | None:
        """Returns how many voxels it has; None where it is not there."""
        states = self._session.segments()
        return next((each["voxels"] for each in states if each["id"] == self._id), None)
