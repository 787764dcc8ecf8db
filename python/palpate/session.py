"""Touch: a scene, a device and the engine between them.

Frame: scene, LPS [mm]; forces [N] in scene axes; times [s] since the session's start.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import asdict, astuple, dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from types import TracebackType
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import NDArray

from palpate import _core
from palpate.errors import OptionError
from palpate.gap import Gap
from palpate.needle import NeedleEvent, Tissue
from palpate.package_version import package_version
from palpate.painted_cut import PaintedCut
from palpate.recording import Recording
from palpate.recording_file import FORMAT, VERSION, About, AboutScan, AboutSegment
from palpate.scene import Scene
from palpate.scripted_path import ScriptedPath
from palpate.segment import Segment
from palpate.session_matter import SessionMatter
from palpate.session_part import Point, given, triple
from palpate.step_groups import StepGroup, StepGroups
from palpate.surface import Source
from palpate.touch_settings import TouchSettings
from palpate.volume import Volume

__all__ = ["Session", "SessionOptions"]

@dataclass(frozen=True, kw_only=True)
class SessionOptions:
    """How a session runs; what is None is the engine's own choice."""

    rate_hz: int = 1000
    """Ticks of the servo a second."""
    device_rate_hz: int | None = None
    """Readings of the device a second; None is the servo's rate."""
    real_time: bool = True
    """Whether time is that of the clock; else the session stands still until ``run``."""
    start: tuple[float, float, float] | None = None
    """Where the device starts [scene]; by default beside the scan."""
    touch: TouchSettings = field(default_factory=TouchSettings)
    """How touch feels."""


AIR = -1000.0
"""What a scan in HU reads where the drill has taken matter away."""

CORTICAL_ENERGY = 1300.0
"""Work of the drill per volume of cortical bone [mJ/mm³] (docs/algorithms/tools.md)."""


class Session(SessionMatter):
    """A running session; leaving its ``with`` block stops it and takes the force away."""

    def __init__(
        self,
        scene: Scene,
        *,
        device: Literal["simulated"] | ScriptedPath = "simulated",
        options: SessionOptions | None = None,
    ) -> None:
        """Starts the engine's threads.

        Args:
            scene: The scan and the segments to touch.
            device: The simulated device with a hand, or a path that the device follows.
            options: How the session runs.

        Raises:
            OptionError: An option is out of range.
        """
        super().__init__()
        self.scene = scene
        self.options = options or SessionOptions()
        self.device = device if isinstance(device, str) else "scripted"
        path = np.ascontiguousarray(device.rows) if isinstance(device, ScriptedPath) else None
        with given():
            self._internal = _core.Session(
                scene.volume._internal,  # noqa: SLF001  # only this class and its kin unwrap it
                device=self.device,
                path=path,
                rate_hz=self.options.rate_hz,
                device_rate_hz=self.options.device_rate_hz,
                real_time=self.options.real_time,
                start=self.options.start,
                settings=asdict(self.options.touch),
                segments=[
                    (shown.segment._internal, shown.touchable, shown.segment.range)  # noqa: SLF001
                    for shown in scene
                ],
            )
        self.ids = list(range(1, len(scene) + 1))
        self._about: About | None = None
        self._groups = StepGroups(self._voxel_count)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.stop()

    def stop(self) -> None:
        """Takes the force away and ends the threads; a second call does nothing."""
        self._internal.stop()

    @property
    def is_running(self) -> bool:
        """Whether it was neither stopped nor ended by itself."""
        return self._internal.is_running

    @property
    def device_limits(self) -> tuple[float, float]:
        """The largest stiffness [N/mm] and force [N] that the device bears."""
        return self._internal.device_limits

    @property
    def device_reach(self) -> float:
        """How far from the middle of its workspace the device reaches [device mm]."""
        return self._internal.device_reach

    # --- the hand -------------------------------------------------------------------------

    def hand(self, target: Point) -> None:
        """Lets the hand of the simulated device pull to a point."""
        with given():
            self._internal.hand(*triple(target))

    def place(self, point: Point) -> tuple[float, float, float]:
        """Puts probe, device and hand at a point, or in the free voxel nearest to it.

        Returns:
            Where they are.

        Raises:
            OptionError: There is no free voxel near.
        """
        with given():
            return self._internal.place(*triple(point))

    def view(self, *, right: Point, up: Point) -> None:
        """Turns the device's axes to those of the view (thesis 4.7).

        Raises:
            OptionError: The axes are not perpendicular.
        """
        with given():
            self._internal.view(triple(right), triple(up))

    def settings(self, changes: TouchSettings | None = None) -> dict[str, Any]:
        """Changes what is given, as far as the device bears it; returns what holds.

        Raises:
            OptionError: A setting is out of range.
        """
        with given():
            return self._internal.settings(asdict(changes or TouchSettings()))

    def clutch(self, *, on: bool) -> None:
        """Has the device move without the probe, or with it again from where both are then.

        So a device with a small workspace goes on beyond its end. Without the probe it feels
        nothing.
        """
        with given():
            self._internal.clutch(on)

    # --- segments -------------------------------------------------------------------------

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

        Each has id, voxels, volume [mm³], bounds, touchable, pending, range, made_by, feel, pose,
        and grid: ``patient_from_grid`` by rows where it has a grid of its own, to which bounds
        belong then.
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

    # --- tools ----------------------------------------------------------------------------

    def set_tool(
        self,
        kind: Literal["eraser", "adder", "drill", "needle", "painter"] | None,
        *,
        radius: float = 1.0,
        segment_ids: Sequence[int] = (),
        tissues: Sequence[Tissue] = (),
        depth: float | None = None,
        overlaps: bool = False,
    ) -> None:
        """Chooses the tool for the next strokes; a stroke that is on ends.

        The eraser frees voxels of the segments along the probe's way, the adder makes them
        solid, the drill removes matter by the work that touch does on it. Where the scan's unit
        is not HU, the drill takes the same work for each mm³, that of cortical bone, and leaves
        the scan's lowest value behind. The needle changes nothing: it goes into the segments, and
        they are no obstacle for it until it is out. The painter gives what is touched of the
        segments to the first of them; what is solid stays so.

        Args:
            kind: Which tool; None empties the hand.
            radius: Of the tool's ball [mm].
            segment_ids: Segments that it may change, or go into.
            tissues: What each of them is for the needle.
            depth: How deep below the surface the painter paints [mm]; None is all of its ball.
            overlaps: Whether what is painted stays in the segments that have it, too.

        Raises:
            OptionError: Radius or depth do not fit the voxels, or there is no such segment.
        """
        with given():
            if kind is None:
                self._internal.set_tool(None)
                return
            volume = self.scene.volume
            is_density = volume.unit == "HU"
            self._internal.set_tool(
                kind,
                radius=radius,
                segment_ids=list(segment_ids),
                air=AIR if is_density else volume.range[0],
                energy=None if is_density else CORTICAL_ENERGY,
                tissues=[astuple(tissue) for tissue in tissues],
                paint=(depth, overlaps),
            )

    def needle_events(self) -> list[NeedleEvent]:
        """Returns what happened to the needle since it was taken in the hand, oldest first."""
        with given():
            return [NeedleEvent(*event) for event in self._internal.needle_events()]

    def withdraw_needle(self) -> bool:
        """Takes the needle out on the way that it went in; returns whether one was in.

        Raises:
            OptionError: There is no free voxel near where it went in.
        """
        with given():
            return self._internal.withdraw_needle()

    def stroke(self, *, on: bool) -> None:
        """Begins a stroke of the chosen tool, or ends it: it is one step of undo.

        Raises:
            OptionError: It is to begin, and no tool is chosen.
        """
        with given():
            self._internal.stroke(on)

    # --- the journal ----------------------------------------------------------------------

    def look_at_journal(self, path: Path, scan_hash: bytes) -> tuple[int, int] | None:
        """Counts the steps of a journal and the bytes at its end that are lost.

        Returns:
            Both, or None where there is no such file.

        Raises:
            OptionError: The file is no journal of this scan.
            OSError: The disk refuses it, or another session writes it (BlockingIOError).
        """
        with given():
            return self._internal.look_at_journal(path, scan_hash)

    def begin_journal(self, path: Path, scan_hash: bytes) -> None:
        """Writes every change to a new file from now on, after what is there now.

        Raises:
            OSError: The file exists already, or the disk refuses it.
        """
        with given():
            self._internal.begin_journal(path, scan_hash)

    def keep_state(self, path: Path, scan_hash: bytes) -> None:
        """Writes what is there now into a new file, as a journal without steps.

        Raises:
            OptionError: The file exists already, or the disk says no.
        """
        with given():
            self._internal.keep_state(path, scan_hash)

    def recover_journal(self, path: Path, scan_hash: bytes) -> tuple[int, int, list[bytes]]:
        """Does again what a journal says, step by step, and goes on with that file.

        Returns:
            Steps, bytes at the end that are lost, and notes, oldest first.

        Raises:
            OptionError: A record cannot be; what came before it is there then.
            OSError: The disk refuses it, or another session writes it (BlockingIOError).
        """
        with given():
            return self._internal.recover_journal(path, scan_hash)

    def end_journal(self) -> None:
        """Writes what waits and closes the journal."""
        with given():
            self._internal.end_journal()

    def note_in_journal(self, note: bytes) -> None:
        """Keeps bytes beside the voxels, where there is a journal."""
        self._internal.note_in_journal(note)

    # --- the picture ----------------------------------------------------------------------

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

    def undo(self) -> bool:
        """Takes the last edit back; says whether there was one."""
        with self._keeping_regions():
            return self._groups.undo(self._internal.undo)

    def redo(self) -> bool:
        """Applies the last undone edit again; says whether there was one."""
        with self._keeping_regions():
            return self._groups.redo(self._internal.redo)

    def group_steps(self, segment_id: int, counts: Sequence[int]) -> None:
        """Has ``undo`` and ``redo`` take edits of a segment as one.

        Args:
            segment_id: Which segment.
            counts: How many voxels it had before the first of these edits, and after each; each
                only adds voxels, or only takes some away.
        """
        self._groups.add(StepGroup(segment_id, tuple(counts)))

    def _voxel_count(self, segment_id: int) -> int | None:
        try:
            return self._internal.segment(segment_id).voxel_count
        except ValueError:
            return None

    # --- what happens ---------------------------------------------------------------------

    def frame(self) -> dict[str, Any]:
        """Returns what is now: the fields of ``protocol.State``, and notices."""
        return self._internal.frame()

    def lateness(self) -> dict[str, dict[str, Any]]:
        """Returns the pace of each thread since the start, with a histogram of lateness."""
        return self._internal.lateness()

    def start_recording(self) -> None:
        """Starts to keep every tick, and all that a replay needs.

        A recording that runs is thrown away. Where a change waits for the probe, it can be
        replayed from when touch follows that change.
        """
        self._about = self._describe()
        self._internal.start_recording()

    def stop_recording(self) -> Recording:
        """Returns the ticks kept since ``start_recording``; it may be called after ``stop``."""
        ticks, tape = self._internal.stop_recording()
        return Recording(ticks, tape=tape, about=self._about)

    def let_pass(self, seconds: float) -> None:
        """Lets time pass; without ``real_time`` the ticks are computed at once."""
        if self.options.real_time:
            time.sleep(seconds)
        else:
            with given():
                self._internal.run(seconds)

    def run(self, seconds: float) -> Recording:
        """Lets time pass and returns every tick of it.

        Without ``real_time`` the ticks are computed at once, and the same session gives the
        same numbers every time.
        """
        self.start_recording()
        self.let_pass(seconds)
        return self.stop_recording()

    def _describe(self) -> About:
        """Says what a recording that begins now comes from."""
        volume = self.scene.volume
        names = {
            segment_id: shown.name for segment_id, shown in zip(self.ids, self.scene, strict=True)
        }
        segments = [
            AboutSegment(
                id=state["id"],
                name=names.get(state["id"], f"segment {state['id']}"),
                touchable=state["touchable"],
                voxels=state["voxels"],
                range=state["range"],
            )
            for state in self.segments()
        ]
        return About(
            format=FORMAT,
            version=VERSION,
            palpate=package_version(),
            build=_core.build(),
            recorded=datetime.now(UTC).isoformat(timespec="seconds"),
            device=self.device,
            rate_hz=self.options.rate_hz,
            real_time=self.options.real_time,
            scan=AboutScan(
                name=volume.name,
                modality=volume.modality,
                unit=volume.unit,
                dimensions=volume.dimensions,
                spacing=volume.spacing,
                origin=volume.origin,
                direction=[float(cosine) for cosine in volume.direction.ravel()],
            ),
            segments=segments,
            settings=self.settings(),
        )


def _empty(
    dimensions: tuple[int, int, int],
    grid: tuple[tuple[float, float, float], tuple[float, float, float], list[float]],
) -> Volume:
    """Returns a scan of zeros on a grid: its spacing, origin, and direction by rows."""
    spacing, origin, direction = grid
    values = np.zeros(dimensions[::-1], np.int16)
    axes = np.reshape(direction, (3, 3))
    return Volume(values, spacing=spacing, origin=origin, direction=axes)
