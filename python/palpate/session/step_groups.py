"""Groups of the engine's steps that undo and redo take as one.

The engine's undo knows edits of boxes. A group is recognised by the number of voxels that the
segment has after each of its steps, so that steps of others before, between or after never count as
its own.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

import msgspec

__all__ = ["StepGroup", "StepGroups"]

MOST = 1000
"""Most groups; older ones are undone step by step."""
NOTE = b"steps that are one: "
"""How a note of a journal begins that tells a group."""


@dataclass(frozen=True)
class StepGroup:
    """Successive steps on one segment."""

    segment_id: int
    counts: tuple[int | None, ...]
    """Voxels of the segment before the first step and after each step; None where there is none."""


class StepGroups:
    """All groups of a session."""

    def __init__(self, count: Callable[[int], int | None]) -> None:
        """Takes the function that counts a segment's voxels; None where it was removed."""
        self._count = count
        self._groups: deque[StepGroup] = deque(maxlen=MOST)

    def add(self, group: StepGroup) -> None:
        """Adds a group whose steps were just done."""
        if len(group.counts) > 2:  # more than one step
            self._groups.append(group)

    def note(self, group: StepGroup) -> bytes:
        """Returns a group as a note of a journal."""
        return NOTE + msgspec.json.encode(group)

    def take(self, notes: list[bytes]) -> list[bytes]:
        """Adds the groups that notes of a journal tell; returns the other notes."""
        for note in notes:
            if note.startswith(NOTE):
                # without it the steps are undone one by one
                with suppress(msgspec.DecodeError):
                    self.add(msgspec.json.decode(note.removeprefix(NOTE), type=StepGroup))
        return [note for note in notes if not note.startswith(NOTE)]

    def undo(self, once: Callable[[], bool]) -> bool:
        """Undoes a step or a group; ``once`` undoes one step, if there is one."""
        return self._go(once, back=True)

    def redo(self, once: Callable[[], bool]) -> bool:
        """Redoes a step or a group; ``once`` redoes one step, if there is one."""
        return self._go(once, back=False)

    def _go(self, once: Callable[[], bool], *, back: bool) -> bool:
        numbers = {each.segment_id for each in self._groups}
        before = {number: self._count(number) for number in numbers}
        if not once():
            return False
        after = {number: self._count(number) for number in numbers}
        for group in reversed(self._groups):
            counts = group.counts[::-1] if back else group.counts
            now = before[group.segment_id], after[group.segment_id]
            if now == counts[:2]:
                for _ in counts[2:]:
                    once()
                break
        return True
