"""Rows of the stress test of touch, and their goals."""

from __future__ import annotations

from palpate.bench.goals.goal import Goal

__all__ = [
    "RANDOM",
    "STRESS_ROWS",
]

RANDOM = "random moves"

STRESS_ROWS = (
    Goal(RANDOM, "violations", "violations", 1.0, "1", 0.0, "lower"),
    Goal(RANDOM, "moves", "moves", 1e-6, "M", None, "higher"),
    Goal(RANDOM, "in contact", "contact_share", 100.0, "%", None, "higher"),
    Goal(RANDOM, "edits", "edits", 1e-6, "M", None, "higher"),
    Goal(RANDOM, "steps of moving objects", "poses", 1e-6, "M", None, "higher"),
    Goal(RANDOM, "forces that fell, lest they pull", "cuts", 1e-6, "M", None, "lower"),
    Goal(RANDOM, "rate", "per_second", 1e-6, "M/s", None, "higher"),
)
