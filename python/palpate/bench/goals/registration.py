"""Rows of ``palpate bench register``, and their goals.

A pair of lungs: within 10 % of elastix' own defaults. CT and a stand-in for MR: what mutual
information has reached, rounded up, so that a regression is noticed.
"""

from __future__ import annotations

from palpate.bench.goals.goal import Goal
from palpate.registration.options import Kind, Metric

__all__ = [
    "ELASTIX_CASE",
    "LUNG_ROWS",
    "METRICS",
    "MODALITY_ROWS",
    "REGISTER_ROWS",
    "STARTS",
    "modality_case",
    "registered_case",
]

ELASTIX_CASE = "lung at two dates, elastix affine + bspline"


def registered_case(kind: str) -> str:
    """Returns the name of a registration of the pair."""
    return f"lung at two dates, {kind}"


def _rows(case: str, *, goal: float | None = None) -> tuple[Goal, ...]:
    return (
        Goal(case, "landmarks apart before, mean", "before", 1.0, "mm", None, "lower"),
        Goal(case, "landmarks apart, mean", "mean", 1.0, "mm", None, "lower"),
        Goal(case, "landmarks apart, most", "most", 1.0, "mm", None, "lower"),
        Goal(case, "mean by elastix' mean", "ratio", 1.0, "x", goal, "lower"),
        Goal(case, "processor time", "seconds", 1.0, "s", None, "lower"),
    )


STARTS = ((5.0, 5.0), (15.0, 10.0), (30.0, 20.0))
"""Errors of a start: translation [mm] and rotation [degrees]."""
METRICS: tuple[Metric, ...] = ("mutual-information", "correlation")
CORNER_GOALS: dict[Kind, float] = {"rigid": 1.0, "affine": 1.0}
"""Errors of the corners of a head [mm], with mutual information."""


def modality_case(kind: str, metric: str, off: tuple[float, float]) -> str:
    """Returns the name of registrations of CT and the stand-in for MR."""
    length, degrees = off
    return f"CT and like MR, {kind}, {metric}, start {length:g} mm and {degrees:g} degrees off"


def _modality_rows(kind: Kind, metric: Metric, off: tuple[float, float]) -> tuple[Goal, ...]:
    case = modality_case(kind, metric, off)
    goal = CORNER_GOALS[kind] if metric == "mutual-information" else None
    return (
        Goal(case, "corners apart before, mean", "before", 1.0, "mm", None, "lower"),
        Goal(case, "corners apart, mean", "mean", 1.0, "mm", None, "lower"),
        Goal(case, "corners apart, most", "most", 1.0, "mm", goal, "lower"),
    )


MODALITY_ROWS = tuple(
    row
    for kind in CORNER_GOALS
    for metric in METRICS
    for off in STARTS
    for row in _modality_rows(kind, metric, off)
)

LUNG_ROWS = (
    *_rows(registered_case("rigid")),
    *_rows(registered_case("affine")),
    *_rows(registered_case("bspline"), goal=1.1),
    *_rows(ELASTIX_CASE),
)

REGISTER_ROWS = (*LUNG_ROWS, *MODALITY_ROWS)
