"""Messages on touch: its settings, the hand, tools, and how threads and safety are."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

from palpate.protocol.types import (
    Friction,
    Message,
    NeedleEventKind,
    SegmentId,
    Stiffness,
    TissueName,
    ToolKind,
    Vector,
)

__all__ = [
    "ChangeSettings",
    "Clutch",
    "DeviceLimits",
    "Hand",
    "NeedleEvent",
    "NeedleEvents",
    "NeedleState",
    "Place",
    "Rate",
    "Rates",
    "Safety",
    "Settings",
    "SettingsChanged",
    "Stroke",
    "Tool",
    "ToolState",
    "View",
    "WithdrawNeedle",
]


class Settings(msgspec.Struct, frozen=True):
    """What a person can set about touch; ``gain`` is scene mm per mm of the device."""

    model: Literal["exact", "thesis-original", "thesis-improved"]
    stiffness: Stiffness
    damping: Annotated[float, msgspec.Meta(ge=0.0, le=0.1)]
    friction_static: Friction
    friction_kinetic: Friction
    smoothing: Literal["intensities", "bits", "off"]
    probe_radius: Annotated[float, msgspec.Meta(ge=0.0, le=20.0)]
    force_limit: Annotated[float, msgspec.Meta(gt=0.0, le=40.0)]
    gain: Annotated[float, msgspec.Meta(ge=0.1, le=10.0)]


class Rate(msgspec.Struct, frozen=True):
    """How a thread keeps its pace over the last second.

    ``late`` counts ticks since the start that began more than 2 ms after their time.
    """

    asked_hz: float
    hz: float
    ticks: int
    late: int
    worst_late_ms: float


class Rates(msgspec.Struct, frozen=True):
    """One rate per thread; ``real_time`` says whether the priority was granted."""

    device: Rate
    servo: Rate
    simulation: Rate
    picture: Rate
    real_time: bool


class Safety(msgspec.Struct, frozen=True):
    """Interventions of the safety stage and violations of the guarantees since start.

    ``force`` says what stands between the contact and the hand now: "on" where nothing does;
    ``off`` why no force is sent, and nothing while forces are.
    """

    clamped: int
    slewed: int
    not_finite: int
    ramped: int
    waited: int
    eased: int
    damped: int
    watchdog: int
    violations: int
    force: Literal["on", "waiting", "ramping", "easing", "off"]
    off: Literal["not-started", "waiting", "servo-late", "stopped", "not-finite"] | None


class ToolState(msgspec.Struct, frozen=True):
    """The tool in the hand, and what it did in the stroke that is on, or in the last one.

    ``radius`` is that of its ball [mm]; ``voxels`` and ``volume`` [mm³] are what it changed,
    ``time`` how long it was at work [s], ``energy`` the work done on matter [mJ], ``load`` the
    power of this moment [mW]. Undo and redo hold on to ``undo_bytes``, at most ``undo_budget``.
    """

    kind: ToolKind
    radius: float
    on: bool
    voxels: int
    volume: float
    time: float
    energy: float
    load: float
    undo_bytes: int
    undo_budget: int


class NeedleState(msgspec.Struct, frozen=True):
    """A needle, where it is the tool in the hand or still in.

    ``depth`` is how far its tip is from where it went in [mm], ``segment`` the one at the tip, 0
    for none. ``tip`` and ``friction`` are the forces at tip and shaft, ``wall`` that of what no
    needle punctures [N]. ``events`` counts what ``NeedleEvents`` tells.
    """

    inside: bool
    depth: float
    segment: int
    tip: float
    friction: float
    wall: float
    events: int


class DeviceLimits(msgspec.Struct, frozen=True):
    """What a device bears: settings that ask for more are cut to it.

    ``reach`` is how far it comes from the middle of its workspace [device mm].
    """

    stiffness: Stiffness
    force: float
    reach: float


class NeedleEvent(msgspec.Struct, frozen=True):
    """What happened to a needle at a time [s], in a segment, 0 for none.

    ``depth`` is from where it went in [mm], ``force`` that at its tip [N].
    """

    kind: NeedleEventKind
    segment: int
    time: float
    depth: float
    force: float


class NeedleEvents(Message, frozen=True, tag="needle_events"):
    """What happened to the needle since it was taken in the hand, oldest first, the newest 100."""

    events: list[NeedleEvent]


class SettingsChanged(Message, frozen=True, tag="settings_changed"):
    """The settings as the engine holds them."""

    settings: Settings


class Hand(Message, frozen=True, tag="hand"):
    """Where the hand pulls the device to [scene]; latest wins."""

    target: Vector


class Place(Message, frozen=True, tag="place"):
    """Puts probe, device and hand at a point, or at the free voxel next to it."""

    point: Vector


class View(Message, frozen=True, tag="view"):
    """Axes of the view in the scene: the movement frame follows them (thesis 4.7)."""

    right: Vector
    up: Vector


class Clutch(Message, frozen=True, tag="clutch"):
    """Has the device move without the probe, or with it again."""

    on: bool


class ChangeSettings(Message, frozen=True, tag="change_settings"):
    """Asks for new settings."""

    settings: Settings


class Tool(Message, frozen=True, tag="tool"):
    """Chooses the tool for the next strokes: the radius of its ball [mm], and what it changes.

    Of a needle the radius is its own, and ``tissues`` say what each of its segments is. A painter
    gives what is touched of the segments to the first of them, so ``depth`` below the surface [mm],
    or in all of its ball; what is painted stays in its segment, too, where it ``overlaps``.
    """

    kind: ToolKind
    radius: Annotated[float, msgspec.Meta(gt=0.0, le=50.0)]
    segments: list[SegmentId]
    tissues: list[TissueName] = msgspec.field(default_factory=list)
    depth: Annotated[float, msgspec.Meta(gt=0.0, le=50.0)] | None = None
    overlaps: bool = False


class WithdrawNeedle(Message, frozen=True, tag="withdraw_needle"):
    """Takes the needle out on the way that it went in."""


class Stroke(Message, frozen=True, tag="stroke"):
    """Begins a stroke of the tool, or ends it: what it changed is one step of undo."""

    on: bool
