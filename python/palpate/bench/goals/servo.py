"""Rows of the benchmark of the servo, and their goals."""

from __future__ import annotations

from palpate.bench.goals.goal import Goal

__all__ = [
    "BUSY",
    "DEFORMING",
    "LOADS",
    "RATES",
    "SERVO_ROWS",
    "servo_case",
]

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


SERVO_ROWS = tuple(row for load in LOADS for rate in RATES for row in _servo(rate, load))
