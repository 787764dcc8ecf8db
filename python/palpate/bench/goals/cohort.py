"""Rows of ``palpate bench cohort``: what a case costs beside its steps, what two workers bring."""

from __future__ import annotations

from palpate.bench.goals.goal import Goal

__all__ = ["COHORT_ROWS", "EMPTY_CASES", "FULL_CASES", "SMALL_CASES"]

EMPTY_CASES = "cases without steps, on two workers"
SMALL_CASES = "small phantoms, one after the other"
FULL_CASES = "cases that fill a core, in pairs of runs"

COHORT_ROWS = (
    Goal(EMPTY_CASES, "a case", "case", 1e3, "ms", None, "lower"),
    Goal(SMALL_CASES, "steps in one process, a case", "steps", 1.0, "s", None, "lower"),
    Goal(SMALL_CASES, "overhead a case", "overhead", 1.0, "s", 0.3, "lower"),
    Goal(FULL_CASES, "two workers, by one", "speedup", 1.0, "×", 1.8, "higher"),
)
