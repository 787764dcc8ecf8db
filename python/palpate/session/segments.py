"""Segments of a session: adding, changing, moving and splitting them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from palpate.session.air import air_of
from palpate.session.edited_values import EditedValues
from palpate.session.engine import Engine, Point, option_errors, triple
from palpate.session.felt import FeltSegments, TouchWish
from palpate.session.gap import Gap
from palpate.session.known_steps import KnownSteps, made_of
from palpate.session.painted_cut import PaintedCut
from palpate.session.regions import Regions
from palpate.session.segment_state import SegmentState
from palpate.volumes.scene import Scene
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume

__all__ = ["SessionSegments"]


class SessionSegments:
    """The segments of a session: their voxels, poses and touch settings."""

    def __init__(
        self, engine: Engine, scene: Scene, kept: tuple[Regions, FeltSegments, KnownSteps]
    ) -> None:
        """Takes the engine, the scene at the start, and what is kept of segments beside both."""
        self._engine = engine
        self._volume = scene.volume
        self._first = dict(enumerate(scene, start=1))
        self._regions, self._felt, self._known_steps = kept
        self.numbers = {
            segment_id: one.segment.number
            for segment_id, one in self._first.items()
            if one.segment.number is not None
        }
        """Labels of segments in the files that they were read from, by the segments' ids."""

    def add_segment(self, segment: Segment, *, touchable: bool = True) -> int:
        """Adds a segment.

        Args:
            segment: Its voxels, on the grid of the scan or on one of its own.
            touchable: Whether the probe collides with it.

        Returns:
            The number of the segment, 1 to 255.

        Raises:
            OptionError: It has another grid than the scan, or there are 255 segments.
        """
        with option_errors():
            voxels = segment._internal  # noqa: SLF001
            added = self._new(
                self._engine.add_segment(voxels, touchable, segment.range), TouchWish(touchable)
            )
        if segment.number is not None:
            self.numbers[added] = segment.number
        return added

    def _new(self, segment_id: int, wish: TouchWish) -> int:
        """Forgets what an earlier segment of this id had; returns the id."""
        self.numbers.pop(segment_id, None)
        self._felt.begin(segment_id, wish)
        self._known_steps.begin(segment_id)
        return self._regions.clear_for_new(segment_id)

    def replace_segment(self, segment_id: int, segment: Segment) -> None:
        """Replaces the voxels of a segment; its list of steps ends with that.

        Raises:
            OptionError: There is no such segment, it is locked, or the grids differ.
        """
        with option_errors():
            voxels = segment._internal  # noqa: SLF001
            self._engine.replace_segment(segment_id, voxels, segment.range)
        self._end_steps(segment_id)

    def _end_steps(self, segment_id: int) -> None:
        """Lets the voxels that a segment has now stand for themselves, or for a threshold."""
        state = next(each for each in self._engine.segments_state() if each["id"] == segment_id)
        if state["range"] is None:
            self._known_steps.amend(segment_id, made_of(self._engine, state), None)
        else:
            self._known_steps.of(state)

    def remove_segment(self, segment_id: int) -> None:
        """Removes a segment; ``undo`` restores it.

        Raises:
            OptionError: There is no such segment, or it is locked.
        """
        with option_errors():
            self._engine.remove_segment(segment_id)

    def remove_from_scan(self, part: Segment) -> None:
        """Takes voxels out of the scan: they become air, in the picture and for touch.

        All segments lose them but those that were moved or have a grid of their own; ``undo``
        brings everything back. The files of the scan stay as they are.

        Args:
            part: The voxels, on the grid of the scan.

        Raises:
            OptionError: They are on another grid, or a locked segment has some of them.
        """
        stored = (air_of(self._volume) - self._volume.intercept) / self._volume.slope
        ends = np.iinfo(np.int16)
        with option_errors():
            voxels = part._internal  # noqa: SLF001
            self._engine.remove_matter(voxels, int(np.clip(round(stored), ends.min, ends.max)))

    def threshold(self, low: float, high: float, *, name: str = "bone") -> Segment:
        """Returns a threshold as ``Volume.threshold``, but of the scan as edits have left it.

        Raises:
            OptionError: The values are no finite numbers, or not in order.
            EmptySegmentError: No voxel of the scan had such a value.
        """
        made = self._volume.threshold(low, high, name=name)
        with option_errors():
            now = self._engine.as_edited(made._internal, low, high)  # noqa: SLF001
        return Segment(now, name=made.name, volume=self._volume, range=made.range)

    def set_touchable(
        self,
        segment_id: int,
        *,
        touchable: bool,
        visible: bool | None = None,
        touched_while_hidden: bool | None = None,
    ) -> None:
        """Sets whether the probe collides with a segment.

        It does so with what is touchable and can be seen; with what is hidden only where it is to
        be touched while hidden, too.

        Args:
            segment_id: Number of the segment.
            touchable: Whether the probe collides with it while it is shown.
            visible: Whether it is shown; None leaves this as it is, at first as in the scene.
            touched_while_hidden: Whether the probe collides with it while it is hidden, too; None
                leaves this as it is.

        Raises:
            OptionError: There is no such segment.
        """
        self._felt.want(
            segment_id,
            touchable=touchable,
            visible=visible,
            touched_while_hidden=touched_while_hidden,
        )

    def show_segments(self, visible: Mapping[int, bool]) -> None:
        """Shows segments, or hides them, by their numbers.

        What is hidden is not touched, unless it is to be touched while hidden.

        Raises:
            OptionError: There is no such segment; then none is changed.
        """
        self._felt.show(visible)

    def set_locked(self, segment_id: int, *, locked: bool) -> None:
        """Sets whether the voxels of a segment are protected from changes.

        Tools, thresholds, shape operations, cuts and deformation do not change a locked segment,
        and it cannot be removed. Its appearance, touch settings and pose can still change. Undo and
        redo still reach earlier changes.

        Raises:
            OptionError: There is no such segment.
        """
        with option_errors():
            self._engine.set_locked(segment_id, locked)

    def move_segment(
        self, segment_id: int, pose: NDArray[np.float64], *, goes_on: bool = False
    ) -> None:
        """Moves a segment to a pose; touch follows it smoothly.

        Args:
            segment_id: Number of the segment.
            pose: Rigid transform from where the scan has the segment, as a homogeneous matrix of
                the scene, shape [4, 4] [mm].
            goes_on: Whether the next move of the segment belongs to the same step of undo.

        Raises:
            OptionError: The pose has scale, shear or numbers that are not finite, or 16 segments
                are moved already.
        """
        with option_errors():
            matrix = np.ascontiguousarray(pose, dtype=np.float64)
            self._engine.move_segment(segment_id, matrix, goes_on)

    def grab(self, segment_id: int | None, *, collides: bool = False) -> None:
        """Attaches a segment to the probe, or releases it (thesis 4.7, no-collision mode).

        It follows the motion of the probe and the rotation of the device's handle, and is no
        obstacle for the probe meanwhile. Once released, it is one again as soon as the probe is
        outside of it.

        Args:
            segment_id: Number of the segment; None releases the one that is attached.
            collides: Whether other touchable segments stop it.

        Raises:
            OptionError: There is no such segment, or 16 segments are moved already.
        """
        with option_errors():
            self._engine.grab(segment_id, collides)

    def turn_grabbed(self, rotation: Point) -> None:
        """Rotates the attached segment about the probe.

        Args:
            rotation: Rotation vector in scene axes [rad].
        """
        with option_errors():
            self._engine.turn_grabbed(*triple("rotation", rotation))

    def cut(self, segment_id: int, point: Point, normal: Point) -> int:
        """Splits a segment by a plane of the scene; one step of undo.

        The segment keeps the part behind the plane; its list of steps ends with that.

        Args:
            segment_id: Number of the segment.
            point: A point of the plane [scene, mm].
            normal: Normal of the plane, of any length but zero.

        Returns:
            The number of a new segment: the part on the side to which ``normal`` points.

        Raises:
            OptionError: The whole segment lies on one side of the plane.
        """
        with option_errors():
            part = self._engine.cut(segment_id, triple("point", point), triple("normal", normal))
            return self._new_part(part, segment_id)

    def cut_along(self, segment_id: int, cut: PaintedCut) -> int:
        """Splits a segment along a line drawn on the picture; one step of undo.

        The line is extruded along the lines of sight. The segment keeps the larger part; its list
        of steps ends with that.

        Returns:
            The number of a new segment: the smaller part.

        Raises:
            OptionError: The line is not valid, or the whole segment lies on one side of it.
        """
        with option_errors():
            part = self._engine.cut_along(segment_id, cut.given())
            return self._new_part(part, segment_id)

    def _new_part(self, part: int, segment_id: int) -> int:
        """Lets a part that was cut off begin; returns its number."""
        # a threshold or a step that changed later would bring some of the part back
        for each in (self._new(part, self._felt.of(segment_id)), segment_id):
            self._end_steps(each)
        return part

    def preview_cut(self, segment_id: int, cut: PaintedCut) -> tuple[float, float]:
        """Returns the volumes of the parts that ``cut_along`` would make.

        Returns:
            The larger and the smaller volume [ml].

        Raises:
            OptionError: The line is not valid, or the whole segment lies on one side of it.
        """
        with option_errors():
            larger, smaller = self._engine.preview_cut(segment_id, cut.given())
            return larger / 1000.0, smaller / 1000.0

    def gap(self, segment_id: int, other_id: int) -> Gap:
        """Measures the gap from the surface of one segment to another, at their current poses.

        Raises:
            OptionError: There is no such segment, or one of them is empty.
        """
        with option_errors():
            return Gap(*self._engine.gap(segment_id, other_id))

    def set_feel(
        self,
        segment_id: int,
        *,
        stiffness: float | None = None,
        friction_static: float | None = None,
        friction_kinetic: float | None = None,
    ) -> None:
        """Sets the touch settings of one segment.

        None means the session's setting; for friction, that of the segment's material where it has
        one.

        Args:
            segment_id: Number of the segment.
            stiffness: Stiffness of the surface [N/mm].
            friction_static: Static Coulomb coefficient, 0 to 2.
            friction_kinetic: Kinetic Coulomb coefficient, at most the static one.

        Raises:
            OptionError: There is no such segment, or a value is out of range.
        """
        with option_errors():
            self._engine.set_feel(segment_id, stiffness, friction_static, friction_kinetic)

    def segment(self, segment_id: int, *, name: str = "segment") -> Segment:
        """Returns the current voxels of a segment.

        Args:
            segment_id: Number of the segment.
            name: Name of what is returned.

        Raises:
            OptionError: There is no such segment.
        """
        with option_errors():
            internal = self._engine.segment(segment_id)
        own_grid = internal.own_grid
        volume = self._volume if own_grid is None else _empty(internal.dimensions, own_grid)
        made_by = {state["id"]: state["made_by"] for state in self.segments()}.get(segment_id)
        return Segment(internal, name=name, volume=volume, range=None, made_by=made_by)

    def values_at_rest(self, values: NDArray[np.int16]) -> NDArray[np.int16]:
        """Returns a scan's stored values with soft tissue as it is when no tool presses it.

        Args:
            values: The values as the picture shows them, shape [z, y, x]; they are not changed.

        Raises:
            OptionError: The session has ended.
        """
        with option_errors():
            pressed = self._engine.values_at_rest()
        at_rest = EditedValues(values)
        if pressed is not None and pressed["stored"] is not None:
            at_rest.write(pressed["low"], pressed["high"], pressed["stored"])
        return at_rest.values

    def scene_now(self, values: NDArray[np.int16] | None = None) -> Scene:
        """Returns the scan and its current segments, for example for ``export_scene``.

        Soft tissue is as it is when no tool presses it.

        Args:
            values: Stored values of the scan where edits have changed them (``picture_changes``
                reports these), shape [depth, height, width].
        """
        at_rest = None if values is None else self.values_at_rest(values)
        volume = self._volume if at_rest is None else self._volume.with_values(at_rest)
        now = Scene(volume)
        for state in self.segments():
            shown = self._first.get(state["id"])
            wish = self._felt.of(state["id"])
            name = f"segment {state['id']}" if shown is None else shown.name
            segment = self.segment(state["id"], name=name)
            segment.terminology = None if shown is None else shown.segment.terminology
            segment.number = self.numbers.get(state["id"])
            now.add(
                segment,
                colour=None if shown is None else shown.colour,
                visible=wish.visible,
                touchable=state["touchable"],
                touched_while_hidden=wish.touched_while_hidden,
            )
        return now

    def segments(self) -> list[SegmentState]:
        """Returns the current state of all segments.

        Returns:
            For each its ``id``, ``voxels``, ``volume`` [mm³], ``bounds`` [voxels], ``touchable``,
            ``felt`` (touchable, and visible or touched while hidden), ``locked``, ``pending``
            (touch does not follow its latest change yet), ``range`` and ``made_by`` (thresholds),
            ``feel``, ``material``, ``pose``, and ``grid``: ``patient_from_grid`` by rows where it
            has a grid of its own, in whose voxels ``bounds`` are then.
        """
        return [self._felt.told(state) for state in self._engine.segments_state()]

    def fill_box(
        self,
        segment_id: int,
        *,
        low: tuple[int, int, int],
        high: tuple[int, int, int],
        solid: bool,
    ) -> None:
        """Adds the voxels of a box to a segment, or removes them.

        Args:
            segment_id: Number of the segment.
            low: First voxel (x, y, z).
            high: One past the last voxel on each axis.
            solid: Whether voxels are added; else they are removed.

        Raises:
            OptionError: There is no such segment, it is locked, or the box is outside of the scan.
        """
        with option_errors():
            self._engine.fill_box(segment_id, low, high, solid)


def _empty(
    dimensions: tuple[int, int, int],
    grid: tuple[tuple[float, float, float], tuple[float, float, float], list[float]],
) -> Volume:
    """Returns a scan of zeros on a grid: its spacing, origin, and direction by rows."""
    spacing, origin, direction = grid
    values = np.zeros(dimensions[::-1], np.int16)
    axes = np.reshape(direction, (3, 3))
    return Volume(values, spacing=spacing, origin=origin, direction=axes)
