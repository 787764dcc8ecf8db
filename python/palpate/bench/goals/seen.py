"""Rows of what a person sees by ``palpate bench render``, and their goals.

Goals are for two cores without a GPU, with nothing else at work: there the engine draws.
"""

from __future__ import annotations

from palpate.bench.goals.goal import Goal

__all__ = [
    "BETTER_CASE",
    "GIVEN_SCAN",
    "LATE_CASE",
    "LATE_MORE",
    "MOVING_SCANS",
    "SEEN_ROWS",
    "SEEN_SCANS",
    "VTK_CASE",
    "VTK_JS_CASE",
    "moving_case",
    "seen_case",
]

SEEN_SCANS = ("CThead", "AMOS")
"""Scans that are opened, turned and drilled."""
MOVING_SCANS = ("CThead", "AMOS", "LIDC")
"""Scans whose moving pictures are compared with sharp ones."""
GIVEN_SCAN = "the given scan"

LATE_CASE = "servo at 1 kHz, pictures beside it"
LATE_MORE = "more of them with pictures"
"""A row whose goal is for servos with real-time priority."""
VTK_CASE = "engine beside VTK's ray caster, shaded"
VTK_JS_CASE = "engine beside vtk.js, shaded"
BETTER_CASE = "engine beside the faster of both, equal quality"


def seen_case(scan: str, *, by_engine: bool) -> str:
    """Returns the name of a scan that is opened, turned and drilled."""
    drawer = "the engine" if by_engine else "the browser"
    return f"{scan} in a window of 1366×768, drawn by {drawer}"


def moving_case(scan: str) -> str:
    """Returns the name of the comparison of a scan's moving pictures with sharp ones."""
    return f"{scan}, moving pictures beside sharp ones"


def _seen(
    case: str,
    times: tuple[float | None, float | None, float | None] = (None, None, None),
    *,
    by_engine: bool,
) -> tuple[Goal, ...]:
    """Returns the rows of a scan; ``times``: of its first picture, sharp, and sharp after a rest.

    The browser's own drawing has the goals of turning that were set for it.
    """
    first, sharp, rested = times if by_engine else (None, None, None)
    rate, coarsest = (10.0, 3.0) if by_engine else (8.0, 4.0)
    rows = (
        Goal(case, "command to address of the page", "served", 1.0, "s", None, "lower"),
        Goal(
            case, "page to picture of a third of the resolution", "first", 1.0, "s", first, "lower"
        ),
        Goal(case, "page to sharp picture", "sharp", 1.0, "s", sharp, "lower"),
        Goal(case, "page to final picture", "final", 1.0, "s", None, "lower"),
        Goal(case, "pictures while turning", "rate", 1.0, "/s", rate, "higher"),
        Goal(
            case, "their resolution is divided by at most", "coarsest", 1.0, "", coarsest, "lower"
        ),
        Goal(case, "rest to sharp picture", "rest sharp", 1.0, "s", rested, "lower"),
        Goal(case, "rest to final picture", "rest final", 1.0, "s", None, "lower"),
        Goal(case, "delay of keys while turning, p95", "key turning", 1e3, "ms", 100.0, "lower"),
        Goal(case, "delay of keys while refining, p95", "key resting", 1e3, "ms", 100.0, "lower"),
    )
    if not by_engine:
        return rows
    return (
        *rows,
        Goal(case, "mouse to true picture, median", "mouse median", 1e3, "ms", 100.0, "lower"),
        Goal(case, "mouse to true picture, p95", "mouse p95", 1e3, "ms", None, "lower"),
        Goal(case, "turned pictures while turning", "turned rate", 1.0, "/s", None, "higher"),
        Goal(case, "mouse to turned picture, median", "turned median", 1e3, "ms", 100.0, "lower"),
        Goal(case, "mouse to turned picture, p95", "turned p95", 1e3, "ms", None, "lower"),
        Goal(case, "drilled to seen, median", "drill median", 1e3, "ms", 200.0, "lower"),
        Goal(case, "drilled to seen, p95", "drill p95", 1e3, "ms", None, "lower"),
    )


def _moving(case: str) -> tuple[Goal, ...]:
    return (
        Goal(case, "resolution is divided by", "divisor", 1.0, "", None, "lower"),
        Goal(case, "structural similarity, worst view", "ssim", 1.0, "", 0.85, "higher"),
        Goal(case, "mean difference, worst view", "error", 255.0, "/255", 8.0, "lower"),
    )


def _beside(case: str, peer: str) -> tuple[Goal, ...]:
    reference = "16 steps per voxel, RMS"
    return (
        Goal(case, "engine, one step per voxel", "ours", 1e3, "ms", None, "lower"),
        Goal(case, f"engine off {reference}", "ours off", 255.0, "/255", None, "lower"),
        Goal(case, f"{peer}, one step per voxel", "same", 1e3, "ms", None, "lower"),
        Goal(case, "its time by the engine's, same step", "same ratio", 1.0, "x", None, "higher"),
        Goal(case, f"{peer}'s steps for equal quality", "steps", 1.0, "/voxel", None, "lower"),
        Goal(case, f"{peer} off its own {reference}", "theirs off", 255.0, "/255", None, "lower"),
        Goal(case, f"{peer}, equal quality", "theirs", 1e3, "ms", None, "lower"),
        Goal(case, "its time by the engine's, equal quality", "ratio", 1.0, "x", None, "higher"),
    )


GOAL_TIMES = {"CThead": (2.0, 4.0, 1.0), "AMOS": (3.0, 6.0, 2.0)}

SEEN_ROWS = (
    *(
        row
        for scan in (*SEEN_SCANS, GIVEN_SCAN)
        for by_engine in (True, False)
        for row in _seen(
            seen_case(scan, by_engine=by_engine),
            GOAL_TIMES.get(scan, (None, None, None)),
            by_engine=by_engine,
        )
    ),
    *(row for scan in (*MOVING_SCANS, GIVEN_SCAN) for row in _moving(moving_case(scan))),
    Goal(LATE_CASE, "more than 2 ms late, no pictures", "without", 100.0, "%", None, "lower"),
    Goal(LATE_CASE, "more than 2 ms late, with pictures", "with", 100.0, "%", None, "lower"),
    Goal(LATE_CASE, LATE_MORE, "more", 100.0, "%", 0.1, "lower"),
    Goal(LATE_CASE, "pictures meanwhile", "pictures", 1.0, "/s", None, "higher"),
    *_beside(VTK_CASE, "VTK"),
    Goal(VTK_CASE, "engine with all its light", "whole", 1e3, "ms", None, "lower"),
    *_beside(VTK_JS_CASE, "vtk.js"),
    Goal(BETTER_CASE, "its time by the engine's", "ratio", 1.0, "x", 1.5, "higher"),
)
