"""A region that was grown, until a person keeps it: narrower and wider ones can be chosen.

A segment of its own shows it, which is not touched. Where it is kept, the steps that showed it are
taken back first, so that it is one step of undo.
"""

from __future__ import annotations

import numpy as np

from palpate import protocol
from palpate.segmentation.growing_levels import USUAL
from palpate.segmentation.operations import Levels
from palpate.server.messages.segment_list import SegmentList
from palpate.session.session import Session
from palpate.volumes.appearance import Colour
from palpate.volumes.segment import Segment

__all__ = ["GrownPreview"]

GROWN: Colour = (0.98, 0.84, 0.3)
"""Of a region, until it is kept."""


class GrownPreview:
    """A grown region that is shown, at most one at a time."""

    def __init__(self, session: Session, segments: SegmentList) -> None:
        """Takes the session and what pages are told of its segments."""
        self._session = session
        self._segments = segments
        self._levels: Levels | None = None
        self._part: Segment | None = None
        self._preview = 0
        self._counts: list[int] = []
        """Voxels of the preview after each step of undo that has made it."""

    def show(self, levels: Levels, *, name: str) -> protocol.Grown:
        """Shows a region in the place of what was shown before."""
        self.drop()
        part = self._part_of(levels, USUAL, name=name)
        self._preview = self._segments.add_preview(part, colour=GROWN)
        self._levels, self._part, self._counts = levels, part, [part.voxel_count]
        return self._told(levels, part, USUAL)

    def change(self, level: int) -> protocol.Grown | None:
        """Shows the region of another level; None where none is shown."""
        if self._levels is None or self._part is None or self._count() is None:
            return None
        least, most = self._levels.ends
        held = min(max(level, least), most)
        part = self._part_of(self._levels, held, name=self._part.name)
        if part.voxel_count != self._counts[-1]:  # wider ones hold narrower ones
            self._session.replace_segment(self._preview, part)
            self._counts.append(part.voxel_count)
            self._part = part
        return self._told(self._levels, part, held)

    def keep(self) -> None:
        """Makes the region that is shown a segment."""
        part = self._part
        is_there = self._count() is not None
        self.drop()
        if part is not None and is_there:
            self._segments.add(part)

    def drop(self) -> None:
        """Takes the segment that shows it away, by undo where nothing was done since."""
        counts, self._counts, self._levels, self._part = self._counts, [], None, None
        befores = [*reversed(counts[:-1]), None] if counts else []
        for before in befores:
            if self._count() is None:
                return
            self._session.undo()
            if self._count() != before:
                # that was the step of something else
                self._session.redo()
                break
        if befores and self._count() is not None:
            self._session.remove_segment(self._preview)

    def _part_of(self, levels: Levels, level: int, *, name: str) -> Segment:
        volume = self._session.scene.volume
        mask = np.zeros(volume.shape, np.uint8)
        mask[levels.box] = levels.mask(level)
        return volume.segment(mask, name=name)

    def _told(self, levels: Levels, part: Segment, level: int) -> protocol.Grown:
        least, most = levels.ends
        return protocol.Grown(
            id=self._preview,
            level=level,
            usual=USUAL,
            least=least,
            most=most,
            volume_ml=part.voxel_count * part.volume.voxel_volume / 1000.0,
        )

    def _count(self) -> int | None:
        """Returns how many voxels the preview has; None where there is none."""
        states = self._session.segments()
        return next((each["voxels"] for each in states if each["id"] == self._preview), None)
