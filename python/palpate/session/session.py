"""Touch: a scene, a device and the engine between them.

Frame: scene, LPS [mm]; forces [N] in scene axes; times [s] since the session's start.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from types import TracebackType
from typing import Any, Literal, Self

import numpy as np

from palpate import _core
from palpate.base.package_version import package_version
from palpate.session.journal import SessionJournal
from palpate.session.part import Point, given, triple
from palpate.session.picture import SessionPicture
from palpate.session.recording import Recording
from palpate.session.recording_file import FORMAT, VERSION, About, AboutScan, AboutSegment
from palpate.session.scripted_path import ScriptedPath
from palpate.session.segments import SessionSegments
from palpate.session.step_groups import StepGroup, StepGroups
from palpate.session.tools import SessionTools
from palpate.session.touch_settings import TouchSettings
from palpate.volumes.scene import Scene

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


class Session(SessionSegments, SessionTools, SessionPicture, SessionJournal):
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

    # --- undo -----------------------------------------------------------------------------

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
