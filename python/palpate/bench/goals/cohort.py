"""Rows of ``palpate bench cohort``, and their goal: what a case costs beside its steps."""

from __future__ import annotations

from palpate.bench.goals.goal import Goal

__all__ = ["COHORT_ROWS", "EMPTY_CASES", "SMALL_CASES"]

EMPTY_CASES = "cases without steps, on two workers"
SMALL_CASES = "small phantoms, one after the other"

COHORT_ROWS = (
    Goal(EMPTY_CASES, "a case", "case", 1e3, "ms", None, "lower"),
    Goal(SMALL_CASES, "steps in one process, a case", "steps", 1.0, "s", None, "lower"),
    Goal(SMALL_CASES, "overhead a case", "overhead", 1.0, "s", 0.3, "lower"),
)
