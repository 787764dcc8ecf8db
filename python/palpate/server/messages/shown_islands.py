"""Islands of a segment that are to go: a segment of their own shows them until a person decides.

An island is a part that hangs together over faces of voxels. Nothing of the segment changes before
that, and then in one step of undo: the step that showed them is taken back first.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from palpate import protocol
from palpate.base.errors import OptionError
from palpate.segmentation.lengths_in_voxels import least_voxels
from palpate.segmentation.mask_shape import island_numbers
from palpate.server.messages.segment_list import SegmentList
from palpate.session.appearance import UNMOVED
from palpate.session.session import Session
from palpate.volumes.appearance import Colour
from palpate.volumes.segment import Segment

__all__ = ["ShownIslands"]

GOING: Colour = (0.95, 0.36, 0.3)
"""Of what would go."""
MOST_TOLD = 20
"""Volumes that are told."""


@dataclass(frozen=True)
class Shown:
    """What would go of a segment."""

    segment_id: int
    before: Segment
    after: Segment
    preview: int
    steps: int
    """Of undo, which have made the preview."""


class ShownIslands:
    """The islands that are shown, at most of one segment."""

    def __init__(self, session: Session, segments: SegmentList) -> None:
        """Takes the session and what pages are told of its segments."""
        self._session = session
        self._segments = segments
        self._shown: Shown | None = None

    def show(
        self, wanted: protocol.ShowIslands, progress: Callable[[str, float | None], None]
    ) -> protocol.Islands:
        """Shows what would go in the place of what was shown before.

        Raises:
            OptionError: All of them would go, or the segment is locked.
        """
        self._hide()
        before = self._session.segment(wanted.id, name=self._segments.name_of(wanted.id))
        state = next(each for each in self._session.segments() if each["id"] == wanted.id)
        if state["locked"]:
            raise OptionError(f"{before.name} is locked; allowed: to unlock it")
        volume = before.volume
        numbers, sizes = island_numbers(before.mask() != 0)
        progress(f"parting {before.name}", None)
        least = least_voxels(wanted.least_ml, volume.voxel_volume)
        stays = min(wanted.most, int(np.count_nonzero(sizes >= least)))
        if stays == 0:
            raise OptionError(
                f"nothing would be left of {before.name}; allowed: a smaller volume than that of "
                "its largest island"
            )
        preview = None
        if stays < len(sizes):
            goes = volume.segment(numbers > stays, name=f"Goes of {before.name}")
            after = volume.segment((numbers > 0) & (numbers <= stays), name=before.name)
            if before.has_own_grid:
                goes, after = goes.as_object(), after.as_object()
            preview = self._segments.add_preview(goes, colour=GOING)
            steps = 1
            if state["pose"] is not None and state["pose"] != UNMOVED:
                self._session.move_segment(preview, np.reshape(state["pose"], (4, 4)))
                steps = 2
            self._shown = Shown(wanted.id, before, after, preview, steps)
        volumes = sizes * volume.voxel_volume / 1000.0
        return protocol.Islands(
            id=wanted.id,
            preview=preview,
            count=len(sizes),
            stays=stays,
            goes_ml=float(volumes[stays:].sum()),
            largest_ml=[float(each) for each in volumes[:MOST_TOLD]],
        )

    def end(self, *, removes: bool) -> None:
        """Hides what is shown, and removes it from its segment where that is wanted.

        Raises:
            OptionError: The segment was changed since.
        """
        shown = self._shown
        self._hide()
        if shown is None or not removes:
            return
        now = self._session.segment(shown.segment_id)
        if not np.array_equal(now.mask(), shown.before.mask()):
            raise OptionError(f"{shown.before.name} was changed meanwhile; allowed: to try again")
        self._session.replace_segment(shown.segment_id, shown.after)

    def _hide(self) -> None:
        """Takes the segment that shows them away, by undo where nothing was done since."""
        shown, self._shown = self._shown, None
        if shown is None or not self._is_there(shown.preview):
            return
        for _ in range(shown.steps):
            self._session.undo()
        if self._is_there(shown.preview):
            for _ in range(shown.steps):
                self._session.redo()
            self._session.remove_segment(shown.preview)

    def _is_there(self, segment_id: int) -> bool:
        return any(each["id"] == segment_id for each in self._session.segments())
