"""A region that was grown, until a person keeps it: narrower and wider ones can be chosen.

Where it is kept, the steps that showed it are taken back first, so that it is one step of undo.
"""

from __future__ import annotations

import numpy as np

from palpate import protocol
from palpate.segmentation.growing.levels import USUAL
from palpate.segmentation.operations import Levels
from palpate.server.messages.segment_list import SegmentList
from palpate.server.messages.shown_preview import ShownPreview
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
        self._preview = ShownPreview(session, segments, colour=GROWN)
        self._levels: Levels | None = None
        self._part: Segment | None = None
        self.told: protocol.Grown | None = None
        """What pages were told of the region that is shown; None where none is."""

    def show(self, levels: Levels, *, name: str) -> protocol.Grown:
        """Shows a region in the place of what was shown before."""
        part = self._part_of(levels, USUAL, name=name)
        self._levels, self._part = levels, part
        number = self._preview.show(part)
        return self._tell(levels, part, USUAL, number=number)

    def change(self, level: int) -> protocol.Grown | None:
        """Shows the region of another level; None where none is shown."""
        if self._levels is None or self._part is None or not self._preview.is_there:
            return None
        least, most = self._levels.ends
        held = min(max(level, least), most)
        # wider ones hold narrower ones
        self._part = self._part_of(self._levels, held, name=self._part.name)
        number = self._preview.change(self._part)
        return self._tell(self._levels, self._part, held, number=number)

    def keep(self) -> None:
        """Makes the region that is shown a segment."""
        part, is_there = self._part, self._preview.is_there
        self.drop()
        if part is not None and is_there:
            self._segments.add(part)

    def drop(self) -> None:
        """Takes the segment that shows it away."""
        self._levels = self._part = self.told = None
        self._preview.hide()

    def _part_of(self, levels: Levels, level: int, *, name: str) -> Segment:
        volume = self._session.scene.volume
        mask = np.zeros(volume.shape, np.uint8)
        mask[levels.box] = levels.mask(level)
        return volume.segment(mask, name=name)

    def _tell(self, levels: Levels, part: Segment, level: int, *, number: int) -> protocol.Grown:
        least, most = levels.ends
        self.told = protocol.Grown(
            id=number,
            level=level,
            usual=USUAL,
            least=least,
            most=most,
            volume_ml=part.voxel_count * part.volume.voxel_volume / 1000.0,
        )
        return self.told
