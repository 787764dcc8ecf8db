"""Which list of steps belongs to the voxels that a segment has now.

The engine knows nothing of steps. A list is kept under a digest of the voxels that it makes, in the
order in which lists came; so undo and redo, whatever they take back, bring the list of the voxels
that come back. Voxels that no list makes were edited by hand since the last list that did.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from threading import RLock
from typing import NamedTuple

import msgspec

from palpate.base.errors import OptionError
from palpate.segmentation.segment_steps import SegmentSteps
from palpate.segmentation.voxel_set import digest_of
from palpate.session.engine import Engine
from palpate.session.segment_state import EngineSegmentState, Limits

__all__ = ["KeptList", "KnownSteps", "Listed", "Made", "made_of"]

MOST = 200
"""Lists kept of a segment; older ones are forgotten."""


class Made(msgspec.Struct, frozen=True):
    """Voxels of a segment, to be recognised by."""

    voxels: int
    digest: bytes
    range: Limits | None


class Listed(NamedTuple):
    """The list of a segment."""

    steps: SegmentSteps | None
    """None where it has none."""
    by_hand: bool
    """Whether the segment was edited by hand since."""


class KeptList(msgspec.Struct, frozen=True):
    """A list as files keep it."""

    id: int
    made: Made
    steps: SegmentSteps | None
    is_now: bool
    """Whether it is the one that holds."""


NOT_LISTED = Listed(None, by_hand=False)


@dataclass
class Line:
    """The lists of a segment in the order in which they came."""

    lists: list[tuple[Made, SegmentSteps | None]] = field(default_factory=list)
    at: int = -1
    """Where the one that held last is."""


class KnownSteps:
    """The lists of all segments of a session; from any thread."""

    def __init__(self, engine: Engine) -> None:
        """Knows of no lists."""
        self._engine = engine
        self._lines: dict[int, Line] = {}
        self._seen: dict[int, tuple[object, Listed]] = {}
        self._back: bool | None = None
        self._lock = RLock()

    def of(self, state: EngineSegmentState, *, closely: bool = False) -> Listed:
        """Returns the list of a segment in this state.

        Its voxels are looked at where their number, box or range has changed to one that a list
        has, and where this is asked for ``closely``.
        """
        look = (state["voxels"], repr(state["bounds"]), state["range"])
        with self._lock:
            seen = self._seen.get(state["id"])
            if closely or seen is None or seen[0] != look:
                seen = (look, self._found(state))
                self._seen[state["id"]] = seen
            return seen[1]

    def record(
        self,
        segment_id: int,
        before: tuple[Made, SegmentSteps | None],
        after: tuple[Made, SegmentSteps | None],
    ) -> None:
        """Takes the lists of a segment before and after a change of its voxels that is to come."""
        with self._lock:
            line = self._lines.setdefault(segment_id, Line())
            known = line.lists[: line.at + 1]
            if known and known[-1][0] == before[0]:
                known.pop()
            line.lists = [*known, before, after][-MOST:]
            # the change is still to come
            line.at = len(line.lists) - 2
            self._seen.pop(segment_id, None)

    def take_back(self, segment_id: int) -> None:
        """Forgets what was recorded last: the change could not be made."""
        with self._lock:
            self._lines[segment_id].lists.pop()

    def amend(self, segment_id: int, made: Made, steps: SegmentSteps | None) -> None:
        """Gives the voxels that a segment has now another list."""
        with self._lock:
            line = self._lines.setdefault(segment_id, Line())
            known = line.at >= 0 and line.lists[line.at][0] == made
            line.lists[line.at + (not known) : line.at + 1] = [(made, steps)]
            line.at += not known
            self._seen.pop(segment_id, None)

    def begin(self, segment_id: int) -> None:
        """Forgets which list held last: a new segment has this number."""
        with self._lock:
            self._seen.pop(segment_id, None)
            if segment_id in self._lines:
                self._lines[segment_id].at = -1

    @contextmanager
    def moving(self, *, back: bool) -> Iterator[None]:
        """Lets lists follow what undo (``back``) or redo does inside the block."""
        self._back = back
        try:
            yield
            for state in self._engine.segments_state():
                self.of(state)
        finally:
            self._back = None

    def kept(self, *, all_of_them: bool) -> list[KeptList]:
        """Returns the lists that hold, or all of them."""
        with self._lock:
            return [
                KeptList(segment_id, made, steps, is_now)
                for segment_id, line in self._lines.items()
                for made, steps, is_now in (
                    (*one, place == line.at) for place, one in enumerate(line.lists)
                )
                if is_now or all_of_them
            ]

    def restore(self, kept: list[KeptList]) -> None:
        """Takes lists that were kept, in place of those that are known."""
        with self._lock:
            self._lines.clear()
            self._seen.clear()
            for each in kept:
                line = self._lines.setdefault(each.id, Line())
                line.lists.append((each.made, each.steps))
                if each.is_now:
                    line.at = len(line.lists) - 1

    def _found(self, state: EngineSegmentState) -> Listed:
        segment_id, line = state["id"], self._lines.get(state["id"], Line())
        if any(made.voxels == state["voxels"] for made, _ in line.lists):
            place = self._place(line, made_of(self._engine, state))
            if place is not None:
                line.at = place
                return Listed(line.lists[place][1], by_hand=False)
        if state["range"] is not None:
            return Listed(SegmentSteps(state["range"]), by_hand=False)
        seen = self._seen.get(segment_id)
        if seen is not None and seen[1].steps is not None:
            return Listed(seen[1].steps, by_hand=True)
        if line.at >= 0:
            steps = line.lists[line.at][1]
            return NOT_LISTED if steps is None else Listed(steps, by_hand=True)
        if state["made_by"] is not None and state["grid"] is None:
            return Listed(SegmentSteps(state["made_by"]), by_hand=True)
        return NOT_LISTED

    def _place(self, line: Line, made: Made) -> int | None:
        """Returns where the list of these voxels is, nearest to the last one.

        Where undo goes back, one before it comes first, and where redo goes on, one after it.
        """
        places = [place for place, (one, _) in enumerate(line.lists) if one == made]
        if self._back is None:
            # a list that was recorded for a change comes right after the last one
            return min(places, key=lambda place: (abs(place - line.at), -place), default=None)
        onward = -1 if self._back else 1
        return min(
            places,
            key=lambda place: ((place - line.at) * onward < 0, abs(place - line.at)),
            default=None,
        )


def made_of(engine: Engine, state: EngineSegmentState) -> Made:
    """Returns what the voxels of a segment are recognised by.

    Raises:
        OptionError: There is no such segment any more.
    """
    try:
        voxels = engine.segment(state["id"])
    except ValueError as error:
        raise OptionError(str(error)) from None
    return Made(voxels.voxel_count, digest_of(voxels.mask() != 0), state["range"])
