"""A session at one moment, as ``_core.Session`` returns it: typed dictionaries.

Points are (x, y, z) in the scene, LPS [mm]; forces [N] in scene axes; times [s] since the session's
start. Segment number 0 means "none".
"""

from __future__ import annotations

from typing import Literal, TypedDict

from palpate.session.deformation_state import DeformationState
from palpate.session.segment_state import PoseState

__all__ = [
    "FrameState",
    "LatenessState",
    "NeedleState",
    "RateState",
    "RatesState",
    "SafetyState",
    "ThreadLateness",
    "ToolState",
]

Triple = tuple[float, float, float]


class ToolState(TypedDict):
    """The tool in use, and what its current or last stroke did."""

    kind: Literal["none", "eraser", "adder", "drill", "needle", "painter"]
    radius: float
    """[mm]."""
    on: bool
    """Whether a stroke is in progress."""
    voxels: int
    """Voxels changed."""
    volume: float
    """Volume changed [mm³]."""
    time: float
    """Time at work [s]."""
    energy: float
    """Work done [mJ]."""
    load: float
    """Power at this moment [mW]."""
    undo_bytes: int
    """Memory that undo and redo take."""
    undo_budget: int
    """Most memory that they may take [bytes]."""


class NeedleState(TypedDict):
    """A needle in use, or still inserted."""

    inside: bool
    depth: float
    """Distance of the tip from where it was inserted [mm]."""
    entry: Triple
    """Where it was inserted, scene [mm]; zeros outside."""
    direction: Triple
    """Its way inward, of length 1; zeros outside."""
    segment: int
    """Segment at the tip."""
    tip: float
    """Force at the tip [N]."""
    friction: float
    """Friction along the shaft [N]."""
    wall: float
    """Force of a rigid obstacle on the tip [N]."""
    events: int
    """Events so far; ``Session.needle_events`` lists them."""
    set_direction: Triple | None
    """Direction that was set, inward, of length 1; None for that of the push."""


class RateState(TypedDict):
    """How well a thread kept its rate in the last second."""

    asked_hz: float
    hz: float
    ticks: int
    """Since the session's start, as ``late``."""
    late: int
    """Ticks that began more than 2 ms late."""
    worst_late_ms: float


class RatesState(TypedDict):
    """Rates of all threads."""

    device: RateState
    servo: RateState
    simulation: RateState
    picture: RateState
    real_time: bool
    """Whether the system granted real-time priority."""


class SafetyState(TypedDict):
    """Ticks in which the safety stage intervened, since the session's start."""

    clamped: int
    slewed: int
    not_finite: int
    ramped: int
    waited: int
    eased: int
    damped: int
    watchdog: int
    violations: int
    """Ticks that violated a guarantee of touch."""
    force: Literal["on", "waiting", "ramping", "easing", "off"]
    off: Literal["not-started", "waiting", "servo-late", "stopped", "not-finite"] | None
    """Why no force is sent; None while one is."""


class FrameState(TypedDict):
    """A session at one moment: the fields of ``protocol.State``, and the last three beside them."""

    tick: int
    time: float
    edit: int
    """Number of the newest edit of voxels."""
    device: Triple
    hand: Triple
    proxy: Triple
    """Where the probe is."""
    contact_point: Triple
    normal: Triple
    force: Triple
    """Force sent to the device."""
    contact: bool
    depth: float
    """Distance of device and probe [mm]."""
    touched: int
    """Segment that the probe touches."""
    probe_radius: float
    """[mm]."""
    poses: list[PoseState]
    grabbed: int
    """Segment in the hand."""
    clutched: bool
    device_origin: Triple
    """Where the middle of the device's workspace is."""
    pending: int
    """Changes that touch does not follow yet."""
    can_undo: bool
    can_redo: bool
    step: int
    """Steps of undo that are done."""
    steps_made: int
    """Steps of undo made since the session's start."""
    tool: ToolState
    needle: NeedleState
    matter: DeformationState
    rates: RatesState
    safety: SafetyState
    recording: float | None
    """Length of the current recording [s]; None where there is none."""
    samples: list[tuple[float, float, float, float]]
    """Time and force (x, y, z) sent to the device since the frame before."""
    segments_version: int
    """Rises with each change of voxels or of the list of segments."""
    voxels_version: int
    """Rises with changes of voxels that ``picture_changes`` does not report."""
    notices: list[tuple[Literal["info", "warning", "error"], str]]
    """Messages for the user since the frame before."""


class ThreadLateness(RateState):
    """Punctuality of a thread since the session's start."""

    missed: int
    """Ticks left out."""
    worst_ever_ms: float
    lateness: list[int]
    """Ticks by lateness; those later than the last bin's end come last."""
    lateness_bins_us: list[int]
    """Upper ends of the bins [µs]."""


class LatenessState(TypedDict):
    """Punctuality of all threads."""

    device: ThreadLateness
    servo: ThreadLateness
    simulation: ThreadLateness
    picture: ThreadLateness
