"""Undo and redo in a session."""

from __future__ import annotations

from collections.abc import Sequence

from palpate.session.engine import Engine
from palpate.session.felt import FeltSegments
from palpate.session.known_steps import KnownSteps
from palpate.session.regions import Regions
from palpate.session.step_groups import StepGroup, StepGroups

__all__ = ["SessionHistory"]


class SessionHistory:
    """Steps of undo and redo, some of them grouped."""

    def __init__(self, engine: Engine, kept: tuple[Regions, FeltSegments, KnownSteps]) -> None:
        """Takes the engine, and what comes back with segments: regions, touch and steps."""
        self._engine = engine
        self._regions, self._felt, self._known_steps = kept
        self.groups = StepGroups(self._voxel_count)
        """Steps that are one."""

    def undo(self) -> bool:
        """Undoes the last step.

        Returns:
            Whether there was one.
        """
        with self._known_steps.moving(back=True), self._regions.restored():
            undone = self.groups.undo(self._engine.undo)
        self._felt.hold()
        return undone

    def redo(self) -> bool:
        """Redoes the last undone step.

        Returns:
            Whether there was one.
        """
        with self._known_steps.moving(back=False), self._regions.restored():
            redone = self.groups.redo(self._engine.redo)
        self._felt.hold()
        return redone

    def group_steps(self, segment_id: int, counts: Sequence[int | None]) -> None:
        """Makes the last edits of a segment one step of ``undo`` and ``redo``.

        Args:
            segment_id: Number of the segment.
            counts: Its number of voxels before the first of these edits and after each of them,
                None where it was removed. Each edit must only add voxels, or only remove some.
        """
        group = StepGroup(segment_id, tuple(counts))
        self.groups.add(group)
        if len(counts) > 2:
            self._engine.note_in_journal(self.groups.note(group))

    def _voxel_count(self, segment_id: int) -> int | None:
        try:
            return self._engine.segment(segment_id).voxel_count
        except ValueError:
            return None
