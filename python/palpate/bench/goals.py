"""What each benchmark reports, and the goals: the one table that reports and tests read.

Goals are those of the design's section 8. A row without a goal is reported for orientation.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

__all__ = ["GOALS", "Goal"]


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

RATIO = "ratio_to_thesis_improved"
"""Key of calls per second by those of ``thesis-improved`` in the same run."""

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
}
"""Rows of each benchmark, in the order of its table."""
