"""Rows of ``palpate bench open``, and their goals."""

from __future__ import annotations

from palpate.bench.goals.goal import Goal
from palpate.bench.goals.render import processor_rows

__all__ = ["OPEN_CASE", "OPEN_ROWS"]

OPEN_CASE = "DICOM series, 275 slices of 512×512"

OPEN_ROWS = (
    Goal(OPEN_CASE, "command to first picture", "picture", 1.0, "s", 5.0, "lower"),
    *processor_rows(OPEN_CASE),
    Goal(OPEN_CASE, "command to the picture of all of it", "whole", 1.0, "s", None, "lower"),
    Goal(OPEN_CASE, "command to address of the page", "served", 1.0, "s", None, "lower"),
    Goal(OPEN_CASE, "reading", "read", 1.0, "s", None, "lower"),
    Goal(OPEN_CASE, "reading by SimpleITK", "itk", 1.0, "s", None, "lower"),
    Goal(OPEN_CASE, "SimpleITK's time by ours", "ratio", 1.0, "x", None, "higher"),
    Goal(OPEN_CASE, "memory of the values", "bytes", 2.0**-20, "MiB", None, "lower"),
)
