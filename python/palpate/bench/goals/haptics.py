"""Rows of the benchmark of touch, and their goals."""

from __future__ import annotations

from dataclasses import dataclass

from palpate.bench.goals.goal import Goal

__all__ = [
    "CHEST",
    "EMBEDDED",
    "EMBEDDED_ROWS",
    "EMBEDDED_WORKS",
    "EXACT",
    "GROUNDS",
    "HAPTICS_ROWS",
    "HEAD",
    "IMPROVED",
    "LARGE",
    "MANY",
    "ORIGINAL",
    "PARTS",
    "PUBLISHED",
    "PUBLISHED_BY_OTHERS",
    "RADII",
    "RATIO",
    "TORSO",
    "TOUCH_CASES",
    "TRUNK",
    "WORKS",
    "TouchCase",
    "haptics_rows",
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

HAPTICS_ROWS = (
    *(row for ground in GROUNDS for row in haptics_rows(ground)),
    *EMBEDDED_ROWS,
)
