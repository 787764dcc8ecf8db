"""What a session tells the picture: surfaces, and what changed in voxels."""

from __future__ import annotations

from typing import Any

from palpate.base.errors import OptionError
from palpate.session.part import SessionPart, given
from palpate.volumes.surface import Source

__all__ = ["SessionPicture"]


class SessionPicture(SessionPart):
    """The picture of a session."""

    def show_surface(
        self,
        segment_id: int,
        *,
        smoothing: int = 3,
        step: int = 1,
        source: Source = "intensities",
    ) -> None:
        """Keeps a surface of a segment that follows its voxels, for ``picture_changes``.

        Args:
            segment_id: Which segment.
            smoothing: Degree; 0 shows the voxels as they are, each degree looks a cell farther.
            step: Edge of a cell: 1, 2 or 4 voxels.
            source: What it is made from; see ``Surface``.

        Raises:
            OptionError: A value is out of range, or there is no such segment.
        """
        with given():
            self._internal.show_surface(
                segment_id, smoothing=smoothing, step=step, of_bits=source == "bits"
            )

    def hide_surface(self, segment_id: int) -> None:
        """Keeps no surface of a segment any more."""
        with given():
            self._internal.hide_surface(segment_id)

    def follow_edits(self, every: int) -> None:
        """Has ``picture_changes`` follow edits every so many-th of 60 frames a second.

        Source: thesis 5.2.2.

        Args:
            every: 1 follows at once; up to 4, for slow machines.

        Raises:
            OptionError: The number is out of range.
        """
        if every not in range(1, 5):
            raise OptionError(f"every {every}th frame given; allowed: 1 to 4")
        self._internal.follow_edits(every)

    def set_labelled(self, segment_ids: list[int]) -> None:
        """Names the segments whose labels ``picture_changes`` tell, the last of several on top."""
        self._internal.set_labelled(segment_ids)

    def wait_for_changes(self, heard: int, seconds: float) -> int:
        """Waits until there may be ``picture_changes`` that were not there before.

        Args:
            heard: What the call before returned, at first 0.
            seconds: How long to wait at most.
        """
        return self._internal.wait_for_changes(heard, seconds)

    def picture_changes(self) -> list[dict[str, Any]]:
        """Returns what changed in voxels and surfaces since the call before, oldest first.

        The keys are the fields of ``protocol.Changed``. The first call begins to watch.
        """
        return self._internal.picture_changes()

    def whole_surfaces(self) -> dict[str, Any]:
        """Returns all surfaces as they are, as one of ``picture_changes``."""
        return self._internal.whole_surfaces()
