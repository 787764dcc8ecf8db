"""Rows of ``palpate bench segment``, and their goals."""

from __future__ import annotations

from palpate.bench.goals.goal import Goal

__all__ = ["LIVER", "MANY_SEGMENTS", "SEGMENT_ROWS", "THRESHOLD"]

THRESHOLD = "threshold of 512×512×275, shown as a surface"
LIVER = "liver of AMOS 0336 from one click"
MANY_SEGMENTS = "89 segments of LIDC"

SEGMENT_ROWS = (
    Goal(THRESHOLD, "voxels", "threshold", 1.0, "s", None, "lower"),
    Goal(THRESHOLD, "asked to surface", "surface", 1.0, "s", 1.0, "lower"),
    Goal(THRESHOLD, "triangles", "triangles", 1e-6, "M", None, "higher"),
    Goal(LIVER, "growing", "grown", 1.0, "s", 2.0, "lower"),
    Goal(LIVER, "of it, processor time", "grown_worked", 1.0, "s", None, "lower"),
    Goal(LIVER, "Dice", "dice", 1.0, "", 0.85, "higher"),
    Goal(MANY_SEGMENTS, "file to session", "loaded", 1.0, "s", 5.0, "lower"),
    Goal(MANY_SEGMENTS, "of it, processor time", "loaded_worked", 1.0, "s", None, "lower"),
    Goal(MANY_SEGMENTS, "memory of their bricks", "bytes", 2.0**-20, "MiB", None, "lower"),
    Goal(MANY_SEGMENTS, "segments", "count", 1.0, "", None, "higher"),
)
