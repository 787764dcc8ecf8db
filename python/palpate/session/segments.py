"""What a session can do with segments: add, change, move and part them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.session.gap import Gap
from palpate.session.painted_cut import PaintedCut
from palpate.session.part import Point, given, triple
from palpate.session.soft_tissue import SessionMatter
from palpate.volumes.scene import Scene
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume

__all__ = ["SessionSegments"]


class SessionSegments(SessionMatter):
    """Segments of a session, and what they are made of."""

    def add_segment(self, segment: Segment, *, touchable: bool = True) -> int:
        """Adds a segment and returns its number, 1..255."""
        with given():
            voxels = segment._internal  # noqa: SLF001
            return self._new(self._internal.add_segment(voxels, touchable, segment.range))

    def replace_segment(self, segment_id: int, segment: Segment) -> None:
        """Puts other voxels in the place of a segment's."""
        with given():
            voxels = segment._internal  # noqa: SLF001
            self._internal.replace_segment(segment_id, voxels, segment.range)

    def remove_segment(self, segment_id: int) -> None:
        """Removes a segment; ``undo`` brings it back."""
        with given():
            self._internal.remove_segment(segment_id)

    def set_touchable(self, segment_id: int, *, touchable: bool) -> None:
        """Sets whether the probe is stopped by a segment."""
        with given():
            self._internal.set_touchable(segment_id, touchable)

    def set_locked(self, segment_id: int, *, locked: bool) -> None:
        """Sets whether the voxels of a segment stay as they are.

        No tool, threshold, change of shape, cut or matter that gives way changes a locked one, and
        it is not removed; its looks, feel and place are free. Undo and redo reach what was done
        before.
        """
        with given():
            self._internal.set_locked(segment_id, locked)

    def move_segment(
        self, segment_id: int, pose: NDArray[np.float64], *, goes_on: bool = False
    ) -> None:
        """Moves a segment from where the scan has it to a pose; touch goes there smoothly.

        Args:
            segment_id: Which segment.
            pose: A rigid transform of the scene as a homogeneous matrix, shape [4, 4] [mm].
            goes_on: Whether the next move of it belongs to the same step of undo.

        Raises:
            OptionError: The pose has scale, shear or numbers that are none, or 16 segments are
                moved already.
        """
        with given():
            matrix = np.ascontiguousarray(pose, dtype=np.float64)
            self._internal.move_segment(segment_id, matrix, goes_on)

    def grab(self, segment_id: int | None, *, collides: bool = False) -> None:
        """Takes a segment in the hand, or lets go of it (thesis 4.7, no-collision mode).

        It follows the probe's way and the turn of the device's handle, and is no obstacle for
        the probe meanwhile; let go, it is one again as soon as the probe is out of it.

        Args:
            segment_id: Which segment; None lets go.
            collides: Whether other touchable segments stop it.

        Raises:
            OptionError: There is no such segment, or 16 segments are moved already.
        """
        with given():
            self._internal.grab(segment_id, collides)

    def turn_grabbed(self, rotation: Point) -> None:
        """Turns the segment in the hand about the probe by a rotation vector [rad]."""
        with given():
            self._internal.turn_grabbed(*triple(rotation))

    def cut(self, segment_id: int, point: Point, normal: Point) -> int:
        """Parts a segment by a plane of the scene; one step of undo.

        The segment keeps what lies behind the plane.

        Returns:
            The number of a new segment, which has what lies before it, where ``normal`` points.

        Raises:
            OptionError: The plane leaves all of the segment on one side.
        """
        with given():
            return self._new(self._internal.cut(segment_id, triple(point), triple(normal)))

    def cut_along(self, segment_id: int, cut: PaintedCut) -> int:
        """Parts a segment along a line that was painted on the picture; one step of undo.

        The line is extruded away from the eye. The segment keeps the larger part.

        Returns:
            The number of a new segment, which has the smaller part.

        Raises:
            OptionError: The line is none, or leaves all of the segment on one side.
        """
        with given():
            return self._new(self._internal.cut_along(segment_id, cut.given()))

    def preview_cut(self, segment_id: int, cut: PaintedCut) -> tuple[float, float]:
        """Returns the volumes of the parts that ``cut_along`` would make, larger first [ml].

        Raises:
            OptionError: The line is none, or leaves all of the segment on one side.
        """
        with given():
            larger, smaller = self._internal.preview_cut(segment_id, cut.given())
            return larger / 1000.0, smaller / 1000.0

    def gap(self, segment_id: int, other_id: int) -> Gap:
        """Measures the gap from the surface of one segment to another, where both stand by now.

        Raises:
            OptionError: There is no such segment, or one of them is empty.
        """
        with given():
            return Gap(*self._internal.gap(segment_id, other_id))

    def set_feel(
        self,
        segment_id: int,
        *,
        stiffness: float | None = None,
        friction_static: float | None = None,
        friction_kinetic: float | None = None,
    ) -> None:
        """Sets how the surface of a segment feels; None is as the settings of touch say.

        Friction without one of its own is that of the segment's material, where it has one.

        Raises:
            OptionError: A value is out of range.
        """
        with given():
            self._internal.set_feel(segment_id, stiffness, friction_static, friction_kinetic)

    def segment(self, segment_id: int, *, name: str = "segment") -> Segment:
        """Returns the voxels of a segment as they are now."""
        with given():
            internal = self._internal.segment(segment_id)
        own_grid = internal.own_grid
        volume = self.scene.volume if own_grid is None else _empty(internal.dimensions, own_grid)
        made_by = {state["id"]: state["made_by"] for state in self.segments()}.get(segment_id)
        return Segment(internal, name=name, volume=volume, range=None, made_by=made_by)

    def scene_now(self, values: NDArray[np.int16] | None = None) -> Scene:
        """Returns the scan and its segments as they are now, such as for ``export_scene``.

        Args:
            values: The scan's stored values where edits have changed them, shape
                [depth, height, width], as ``picture_changes`` tell them.
        """
        volume = self.scene.volume if values is None else self.scene.volume.with_values(values)
        known = dict(zip(self.ids, self.scene, strict=True))
        now = Scene(volume)
        for state in self.segments():
            shown = known.get(state["id"])
            name = f"segment {state['id']}" if shown is None else shown.name
            segment = self.segment(state["id"], name=name)
            segment.terminology = None if shown is None else shown.segment.terminology
            now.add(
                segment,
                colour=None if shown is None else shown.colour,
                touchable=state["touchable"],
            )
        return now

    def segments(self) -> list[dict[str, Any]]:
        """Lists the segments as they are now.

        Each has id, voxels, volume [mm³], bounds, touchable, locked, pending, range, made_by, feel,
        pose, and grid: ``patient_from_grid`` by rows where it has a grid of its own, to which
        bounds belong then.
        """
        return self._internal.segments_state()

    def fill_box(
        self,
        segment_id: int,
        *,
        low: tuple[int, int, int],
        high: tuple[int, int, int],
        solid: bool,
    ) -> None:
        """Makes the voxels from ``low`` up to, but without, ``high`` part of a segment or not."""
        with given():
            self._internal.fill_box(segment_id, low, high, solid)


def _empty(
    dimensions: tuple[int, int, int],
    grid: tuple[tuple[float, float, float], tuple[float, float, float], list[float]],
) -> Volume:
    """Returns a scan of zeros on a grid: its spacing, origin, and direction by rows."""
    spacing, origin, direction = grid
    values = np.zeros(dimensions[::-1], np.int16)
    axes = np.reshape(direction, (3, 3))
    return Volume(values, spacing=spacing, origin=origin, direction=axes)
