"""Rows of ``palpate bench render``, and their goals."""

from __future__ import annotations

from palpate.bench.goals.goal import Goal
from palpate.bench.goals.seen import SEEN_ROWS

__all__ = [
    "EDIT_CASE",
    "MODES",
    "OPENED_CASE",
    "PEER_MODES",
    "RENDER_ROWS",
    "RESTING",
    "SIZES",
    "peer_case",
    "picture_case",
    "processor_rows",
]

MODES = (
    "absorption",
    "emission",
    "composite",
    "shaded",
    "mip",
    "minip",
    "average",
    "iso",
    "surface",
    "translucent surface",
    "surface and voxels",
    "surface before a MIP",
)
"""Blend modes of the page; then bone as triangles, beside shaded tissue or before a MIP."""
SIZES = ((640, 480), (1366, 768))
"""Sizes of the picture [pixels]."""
PEER_MODES = ("composite", "shaded", "mip")
"""Modes that vtk.js has too."""

OPENED_CASE, EDIT_CASE = "opened", "an edit"
RESTING = "full quality after the last turn"
"""A row whose goal is for GPUs."""


def picture_case(mode: str, size: tuple[int, int]) -> str:
    """Returns the name of a picture of a mode and a size."""
    return f"{mode}, {size[0]}×{size[1]}"


def peer_case(mode: str) -> str:
    """Returns the name of a comparison with vtk.js."""
    return f"{mode} beside vtk.js"


def processor_rows(case: str) -> tuple[Goal, ...]:
    """Returns the rows of a browser's processor time until its first picture."""
    return tuple(
        Goal(case, f"processor time until it, {name}", key, 1.0, "s", None, "lower")
        for name, key in (("page", "page"), ("drawing", "graphics"), ("rest of browser", "rest"))
    )


def _picture(case: str) -> tuple[Goal, ...]:
    return (
        Goal(case, "while turning, median", "turning median", 1e3, "ms", None, "lower"),
        Goal(case, "while turning, p99", "turning p99", 1e3, "ms", None, "lower"),
        Goal(case, RESTING, "resting", 1.0, "s", 0.5, "lower"),
        Goal(case, "whole picture, median", "whole median", 1e3, "ms", None, "lower"),
        Goal(case, "whole picture, p99", "whole p99", 1e3, "ms", None, "lower"),
    )


def _beside(case: str, ratio: float | None) -> tuple[Goal, ...]:
    return (
        Goal(case, "whole picture", "ours", 1e3, "ms", None, "lower"),
        Goal(case, "off a fine-step reference, mean", "ours off", 255.0, "/255", None, "lower"),
        Goal(case, "vtk.js, same step", "same", 1e3, "ms", None, "lower"),
        Goal(case, "vtk.js off its own, same step", "same off", 255.0, "/255", None, "lower"),
        Goal(case, "vtk.js's time by ours, same step", "same ratio", 1.0, "x", None, "higher"),
        Goal(case, "vtk.js's steps for equal quality", "equal steps", 1.0, "/voxel", None, "lower"),
        Goal(case, "vtk.js's time by ours, equal quality", "ratio", 1.0, "x", ratio, "higher"),
    )


RENDER_ROWS = (
    *SEEN_ROWS,
    Goal(OPENED_CASE, "first picture after the page", "first", 1.0, "s", 2.0, "lower"),
    *processor_rows(OPENED_CASE),
    Goal(OPENED_CASE, "memory of the page's scripts", "heap", 2.0**-20, "MiB", None, "lower"),
    Goal(OPENED_CASE, "3-D textures", "textures", 2.0**-20, "MiB", None, "lower"),
    Goal(EDIT_CASE, "edits", "edits", 1.0, "", None, "higher"),
    Goal(EDIT_CASE, "GL calls", "calls", 1.0, "", None, "lower"),
    Goal(EDIT_CASE, "bytes sent to the GPU", "bytes", 1.0, "B", None, "lower"),
    Goal(EDIT_CASE, "of the 3-D textures", "share", 100.0, "%", 5.0, "lower"),
    *(row for mode in MODES for size in SIZES for row in _picture(picture_case(mode, size))),
    *(row for mode in PEER_MODES for row in _beside(peer_case(mode), 1.0)),
)
