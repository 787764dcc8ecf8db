"""Which segments the probe feels: what is seen is what is felt.

The engine knows of a segment only whether the probe collides with it. What a person asked for is
kept here, so that a segment that is hidden and shown again is felt as before.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from threading import RLock

from palpate.base.errors import OptionError
from palpate.session.engine import Engine, option_errors
from palpate.session.segment_state import EngineSegmentState, SegmentState
from palpate.volumes.scene import Scene, SceneSegment

__all__ = ["FeltSegments", "TouchWish"]


@dataclass(frozen=True)
class TouchWish:
    """What a person wants of the touch of a segment."""

    touchable: bool = True
    visible: bool = True
    touched_while_hidden: bool = False

    @property
    def is_felt(self) -> bool:
        """Whether the probe collides with the segment."""
        return self.touchable and (self.visible or self.touched_while_hidden)

    @classmethod
    def of(cls, shown: SceneSegment) -> TouchWish:
        """Returns what a scene says of its segment."""
        look = shown.appearance
        return cls(shown.touchable, look.visible, look.touched_while_hidden)


class FeltSegments:
    """What is wanted of the touch of all segments of a session; from any thread."""

    def __init__(self, engine: Engine, scene: Scene) -> None:
        """Takes the engine, which was started with what holds in this scene."""
        self._engine = engine
        self._wishes = {number: TouchWish.of(one) for number, one in enumerate(scene, start=1)}
        self._lock = RLock()

    def of(self, segment_id: int) -> TouchWish:
        """Returns what is wanted of a segment."""
        return self._wishes.get(segment_id, TouchWish())

    def told(self, state: EngineSegmentState) -> SegmentState:
        """Returns the state of a segment with what is wanted of it beside what holds."""
        wish = self._wishes.get(state["id"])
        touchable = state["touchable"] if wish is None else wish.touchable
        return {**state, "touchable": touchable, "felt": state["touchable"]}

    def want(
        self,
        segment_id: int,
        *,
        touchable: bool,
        visible: bool | None = None,
        touched_while_hidden: bool | None = None,
    ) -> None:
        """Changes what is wanted of a segment; None leaves it as it is.

        Raises:
            OptionError: There is no such segment.
        """
        with self._lock:
            before = self.of(segment_id)
            pinned = before.touched_while_hidden
            wish = TouchWish(
                touchable,
                before.visible if visible is None else visible,
                pinned if touched_while_hidden is None else touched_while_hidden,
            )
            # stored before the engine reports a change: whoever reads it then finds the new one
            self._wishes[segment_id] = wish
            try:
                with option_errors():
                    self._engine.set_touchable(segment_id, wish.is_felt)
            except OptionError:
                self._wishes[segment_id] = before
                raise

    def show(self, visible: Mapping[int, bool]) -> None:
        """Changes which segments are shown.

        Raises:
            OptionError: There is no such segment; then none is changed.
        """
        with self._lock:
            before = self._wishes.copy()
            for segment_id, shown in visible.items():
                self._wishes[segment_id] = replace(self.of(segment_id), visible=shown)
            try:
                with option_errors():
                    # the engine builds its scene of touch anew once for all
                    self._engine.set_all_touchable(
                        [(each, self.of(each).is_felt) for each in visible]
                    )
            except OptionError:
                self._wishes = before
                raise

    def begin(self, segment_id: int, wish: TouchWish) -> int:
        """Takes what is wanted of a new segment; returns its number."""
        with self._lock:
            self._wishes[segment_id] = wish
            self.hold()
        return segment_id

    def learn(self) -> None:
        """Takes over which segments are obstacles from the engine, which has recovered them."""
        with self._lock:
            for state in self._engine.segments_state():
                wish = self.of(state["id"])
                if wish.is_felt != state["touchable"]:
                    self._wishes[state["id"]] = replace(wish, touchable=state["touchable"])
            self.hold()

    def hold(self) -> None:
        """Has the engine follow what is wanted where undo, redo or a cut brought something else."""
        with self._lock:
            wanted = []
            for state in self._engine.segments_state():
                wish = self._wishes.get(state["id"])
                if wish is not None and wish.is_felt != state["touchable"]:
                    wanted.append((state["id"], wish.is_felt))
            self._engine.set_all_touchable(wanted)
