"""Rows of the benchmark of the quality of touch, and their goals."""

from __future__ import annotations

from typing import Literal

from palpate.bench.goals.goal import Goal

__all__ = [
    "BODIES",
    "DIRECTION",
    "EXACT_TOUCHES",
    "FLAT",
    "GRIDS",
    "QUALITY_ROWS",
    "SLICES",
    "STROKES",
    "TOUCHES",
    "Touch",
    "quality_case",
]

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


QUALITY_ROWS = tuple(
    goal
    for touch in TOUCHES
    for grid in GRIDS
    for stroke in STROKES
    for body in BODIES
    for goal in _quality(touch, body, grid, stroke=stroke)
)
