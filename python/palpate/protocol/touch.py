"""Messages on touch: its settings, the hand, tools, and the state of threads and safety."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

from palpate.protocol.types import (
    ClipPlanes,
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
    "ChangeTouchClip",
    "Clutch",
    "DeviceLimits",
    "Hand",
    "HandLed",
    "Lift",
    "NeedleDirection",
    "NeedleEvent",
    "NeedleEvents",
    "NeedleState",
    "Place",
    "Press",
    "Rate",
    "Rates",
    "Safety",
    "Settings",
    "SettingsChanged",
    "Stroke",
    "Tool",
    "ToolState",
    "TouchClipChanged",
    "View",
    "WithdrawNeedle",
]


class Settings(msgspec.Struct, frozen=True):
    """Settings of touch; ``gain`` is scene mm per mm of the device."""

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
    """How well a thread kept its rate in the last second.

    ``late`` counts ticks since the start that began more than 2 ms late.
    """

    asked_hz: float
    hz: float
    ticks: int
    late: int
    worst_late_ms: float


class Rates(msgspec.Struct, frozen=True):
    """Rates of all threads; ``real_time`` says whether the system granted real-time priority."""

    device: Rate
    servo: Rate
    simulation: Rate
    picture: Rate
    real_time: bool


class Safety(msgspec.Struct, frozen=True):
    """Interventions of the safety stage, and violations of guarantees, since the start.

    ``force`` says how the contact force is passed on: "on" where it is unchanged; ``off`` says why
    no force is sent, null while one is.
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
    """The tool in use, and what its current or last stroke did.

    ``radius`` is that of its ball [mm]; ``voxels`` and ``volume`` [mm³] are what it changed,
    ``time`` its time at work [s], ``energy`` its work [mJ], ``load`` its current power [mW]. Undo
    and redo take ``undo_bytes``, at most ``undo_budget``.
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
    """A needle that is in use or still inserted.

    ``depth`` is the distance of its tip from the point of entry [mm], ``entry`` that point in the
    scene [mm] and ``direction`` the way inward, of length 1 (both zeros where it is out);
    ``segment`` is the one at the tip, 0 for none. ``tip`` and ``friction`` are the forces at tip
    and shaft, ``wall`` that of a rigid obstacle [N]. ``events`` is the number of ``NeedleEvents``.
    ``set_direction`` is the one that was set, inward, of length 1; null for that of the push.
    """

    inside: bool
    depth: float
    entry: Vector
    direction: Vector
    segment: int
    tip: float
    friction: float
    wall: float
    events: int
    set_direction: Vector | None


class DeviceLimits(msgspec.Struct, frozen=True):
    """Limits of a device; larger settings are reduced to them.

    ``reach`` is the radius of its workspace [device mm].
    """

    stiffness: Stiffness
    force: float
    reach: float


class NeedleEvent(msgspec.Struct, frozen=True):
    """An event of a needle at a time [s], in a segment, 0 for none.

    ``depth`` is the distance from the point of entry [mm], ``force`` that at its tip [N].
    """

    kind: NeedleEventKind
    segment: int
    time: float
    depth: float
    force: float


class NeedleEvents(Message, frozen=True, tag="needle_events"):
    """Events of the needle since it was chosen, oldest first; only the newest 100."""

    events: list[NeedleEvent]


class SettingsChanged(Message, frozen=True, tag="settings_changed"):
    """The settings in effect."""

    settings: Settings


class TouchClipChanged(Message, frozen=True, tag="touch_clip_changed"):
    """The planes that cut the scene for touch, as ``ChangeTouchClip`` has them."""

    planes: ClipPlanes


class HandLed(Message, frozen=True, tag="hand_led"):
    """Which other page moves the hand: when it was opened (ISO 8601); null where none does."""

    opened: str | None


class Hand(Message, frozen=True, tag="hand"):
    """Target to which the hand pulls the device [scene]; latest wins."""

    target: Vector


class Press(Message, frozen=True, tag="press"):
    """Presses on what a ray of the scene meets first, with a force [N]; latest wins.

    The hand brings the probe there, pushes, and follows the next press along the surface.
    """

    origin: Vector
    direction: Vector
    pressure: Annotated[float, msgspec.Meta(gt=0.0, le=5.0)]


class Lift(Message, frozen=True, tag="lift"):
    """Lifts the hand off what this page presses."""


class Place(Message, frozen=True, tag="place"):
    """Moves probe, device and hand to a point, or to the nearest free voxel."""

    point: Vector


class View(Message, frozen=True, tag="view"):
    """Axes of the view in the scene, with which those of the device are aligned (thesis 4.7)."""

    right: Vector
    up: Vector


class Clutch(Message, frozen=True, tag="clutch"):
    """Decouples the device from the probe, or couples them again."""

    on: bool


class ChangeSettings(Message, frozen=True, tag="change_settings"):
    """Requests new settings."""

    settings: Settings


class ChangeTouchClip(Message, frozen=True, tag="change_touch_clip"):
    """Cuts the scene for touch at planes; what lies before one is not felt, nor changed by tools.

    Each is a unit normal toward what is cut away, and ``normal · point`` of its points [mm].
    """

    planes: ClipPlanes


class Tool(Message, frozen=True, tag="tool"):
    """Chooses the tool for the next strokes: the radius of its ball [mm], and what it changes.

    The radius of a needle is its own, and ``tissues`` are those of its segments. A painter adds the
    touched voxels of segments to the first of them, to ``depth`` below the surface [mm], or in its
    whole ball; where it ``overlaps``, painted voxels also stay in their segment.
    """

    kind: ToolKind
    radius: Annotated[float, msgspec.Meta(gt=0.0, le=50.0)]
    segments: list[SegmentId]
    tissues: list[TissueName] = msgspec.field(default_factory=list)
    depth: Annotated[float, msgspec.Meta(gt=0.0, le=50.0)] | None = None
    overlaps: bool = False


class NeedleDirection(Message, frozen=True, tag="needle_direction"):
    """Sets the direction in which the needle enters, inward; null for that of the push."""

    direction: Vector | None


class WithdrawNeedle(Message, frozen=True, tag="withdraw_needle"):
    """Withdraws the needle along the path of its insertion."""


class Stroke(Message, frozen=True, tag="stroke"):
    """Begins or ends a stroke of the tool; a stroke is one step of undo."""

    on: bool
