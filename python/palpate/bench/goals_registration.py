"""What ``palpate bench register`` reports, and its goal: within 10 % of elastix' own defaults."""

from __future__ import annotations

from palpate.bench.goal import Goal

__all__ = ["ELASTIX_CASE", "REGISTER_ROWS", "registered_case"]

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


REGISTER_ROWS = (
    *_rows(registered_case("rigid")),
    *_rows(registered_case("affine")),
    *_rows(registered_case("bspline"), goal=1.1),
    *_rows(ELASTIX_CASE),
)
