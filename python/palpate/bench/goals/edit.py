"""Rows of the benchmark of edits on their way to the page, and their goals."""

from __future__ import annotations

from palpate.bench.goals.goal import Goal

__all__ = [
    "EDIT_DRAWN",
    "EDIT_PRESSED",
    "EDIT_ROWS",
    "EDIT_SUSPENDED",
]

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


EDIT_ROWS = (
    # the budget leaves drawing out, which takes all cores where there is no graphics card
    *_edit_rows(EDIT_SUSPENDED, goal=50.0),
    *_edit_rows(EDIT_PRESSED, goal=50.0),
    *_edit_rows(EDIT_DRAWN, goal=None),
)
