"""Rows of ``palpate bench segment --grow``, and their goals."""

from __future__ import annotations

from palpate.bench.goals.goal import Goal

__all__ = ["BALLS", "GROW_ROWS", "LEAST_DICE", "ORGAN_NAMES", "organ_case"]

LEAST_DICE = 0.85
"""A click that finds less has not found the organ."""

BALLS = "balls of 3 to 20 mm, crisp"

ORGAN_NAMES = (
    *("liver, AMOS", "aorta, AMOS", "spleen, AMOS", "right kidney, AMOS", "bladder, AMOS"),
    *("liver, LIDC", "aorta, LIDC", "vertebra T12, LIDC"),
)


def organ_case(name: str) -> str:
    """Returns the case of clicks into an organ."""
    return f"clicks: {name}"


def _organ(name: str) -> tuple[Goal, ...]:
    case = organ_case(name)
    return (
        Goal(case, "found", "found", 1.0, "", None, "higher"),
        Goal(case, "stopped and told", "told", 1.0, "", None, "lower"),
        Goal(case, "least Dice of results", "dice", 1.0, "", LEAST_DICE, "higher"),
    )


def _all() -> tuple[Goal, ...]:
    case = organ_case("all")
    return (
        Goal(case, "found", "found", 1.0, "", 21.0, "higher"),
        Goal(case, "stopped and told", "told", 1.0, "", 3.0, "lower"),
        Goal(case, "leaked in silence", "leaked", 1.0, "", 0.0, "lower"),
        Goal(case, "short in silence", "short", 1.0, "", 0.0, "lower"),
        Goal(case, "longest", "seconds", 1.0, "s", 3.0, "lower"),
        Goal(case, "longest, processor time", "worked", 1.0, "s", None, "lower"),
    )


GROW_ROWS = (
    *(row for name in ORGAN_NAMES for row in _organ(name)),
    *_all(),
    Goal(BALLS, "largest error of the volume", "error", 100.0, "%", 5.0, "lower"),
)
