"""Reports of all benchmarks, and their goals: the one table that reports and tests read.

A row without a goal is reported for information.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from palpate.bench.goals.cohort import COHORT_ROWS
from palpate.bench.goals.goal import Goal
from palpate.bench.goals.growing import GROW_ROWS
from palpate.bench.goals.opening import OPEN_ROWS
from palpate.bench.goals.registration import REGISTER_ROWS
from palpate.bench.goals.render import RENDER_ROWS
from palpate.bench.goals.segmenting import SEGMENT_ROWS
from palpate.bench.goals.soft_tissue import (
    DEFORM_ROWS,
    MATTER_STRESS_ROWS,
    SESSION_ROWS,
    TRUTH_CUBE_ROWS,
)

__all__ = [
    "DEFAULT_STIFFNESS",
    "DRILLED",
    "EDIT_DRAWN",
    "EDIT_PRESSED",
    "EDIT_SUSPENDED",
    "EMBEDDED",
    "EMBEDDED_ROWS",
    "EMBEDDED_WORKS",
    "EXACT",
    "EXACT_TOUCHES",
    "FLAT_WALL",
    "FLYING",
    "GOALS",
    "GROUNDS",
    "IMPROVED",
    "PUBLISHED",
    "PUBLISHED_BY_OTHERS",
    "RADII",
    "RATES_KHZ",
    "RATIO",
    "SPHERES",
    "STROKES",
    "SURFACES",
    "TOUCHES",
    "TOUCH_CASES",
    "TRUNK_512",
    "WALLS",
    "WORKS",
    "Goal",
    "Touch",
    "TouchCase",
    "haptics_rows",
    "sphere_case",
]


def _times(case: str, *, tail: float | None = None) -> tuple[Goal, ...]:
    """Returns the rows of single calls: median and tail."""
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


HEAD, TRUNK, CHEST = "CThead bone", "AMOS bone", "LIDC bone"
MANY = "LIDC bones and skin"
TORSO, LARGE = "phantom 520×512×512", "phantom 1024³"
GROUNDS = (HEAD, TRUNK, CHEST, MANY, TORSO, LARGE)
"""Data sets of ``palpate bench haptics``, in the order of its report."""

EXACT, ORIGINAL, IMPROVED = "exact", "thesis-original", "thesis-improved"

WORKS = {
    "detection, 1 voxel": "detection, 1 voxel",
    "detection, 4 voxels": "detection, 4 voxels",
    "detection, 10 voxels": "detection, 10 voxels",
    "hard proxy": "proxy",
    "complete tick": "tick",
    "tick by bits": "tick, by bits",
    "tick without smoothing": "tick, no smoothing",
    "tick without friction": "tick, no friction",
}
"""What is timed, and the engine's name of it."""

PARTS = ("tick by bits", "tick without smoothing", "tick without friction")
"""Parts of a complete tick, reported for a point only."""

RADII = (0, 1, 2, 5)
"""Radii of the probe [h]; 0 is a point."""


@dataclass(frozen=True)
class TouchCase:
    """What is timed, with which contact model and probe."""

    work: str
    model: str
    radius: int

    @property
    def name(self) -> str:
        """Name in the report."""
        return f"{self.work}, {self.model}, r {self.radius}"


def _touch_cases() -> tuple[TouchCase, ...]:
    """Returns all cases; the thesis' models, and the parts of a tick, are for points only."""
    return tuple(
        TouchCase(work, model, radius)
        for work in WORKS
        for model in (EXACT, ORIGINAL, IMPROVED)
        for radius in RADII
        if radius == 0 or (model == EXACT and work not in PARTS)
        if model == EXACT or work not in PARTS
    )


TOUCH_CASES = _touch_cases()

LEAST_RATE = {
    "detection, 4 voxels, exact, r 0": 15.0,
    "hard proxy, exact, r 0": 2.0,
    "complete tick, exact, r 0": 1.0,
    "complete tick, exact, r 1": 0.4,
    "complete tick, exact, r 2": 0.4,
    "complete tick, exact, r 5": 0.15,
}
"""Least rate [M/s]; with many segments there is no goal."""

LONGEST_TICK = 20.0
"""Longest time of 99.9 % of complete ticks [µs]."""

RATIO = "ratio_to_thesis_improved"
"""Key of the calls per second relative to ``thesis-improved`` in the same run."""


def haptics_rows(ground: str) -> tuple[Goal, ...]:
    """Returns the rows of one data set."""
    return tuple(row for case in TOUCH_CASES for row in _touch_rows(ground, case))


def _touch_rows(ground: str, touch: TouchCase) -> tuple[Goal, ...]:
    case = f"{ground}: {touch.name}"
    has_goal = ground != MANY
    is_tick = touch.work == "complete tick" and touch.model == EXACT
    rows = [
        _rate(case, LEAST_RATE.get(touch.name) if has_goal else None),
        *_times(case, tail=LONGEST_TICK if has_goal and is_tick else None),
    ]
    if "detection" not in touch.work:
        rows.append(_contact(case, 95.0 if touch.model == EXACT else None))
    if touch.radius == 0 and touch.model != IMPROVED and touch.work not in PARTS:
        rows.append(Goal(case, "ratio to thesis-improved", RATIO, 1.0, "x", None, "higher"))
    return tuple(rows)


EMBEDDED = "CThead bone in 113×256×256 and in 1024³"
EMBEDDED_WORKS = ("detection, 4 voxels", "hard proxy", "complete tick")


def _embedded_rows(work: str) -> tuple[Goal, ...]:
    case = f"{EMBEDDED}: {work}"
    rows = [
        Goal(case, "rate, small", "small_per_second", 1e-6, "M/s", None, "higher"),
        Goal(case, "rate, 1024³", "large_per_second", 1e-6, "M/s", None, "higher"),
        Goal(case, "ratio", "ratio", 1.0, "x", 0.8, "higher"),
    ]
    return tuple(rows if "detection" in work else [*rows, _contact(case)])


def _cold_rows(size: str) -> tuple[Goal, ...]:
    case = f"{EMBEDDED}: hard proxy, cold random starts, {size}"
    return (_rate(case, None), *_times(case))


EMBEDDED_ROWS = (
    *(row for work in EMBEDDED_WORKS for row in _embedded_rows(work)),
    *_cold_rows("small"),
    *_cold_rows("1024³"),
)

PUBLISHED_BY_OTHERS = "published"
"""Name of these rows in place of a data set."""

PUBLISHED = (
    ("thesis, detection, points", 0.75),
    ("thesis table 4.1, response, Head small 113×256×256", 0.152),
    ("thesis table 4.1, response, Torso 520×512×512", 0.138),
    ("thesis table 4.1, response, Head big 464×532×532", 0.146),
    ("thesis table 4.2, improved response, Head small 113×256×256", 0.146),
    ("thesis table 4.2, improved response, Torso 520×512×512", 0.134),
    ("thesis table 4.2, improved response, Head big 464×532×532", 0.141),
    ("CHAI3D 3.3, full update, 256×256×113 blob, r 0, least", 1.07),
    ("CHAI3D 3.3, full update, 256×256×113 blob, r 0, most", 1.18),
    ("CHAI3D 3.3, full update, 256×256×113 blob, r 1", 0.40),
    ("CHAI3D 3.3, full update, 256×256×113 blob, r 2", 0.23),
    ("CHAI3D 3.3, full update, 256×256×113 blob, r 5", 0.06),
    ("CHAI3D 3.3, full update, heart CT, r 0", 1.38),
    ("CHAI3D 3.3, full update, heart CT, r 1", 0.46),
    ("CHAI3D 3.3, full update, heart CT, r 2", 0.30),
    ("CHAI3D 3.3, full update, heart CT, r 5", 0.07),
)
"""Published rates on other machines [M/s], so without a ratio: thesis sections 4.14 and 4.15 on a
Xeon W5580; CHAI3D, which does not smooth, on an EPYC."""

RANDOM = "random moves"

Touch = Literal[
    "exact",
    "exact, intensities",
    "exact, range's end",
    "exact, r 1",
    "exact, r 2",
    "exact, r 5",
    "stairs",
    "thesis-original",
    "thesis-improved",
]

EXACT_TOUCHES: tuple[Touch, ...] = (
    *("exact", "exact, intensities", "exact, range's end"),
    *("exact, r 1", "exact, r 2", "exact, r 5"),
)
"""``exact`` with a point on a mask, with a point on a threshold of intensities (open, or up to the
highest value of the scan), and with balls [h], which are compared with the dilated body."""

TOUCHES: tuple[Touch, ...] = (*EXACT_TOUCHES, "stairs", "thesis-original", "thesis-improved")
"""Models of touch: ``exact``, the same unsmoothed, and the thesis' models."""

CUBES = "cubes"
SLICES = "0.7×0.7×2.5"
GRIDS = (CUBES, SLICES)

STROKES = ((2.0, 0.2), (5.0, 0.2), (2.0, 0.05), (5.0, 1.0))
"""Depth of the device and its motion per update, both in h."""

FLAT = ("plane below 10°", "plane")
BODIES = (
    *FLAT,
    *("sphere", "torus", "cylinder", "bore", "ramp", "step up", "step down", "wedge"),
    *("shell of 1", "shell of 2", "shell of 3"),
)
TOLD_WELL = ("plane", "sphere", "torus")
"""Bodies on which direction and magnitude of the force have a goal."""
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
    """Returns the rows of a body; only ``exact`` has goals."""
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
            goal if touch in EXACT_TOUCHES else None,
            "higher" if metric == "in contact" else "lower",
        )
        for metric, key, unit, goal in rows
    )


RATES = (1000, 2000, 4000)
"""Rates of the servo [Hz]."""
BUSY = "all cores busy"
DEFORMING = "matter gives way"
LOADS = ("at rest", BUSY, DEFORMING)
"""Load of the machine."""


def servo_case(rate: int, load: str) -> str:
    """Returns the name of a case of the servo."""
    return f"{rate / 1000:g} kHz, {load}"


def _servo(rate: int, load: str) -> tuple[Goal, ...]:
    """Returns the rows of the servo; only 1 kHz has a goal."""
    case, late = servo_case(rate, load), 0.1 if rate == 1000 else None
    rows = (
        Goal(case, "median", "p50_ms", 1e3, "µs", None, "lower"),
        Goal(case, "p99", "p99_ms", 1e3, "µs", None, "lower"),
        Goal(case, "p99.9", "p999_ms", 1e3, "µs", None, "lower"),
        Goal(case, "max", "max_ms", 1e3, "µs", None, "lower"),
        Goal(case, "more than 2 ms late", "late_share", 100.0, "%", late, "lower"),
        Goal(case, "fell out", "missed_share", 100.0, "%", None, "lower"),
    )
    if load != DEFORMING:
        return rows
    return (*rows, Goal(case, "answers of the model", "answers_hz", 1.0, "1/s", None, "higher"))


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
"""Initial stiffness of each device [N/mm]: the default of touch, or the largest that the device
allows."""


def _passivity(device: str, rate_khz: int, wall: str) -> tuple[Goal, ...]:
    """Returns the rows of a device on a wall."""
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


TRUNK_512 = "phantom 512³"
SURFACES = (HEAD, CHEST, TRUNK_512)
"""Bones of ``palpate bench surface``."""
FLYING = ("vtkFlyingEdges3D", "vtkDiscreteFlyingEdges3D")
"""Filters of VTK that are compared."""
DRILLED = "phantom 512³: drill of 5 voxels, smoothed"
SPHERES = {20.0: 1.0, 5.0: 3.0}
"""Largest error of area and volume of a smoothed ball [%], by its radius [voxels]."""


def sphere_case(radius: float) -> str:
    """Returns the name of a case of a ball."""
    return f"sphere of {radius:g} voxels, smoothed"


def _surface_rows(bone: str) -> tuple[Goal, ...]:
    """Returns the rows of the surface of a bone."""

    def rates(case: str) -> tuple[Goal, ...]:
        def rate(metric: str, key: str) -> Goal:
            return Goal(case, metric, key, 1e-6, "M tri/s", None, "higher")

        return (
            rate("rate", "per_second"),
            *(rate(kind, kind) for kind in FLYING),
            *(Goal(case, f"ratio to {kind}", f"ratio {kind}", 1.0, "x", 1.0, "higher")
              for kind in FLYING),
            rate("rate, smoothed", "smoothed_per_second"),
        )  # fmt: skip

    shape = f"{bone}: shape"
    return (
        *rates(f"{bone}: one thread"),
        *rates(f"{bone}: all threads"),
        Goal(shape, "area beside VTK's", "area", 100.0, "%", 1.0, "lower"),
        Goal(shape, "volume beside VTK's", "volume", 100.0, "%", 1.0, "lower"),
    )


SURFACE_ROWS = (
    *(row for bone in SURFACES for row in _surface_rows(bone)),
    Goal(DRILLED, "median", "median", 1e3, "ms", 5.0, "lower"),
    Goal(DRILLED, "95 %", "p95", 1e3, "ms", 5.0, "lower"),
    Goal(DRILLED, "max", "max", 1e3, "ms", None, "lower"),
    *(
        Goal(sphere_case(radius), f"{kind} beside the sphere's", kind, 100.0, "%", most, "lower")
        for radius, most in SPHERES.items()
        for kind in ("area", "volume")
    ),
)


EDIT_SUSPENDED = "drawing suspended"
EDIT_DRAWN = "drawn in software"
EDIT_PRESSED = "matter gives way, drawing suspended"


def _edit_rows(case: str, *, goal: float | None) -> tuple[Goal, ...]:
    """Returns the rows of edits on their way to the page."""

    def row(metric: str, key: str, goal: float | None = None) -> Goal:
        return Goal(case, metric, key, 1e3, "ms", goal, "lower")

    return (
        row("applied to last upload, median", "all median", goal),
        row("applied to last upload, 95 %", "all p95", goal),
        row("applied to last upload, max", "all max"),
        row("the same without the wait for a frame, median", "undrawn median"),
        row("the same without the wait for a frame, 95 %", "undrawn p95"),
        row("engine to page, median", "way"),
        row("wait for a frame, median", "wait"),
        row("page, median", "work"),
        Goal(case, "edits", "edits", 1.0, "", None, "higher"),
    )


GOALS: dict[str, tuple[Goal, ...]] = {
    "edit": (
        # the budget leaves drawing out, which takes all cores where there is no graphics card
        *_edit_rows(EDIT_SUSPENDED, goal=50.0),
        *_edit_rows(EDIT_PRESSED, goal=50.0),
        *_edit_rows(EDIT_DRAWN, goal=None),
    ),
    "open": OPEN_ROWS,
    "render": RENDER_ROWS,
    "cohort": COHORT_ROWS,
    "register": REGISTER_ROWS,
    "segment": SEGMENT_ROWS,
    "segment --grow": GROW_ROWS,
    "surface": SURFACE_ROWS,
    "haptics": (
        *(row for ground in GROUNDS for row in haptics_rows(ground)),
        *EMBEDDED_ROWS,
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
        Goal(RANDOM, "steps of moving objects", "poses", 1e-6, "M", None, "higher"),
        Goal(RANDOM, "forces that fell, lest they pull", "cuts", 1e-6, "M", None, "lower"),
        Goal(RANDOM, "rate", "per_second", 1e-6, "M/s", None, "higher"),
    ),
    "servo": tuple(row for load in LOADS for rate in RATES for row in _servo(rate, load)),
    "deform": DEFORM_ROWS,
    "session": SESSION_ROWS,
    "truth-cube": TRUTH_CUBE_ROWS,
    "stress-deform": MATTER_STRESS_ROWS,
}
"""Rows of each benchmark, in the order of its table."""
