"""What each benchmark reports, and the goals: the one table that reports and tests read.

Goals are those of the design's section 8 and of the issues that asked for a benchmark. A row
without a goal is reported for orientation.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

__all__ = [
    "DEFAULT_STIFFNESS",
    "FLAT_WALL",
    "GOALS",
    "RATES_KHZ",
    "STROKES",
    "TOUCHES",
    "WALLS",
    "Goal",
    "Touch",
]


@dataclass(frozen=True)
class Goal:
    """A figure that a benchmark reports."""

    case: str
    """What was done."""
    metric: str
    """What was measured of it."""
    key: str
    """Where the engine's report has it."""
    scale: float
    """Reported figure per unit of the engine's."""
    unit: str
    goal: float | None
    better: Literal["higher", "lower"]


def _times(case: str, *, tail: float | None = None) -> tuple[Goal, ...]:
    """Returns the times of single calls: their middle and their tail."""
    return (
        Goal(case, "median", "median_ns", 1e-3, "µs", None, "lower"),
        Goal(case, "p99", "p99_ns", 1e-3, "µs", None, "lower"),
        Goal(case, "p99.9", "p999_ns", 1e-3, "µs", tail, "lower"),
        Goal(case, "max", "max_ns", 1e-3, "µs", None, "lower"),
    )


def _rate(case: str, least: float | None) -> Goal:
    return Goal(case, "rate", "per_second", 1e-6, "M/s", least, "higher")


def _contact(case: str, least: float | None = 95.0) -> Goal:
    return Goal(case, "in contact", "contact_share", 100.0, "%", least, "higher")


def _baseline(case: str) -> tuple[Goal, ...]:
    """Returns what is told of a model that others are compared with."""
    return (_rate(case, None), *_times(case), _contact(case, None))


DETECTION = "detection only"
PROXY = "hard proxy"
ORIGINAL = "hard proxy, thesis-original"
IMPROVED = "hard proxy, thesis-improved"
TICK = "complete tick"

RANDOM = "random moves"

RATIO = "ratio_to_thesis_improved"
"""Key of calls per second by those of ``thesis-improved`` in the same run."""

Touch = Literal["exact", "stairs", "thesis-original", "thesis-improved"]

TOUCHES: tuple[Touch, ...] = ("exact", "stairs", "thesis-original", "thesis-improved")
"""Ways of touch: ``exact``, the same unsmoothed, and the thesis' models."""

CUBES = "cubes"
SLICES = "0.7×0.7×2.5"
GRIDS = (CUBES, SLICES)

STROKES = ((2.0, 0.2), (5.0, 0.2), (2.0, 0.05), (5.0, 1.0))
"""Depth of the device and its way per update, both in h."""

FLAT = ("plane below 10°", "plane")
BODIES = (
    *FLAT,
    *("sphere", "torus", "cylinder", "bore", "ramp", "step up", "step down", "wedge"),
    *("shell of 1", "shell of 2", "shell of 3"),
)
TOLD_WELL = ("plane", "sphere", "torus")
"""Bodies on which the force has a goal of direction and magnitude."""
NEVER_STUCK = (*FLAT, "sphere", "cylinder", "wedge", "shell of 1", "shell of 2", "shell of 3")
"""Convex and flat bodies."""

DIRECTION = {CUBES: (3.0, 8.0), SLICES: (6.0, 12.0)}
"""Largest error of direction, mean and 95 % [°]."""
MAGNITUDE = {5.0: 5.0, 2.0: 10.0}
"""Largest error of magnitude [%] at a depth [h]."""
LAG = {"plane below 10°": 0.5, "plane": 0.5, "sphere": 0.5, "torus": 1.5}
"""Largest lag of the force point [h]."""


def quality_case(touch: Touch, body: str, grid: str, *, stroke: tuple[float, float]) -> str:
    """Returns the name of a case of touch-quality."""
    depth, step = stroke
    return f"{touch}: {body}, {grid}, {depth:g} h deep, {step:g} h a move"


def _quality(
    touch: Touch, body: str, grid: str, *, stroke: tuple[float, float]
) -> tuple[Goal, ...]:
    """Returns what is told of a body; only ``exact`` has goals."""
    depth, _ = stroke
    case = quality_case(touch, body, grid, stroke=stroke)

    told_well = body in TOLD_WELL
    mean, most = DIRECTION[grid] if told_well else (None, None)
    rows = (
        ("direction mean", "direction_mean", "°", mean),
        ("direction 95 %", "direction_95", "°", most),
        ("magnitude RMSE", "magnitude_rmse", "%", MAGNITUDE[depth] if told_well else None),
        ("ripple", "ripple", "h", 0.05 if body in FLAT else None),
        ("lag 95 %", "force_lag_95", "h", None),
        ("lag", "force_lag_max", "h", LAG.get(body)),
        ("proxy lag 95 %", "proxy_lag_95", "h", None),
        ("proxy lag", "proxy_lag_max", "h", None),
        ("jitter", "jitter", "h", 0.0),
        ("pop-throughs", "pop_throughs", "1", 0.0),
        ("solid samples", "solid_share", "%", 0.0),
        ("stuck", "stuck", "updates", 0.0 if body in NEVER_STUCK else None),
        ("force step", "force_step", "h", 0.1),
        ("in contact", "contact_share", "%", 95.0),
    )
    return tuple(
        Goal(
            case,
            metric,
            key,
            100.0 if unit == "%" else 1.0,
            unit,
            goal if touch == "exact" else None,
            "higher" if metric == "in contact" else "lower",
        )
        for metric, key, unit, goal in rows
    )


RATES = (1000, 2000, 4000)
"""Rates of the servo [Hz]."""
LOADS = (False, True)
"""Whether all cores are busy besides."""


def servo_case(rate: int, load: bool) -> str:  # noqa: FBT001  # a pair
    """Returns the name of a case of the servo."""
    return f"{rate / 1000:g} kHz, {'all cores busy' if load else 'at rest'}"


def _servo(case: str, *, late: float | None) -> tuple[Goal, ...]:
    """Returns what is told of the servo; only 1 kHz has a goal."""
    return (
        Goal(case, "median", "p50_ms", 1e3, "µs", None, "lower"),
        Goal(case, "p99", "p99_ms", 1e3, "µs", None, "lower"),
        Goal(case, "p99.9", "p999_ms", 1e3, "µs", None, "lower"),
        Goal(case, "max", "max_ms", 1e3, "µs", None, "lower"),
        Goal(case, "more than 2 ms late", "late_share", 100.0, "%", late, "lower"),
        Goal(case, "fell out", "missed_share", 100.0, "%", None, "lower"),
    )


FLAT_WALL = "flat wall"
BONE = "bone"
WALLS = (FLAT_WALL, BONE)
RATES_KHZ = (1, 2, 4)
"""Rates of device and servo [kHz]."""

DEFAULT_STIFFNESS = {
    "simulated": 1.0,
    "Touch": 0.4,
    "Omni": 0.7,
    "Desktop": 1.0,
    "Premium 1.5": 0.8,
    "Premium 3.0": 1.0,
    "omega": 1.0,
    "sigma.7": 1.0,
    "lambda.7": 1.0,
    "delta.3": 1.0,
    "Falcon": 1.0,
}
"""What each device begins with [N/mm]: the default of touch, or what the device bears at most."""


def _passivity(device: str, rate_khz: int, wall: str) -> tuple[Goal, ...]:
    """Returns what is told of a device on a wall."""
    case = f"{device}, {rate_khz} kHz, {wall}"
    least = DEFAULT_STIFFNESS[device]
    return (
        Goal(case, "net energy to the hand", "to_hand", 1.0, "N·mm", 0.0, "lower"),
        Goal(case, "largest gain of a contact", "of_one_contact", 1.0, "N·mm", None, "lower"),
        Goal(case, "solid ticks", "violations", 1.0, "1", 0.0, "lower"),
        Goal(case, "in contact", "contact_share", 100.0, "%", None, "higher"),
        Goal(case, "taken back", "damped", 1.0, "ticks", None, "lower"),
        Goal(case, "stiffness", "stiffness", 1.0, "N/mm", None, "higher"),
        Goal(case, "largest passive", "largest_stiffness", 1.0, "N/mm", least, "higher"),
        Goal(case, "bound", "bound", 1.0, "N/mm", least, "higher"),
    )


GOALS: dict[str, tuple[Goal, ...]] = {
    "haptics": (
        _rate(DETECTION, 15.0),
        *_times(DETECTION),
        _rate(PROXY, 2.0),
        *_times(PROXY),
        _contact(PROXY),
        Goal(PROXY, "ratio to thesis-improved", RATIO, 1.0, "x", None, "higher"),
        *_baseline(ORIGINAL),
        *_baseline(IMPROVED),
        _rate(TICK, 1.0),
        *_times(TICK, tail=20.0),
        _contact(TICK),
    ),
    "touch-quality": tuple(
        goal
        for touch in TOUCHES
        for grid in GRIDS
        for stroke in STROKES
        for body in BODIES
        for goal in _quality(touch, body, grid, stroke=stroke)
    ),
    "passivity": tuple(
        goal
        for device in DEFAULT_STIFFNESS
        for wall in WALLS
        for rate in RATES_KHZ
        for goal in _passivity(device, rate, wall)
    ),
    "stress": (
        Goal(RANDOM, "violations", "violations", 1.0, "1", 0.0, "lower"),
        Goal(RANDOM, "moves", "moves", 1e-6, "M", None, "higher"),
        Goal(RANDOM, "in contact", "contact_share", 100.0, "%", None, "higher"),
        Goal(RANDOM, "edits", "edits", 1e-6, "M", None, "higher"),
        Goal(RANDOM, "rate", "per_second", 1e-6, "M/s", None, "higher"),
    ),
    "servo": tuple(
        row
        for load in LOADS
        for rate in RATES
        for row in _servo(servo_case(rate, load), late=0.1 if rate == 1000 else None)
    ),
}
"""Rows of each benchmark, in the order of its table."""
