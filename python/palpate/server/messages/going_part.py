"""A part that is to go: a preview shows it until a person decides.

Nothing else changes before that, and then in one step of undo: the steps that showed the part are
taken back first.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from palpate import protocol
from palpate.base.errors import OptionError
from palpate.segmentation.segment_steps import ShapeStep
from palpate.server.messages.segment_list import SegmentList
from palpate.server.messages.shown_preview import ShownPreview
from palpate.session.session import Session
from palpate.volumes.appearance import Colour
from palpate.volumes.segment import Segment

__all__ = ["GoingPart"]

GOING: Colour = (0.95, 0.36, 0.3)
"""Of what would go."""


class GoingPart:
    """What would go, at most one part at a time."""

    def __init__(self, session: Session, segments: SegmentList) -> None:
        """Takes the session and what pages are told of its segments."""
        self.session = session
        self.segments = segments
        self._preview = ShownPreview(session, segments, colour=GOING)
        self._remove: Callable[[], None] | None = None
        self.told: protocol.Islands | protocol.Scissors | None = None
        """What pages were told of the part that is shown; None where none is."""

    def show(
        self, part: Segment, remove: Callable[[], None], *, pose: list[float] | None = None
    ) -> int:
        """Shows a part in the place of what was shown before; returns its segment.

        Args:
            part: What would go.
            remove: Removes it in one step of undo, or raises ``OptionError``.
            pose: Where the segment stands that the part belongs to, by rows; None is as scanned.
        """
        self.hide()
        self._remove = remove
        return self._preview.show(part, pose=pose)

    def end(self, *, removes: bool) -> None:
        """Hides what is shown, and removes it where that is wanted.

        Raises:
            OptionError: It cannot be removed.
        """
        remove = self._remove
        self.hide()
        if remove is not None and removes:
            remove()

    def change_shape(self, segment_id: int, step: ShapeStep, *, before: Segment) -> None:
        """Changes a segment that is still as it was, as one more step of its list.

        Raises:
            OptionError: It was changed since.
        """
        if not np.array_equal(self.session.segment(segment_id).mask(), before.mask()):
            raise OptionError(f"{before.name} was changed meanwhile; allowed: to try again")
        self.session.change_shape(segment_id, step, name=before.name)
        self.segments.steps_changed()

    def hide(self) -> None:
        """Takes the segment that shows it away."""
        self._remove = self.told = None
        self._preview.hide()
