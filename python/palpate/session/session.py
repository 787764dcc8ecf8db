"""Touch: a scene, a device and the engine between them.

Frame: scene, LPS [mm]; forces [N] in scene axes; times [s] since the session's start.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from types import TracebackType
from typing import Literal, Self

import numpy as np

from palpate.session.engine import Engine, option_errors
from palpate.session.felt import FeltSegments, TouchWish
from palpate.session.frame_state import FrameState, LatenessState
from palpate.session.history import SessionHistory
from palpate.session.journal import SessionJournal
from palpate.session.known_steps import KnownSteps
from palpate.session.part_method import PartMethod
from palpate.session.picture import SessionPicture
from palpate.session.probe import SessionProbe
from palpate.session.recorder import SessionRecorder
from palpate.session.regions import Regions
from palpate.session.scripted_path import ScriptedPath
from palpate.session.segments import SessionSegments
from palpate.session.soft_tissue import SessionSoftTissue
from palpate.session.steps import SessionSteps
from palpate.session.tools import SessionTools
from palpate.session.touch_settings import TouchSettings
from palpate.volumes.scene import Scene, require_scene

__all__ = ["Session", "SessionOptions"]


@dataclass(frozen=True, kw_only=True)
class SessionOptions:
    """Options of a session; None is the engine's default."""

    rate_hz: int = 1000
    """Rate of the servo loop [Hz], 500 to 10000."""
    device_rate_hz: int | None = None
    """Rate at which the device is read [Hz], 500 to 10000; None is the rate of the servo loop."""
    real_time: bool = True
    """Whether the session runs in real time; else time stands still except in ``run`` and
    ``let_pass``."""
    start: tuple[float, float, float] | None = None
    """Start of the device [scene, mm]; None is in front of the scan."""
    touch: TouchSettings = field(default_factory=TouchSettings)
    """Settings of touch."""


class Session:
    """A running session of touch.

    Use it in a ``with`` block: leaving the block stops the session and the force. Segments are
    known by their number, 1 to 255, in the order in which they were added.
    """

    scene: Scene
    """The scan and its segments at the start."""
    ids: list[int]
    """Numbers of these segments."""
    options: SessionOptions
    """How the session runs."""
    device: Literal["simulated", "scripted"]
    """What moves the probe."""

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
            OptionError: An option is out of range, or there is no scene.
        """
        require_scene(scene)
        self.scene = scene
        self.ids = list(range(1, len(scene) + 1))
        self.options = options or SessionOptions()
        self.device = "scripted" if isinstance(device, ScriptedPath) else device
        path = np.ascontiguousarray(device.rows) if isinstance(device, ScriptedPath) else None
        with option_errors():
            engine = Engine(
                scene.volume._internal,  # noqa: SLF001  # only this class and its kin unwrap it
                device=self.device,
                path=path,
                rate_hz=self.options.rate_hz,
                device_rate_hz=self.options.device_rate_hz,
                real_time=self.options.real_time,
                start=self.options.start,
                settings=asdict(self.options.touch),
                segments=[
                    (one.segment._internal, TouchWish.of(one).is_felt, one.segment.range)  # noqa: SLF001
                    for one in scene
                ],
            )
        regions = Regions(engine)
        felt = FeltSegments(engine, scene)
        known = KnownSteps(engine)
        self._engine = engine
        self._probe = SessionProbe(engine)
        self._segments = SessionSegments(engine, scene, (regions, felt, known))
        self._steps = SessionSteps(engine, self._segments, known)
        self._soft_tissue = SessionSoftTissue(engine, regions, unit=scene.volume.unit)
        self._tools = SessionTools(engine, scene.volume)
        self._history = SessionHistory(engine, (regions, felt, known))
        self._picture = SessionPicture(engine)
        self._journal = SessionJournal(engine, felt, self._history.groups)
        self._recorder = SessionRecorder(
            engine, scene, rate_hz=self.options.rate_hz, real_time=self.options.real_time
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.stop()

    # --- the session itself ---------------------------------------------------------------

    def stop(self) -> None:
        """Stops the force and the threads; a second call does nothing."""
        self._engine.stop()

    @property
    def is_running(self) -> bool:
        """Whether the session runs: false once it was stopped, or has ended with an error."""
        return self._engine.is_running

    @property
    def device_limits(self) -> tuple[float, float]:
        """Largest stiffness [N/mm] and force [N] that the device allows."""
        return self._engine.device_limits

    @property
    def device_reach(self) -> float:
        """Radius of the device's workspace [mm of the device]."""
        return self._engine.device_reach

    def frame(self) -> FrameState:
        """Returns the current state: the fields of ``protocol.State``, and notices."""
        return self._engine.frame()

    def lateness(self) -> LatenessState:
        """Returns how punctual each thread has been since the start, with a histogram."""
        return self._engine.lateness()

    # Each of the following groups is done by one part of the session, which documents it.

    # --- probe ----------------------------------------------------------------------------

    hand = PartMethod("_probe", SessionProbe.hand)
    press = PartMethod("_probe", SessionProbe.press)
    lift = PartMethod("_probe", SessionProbe.lift)
    place = PartMethod("_probe", SessionProbe.place)
    view = PartMethod("_probe", SessionProbe.view)
    settings = PartMethod("_probe", SessionProbe.settings)
    set_clip = PartMethod("_probe", SessionProbe.set_clip)
    clip = PartMethod("_probe", SessionProbe.clip)
    clutch = PartMethod("_probe", SessionProbe.clutch)

    @property
    def label_numbers(self) -> dict[int, int]:
        """Labels of segments in the files that they were read from, by the segments' ids."""
        return self._segments.numbers

    # --- segments -------------------------------------------------------------------------

    add_segment = PartMethod("_segments", SessionSegments.add_segment)

    replace_segment = PartMethod("_segments", SessionSegments.replace_segment)
    remove_segment = PartMethod("_segments", SessionSegments.remove_segment)
    remove_from_scan = PartMethod("_segments", SessionSegments.remove_from_scan)
    threshold = PartMethod("_segments", SessionSegments.threshold)
    segment = PartMethod("_segments", SessionSegments.segment)
    segments = PartMethod("_segments", SessionSegments.segments)
    scene_now = PartMethod("_segments", SessionSegments.scene_now)
    set_touchable = PartMethod("_segments", SessionSegments.set_touchable)
    show_segments = PartMethod("_segments", SessionSegments.show_segments)
    set_locked = PartMethod("_segments", SessionSegments.set_locked)
    set_feel = PartMethod("_segments", SessionSegments.set_feel)
    move_segment = PartMethod("_segments", SessionSegments.move_segment)
    grab = PartMethod("_segments", SessionSegments.grab)
    turn_grabbed = PartMethod("_segments", SessionSegments.turn_grabbed)
    cut = PartMethod("_segments", SessionSegments.cut)
    cut_along = PartMethod("_segments", SessionSegments.cut_along)
    preview_cut = PartMethod("_segments", SessionSegments.preview_cut)
    gap = PartMethod("_segments", SessionSegments.gap)
    fill_box = PartMethod("_segments", SessionSegments.fill_box)

    # --- steps of segments ----------------------------------------------------------------

    steps = PartMethod("_steps", SessionSteps.steps)
    listed = PartMethod("_steps", SessionSteps.listed)
    change_shape = PartMethod("_steps", SessionSteps.change_shape)
    set_steps = PartMethod("_steps", SessionSteps.set_steps)
    set_threshold = PartMethod("_steps", SessionSteps.set_threshold)
    kept_steps = PartMethod("_steps", SessionSteps.kept_steps)
    restore_steps = PartMethod("_steps", SessionSteps.restore_steps)

    # --- soft tissue ----------------------------------------------------------------------

    set_material = PartMethod("_soft_tissue", SessionSoftTissue.set_material)
    set_regions = PartMethod("_soft_tissue", SessionSoftTissue.set_regions)
    regions = PartMethod("_soft_tissue", SessionSoftTissue.regions)
    set_deformation = PartMethod("_soft_tissue", SessionSoftTissue.set_deformation)
    set_force_source = PartMethod("_soft_tissue", SessionSoftTissue.set_force_source)
    deformation = PartMethod("_soft_tissue", SessionSoftTissue.deformation)
    show_model_parts = PartMethod("_soft_tissue", SessionSoftTissue.show_model_parts)
    model_parts = PartMethod("_soft_tissue", SessionSoftTissue.model_parts)

    # --- tools ----------------------------------------------------------------------------

    set_tool = PartMethod("_tools", SessionTools.set_tool)
    stroke = PartMethod("_tools", SessionTools.stroke)
    needle_events = PartMethod("_tools", SessionTools.needle_events)
    set_needle_direction = PartMethod("_tools", SessionTools.set_needle_direction)
    withdraw_needle = PartMethod("_tools", SessionTools.withdraw_needle)

    # --- undo -----------------------------------------------------------------------------

    undo = PartMethod("_history", SessionHistory.undo)
    redo = PartMethod("_history", SessionHistory.redo)
    group_steps = PartMethod("_history", SessionHistory.group_steps)

    # --- the picture ----------------------------------------------------------------------

    show_surface = PartMethod("_picture", SessionPicture.show_surface)
    hide_surface = PartMethod("_picture", SessionPicture.hide_surface)
    follow_edits = PartMethod("_picture", SessionPicture.follow_edits)
    set_labelled = PartMethod("_picture", SessionPicture.set_labelled)
    wait_for_changes = PartMethod("_picture", SessionPicture.wait_for_changes)
    picture_changes = PartMethod("_picture", SessionPicture.picture_changes)
    whole_surfaces = PartMethod("_picture", SessionPicture.whole_surfaces)

    # --- time and recordings --------------------------------------------------------------

    let_pass = PartMethod("_recorder", SessionRecorder.let_pass)
    run = PartMethod("_recorder", SessionRecorder.run)
    start_recording = PartMethod("_recorder", SessionRecorder.start_recording)
    stop_recording = PartMethod("_recorder", SessionRecorder.stop_recording)

    # --- the journal ----------------------------------------------------------------------

    begin_journal = PartMethod("_journal", SessionJournal.begin_journal)
    end_journal = PartMethod("_journal", SessionJournal.end_journal)
    note_in_journal = PartMethod("_journal", SessionJournal.note_in_journal)
    keep_state = PartMethod("_journal", SessionJournal.keep_state)
    look_at_journal = PartMethod("_journal", SessionJournal.look_at_journal)
    recover_journal = PartMethod("_journal", SessionJournal.recover_journal)
