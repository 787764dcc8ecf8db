"""The picture of a session: surfaces of segments, and changes of voxels."""

from __future__ import annotations

from palpate.base.errors import OptionError
from palpate.session.engine import Engine, option_errors
from palpate.session.picture_change import PictureChange
from palpate.volumes.surface import Source

__all__ = ["SessionPicture"]


class SessionPicture:
    """Surfaces that follow their segments, and changes that a picture has to follow."""

    def __init__(self, engine: Engine) -> None:
        """Takes the engine."""
        self._engine = engine

    def show_surface(
        self,
        segment_id: int,
        *,
        smoothing: int = 3,
        step: int = 1,
        source: Source = "intensities",
    ) -> None:
        """Keeps a surface of a segment up to date for ``picture_changes``.

        Args:
            segment_id: Number of the segment.
            smoothing: Degree of smoothing; 0 shows the voxels, each degree smooths over one more
                cell.
            step: Edge of a cell: 1, 2 or 4 voxels.
            source: What the surface is made from; see ``Surface``.

        Raises:
            OptionError: A value is out of range, or there is no such segment.
        """
        with option_errors():
            self._engine.show_surface(
                segment_id, smoothing=smoothing, step=step, of_bits=source == "bits"
            )

    def hide_surface(self, segment_id: int) -> None:
        """Stops keeping a surface of a segment.

        Raises:
            OptionError: There is no such segment.
        """
        with option_errors():
            self._engine.hide_surface(segment_id)

    def follow_edits(self, every: int) -> None:
        """Sets how often ``picture_changes`` reports edits (thesis 5.2.2).

        Args:
            every: Number of frames, of 60 a second, between two reports: 1 to 4. Slow machines need
                the larger ones.

        Raises:
            OptionError: The number is out of range.
        """
        if every not in range(1, 5):
            raise OptionError(f"every {every}th frame given; allowed: 1 to 4")
        self._engine.follow_edits(every)

    def set_labelled(self, segment_ids: list[int]) -> None:
        """Sets the segments whose labels ``picture_changes`` reports.

        Args:
            segment_ids: Numbers of the segments; where they overlap, the last one counts.
        """
        self._engine.set_labelled(segment_ids)

    def wait_for_changes(self, heard: int, seconds: float) -> int:
        """Waits until there may be new ``picture_changes``.

        Args:
            heard: What the previous call returned; 0 at first.
            seconds: Longest wait [s], 0 to 10.

        Returns:
            How often the picture has changed since the session's start.
        """
        return self._engine.wait_for_changes(heard, seconds)

    def picture_changes(self) -> list[PictureChange]:
        """Returns the changes of voxels and surfaces since the previous call, oldest first.

        The first call starts the observation. The keys are the fields of ``protocol.Changed``.
        """
        return self._engine.picture_changes()

    def whole_surfaces(self) -> PictureChange:
        """Returns all current surfaces, in the form of one of ``picture_changes``."""
        return self._engine.whole_surfaces()
