"""A part that is to go: a segment of its own shows it until a person decides.

Nothing else changes before that, and then in one step of undo: the steps that showed the part are
taken back first.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from palpate.base.errors import OptionError
from palpate.segmentation.segment_steps import ShapeStep
from palpate.server.messages.segment_list import SegmentList
from palpate.session.appearance import UNMOVED
from palpate.session.session import Session
from palpate.volumes.appearance import Colour
from palpate.volumes.segment import Segment

__all__ = ["GoingPart"]

GOING: Colour = (0.95, 0.36, 0.3)
"""Of what would go."""


@dataclass(frozen=True)
class Shown:
    """A part that is shown."""

    preview: int
    steps: int
    """Of undo, which have made the preview."""
    remove: Callable[[], None]


class GoingPart:
    """What would go, at most one part at a time."""

    def __init__(self, session: Session, segments: SegmentList) -> None:
        """Takes the session and what pages are told of its segments."""
        self.session = session
        self.segments = segments
        self._shown: Shown | None = None

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
        preview, steps = self.segments.add_preview(part, colour=GOING), 1
        if pose is not None and pose != UNMOVED:
            self.session.move_segment(preview, np.reshape(pose, (4, 4)))
            steps = 2
        self._shown = Shown(preview, steps, remove)
        return preview

    def end(self, *, removes: bool) -> None:
        """Hides what is shown, and removes it where that is wanted.

        Raises:
            OptionError: It cannot be removed.
        """
        shown = self._shown
        self.hide()
        if shown is not None and removes:
            shown.remove()

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
        """Takes the segment that shows it away, by undo where nothing was done since."""
        shown, self._shown = self._shown, None
        if shown is None or not self._is_there(shown.preview):
            return
        for _ in range(shown.steps):
            self.session.undo()
        if self._is_there(shown.preview):
            for _ in range(shown.steps):
                self.session.redo()
            self.session.remove_segment(shown.preview)

    def _is_there(self, segment_id: int) -> bool:
        return any(each["id"] == segment_id for each in self.session.segments())
