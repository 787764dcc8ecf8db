"""Time in a session, and recordings of it."""

from __future__ import annotations

import time
from datetime import UTC, datetime

from palpate import _core
from palpate.base.package_version import package_version
from palpate.session.engine import Engine, option_errors
from palpate.session.recording import Recording
from palpate.session.recording_file import FORMAT, VERSION, About, AboutScan, AboutSegment
from palpate.volumes.scene import Scene

__all__ = ["SessionRecorder"]


class SessionRecorder:
    """Lets time pass in a session, and records it."""

    def __init__(self, engine: Engine, scene: Scene, *, rate_hz: int, real_time: bool) -> None:
        """Takes the engine, the scene at the start, and how the session runs."""
        self._engine = engine
        self._volume = scene.volume
        self._names = {number: shown.name for number, shown in enumerate(scene, start=1)}
        self._rate_hz = rate_hz
        self._real_time = real_time
        self._about: About | None = None

    def start_recording(self) -> None:
        """Starts to record every tick, and what a replay needs.

        A recording in progress is discarded. While a change waits for the probe, the recording
        cannot be replayed yet; it can from the tick on in which touch follows that change.
        """
        self._about = self._describe()
        self._engine.start_recording()

    def stop_recording(self) -> Recording:
        """Returns the ticks since ``start_recording``; it may be called after ``stop``."""
        ticks, tape = self._engine.stop_recording()
        return Recording(ticks, tape=tape, about=self._about)

    def let_pass(self, seconds: float) -> None:
        """Lets time pass.

        Without ``real_time`` the ticks are computed at once, else this waits.

        Args:
            seconds: How long [s].
        """
        if self._real_time:
            time.sleep(seconds)
        else:
            with option_errors():
                self._engine.run(seconds)

    def run(self, seconds: float) -> Recording:
        """Lets time pass as ``let_pass`` does, and returns a recording of it.

        Without ``real_time`` the same session gives the same numbers every time.

        Args:
            seconds: How long [s].
        """
        self.start_recording()
        self.let_pass(seconds)
        return self.stop_recording()

    def _describe(self) -> About:
        """Describes what a recording that begins now is made of."""
        volume = self._volume
        segments = [
            AboutSegment(
                id=state["id"],
                name=self._names.get(state["id"], f"segment {state['id']}"),
                touchable=state["touchable"],
                voxels=state["voxels"],
                range=state["range"],
            )
            for state in self._engine.segments_state()
        ]
        return About(
            format=FORMAT,
            version=VERSION,
            palpate=package_version(),
            build=_core.build(),
            recorded=datetime.now(UTC).isoformat(timespec="seconds"),
            device=self._engine.device,
            rate_hz=self._rate_hz,
            real_time=self._real_time,
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
            settings=dict(self._engine.settings()),
        )
