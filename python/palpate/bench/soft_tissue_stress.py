"""``palpate bench stress --deform MODEL``: work in soft tissue, checked at every tick.

Pressing, sliding, drilling and needles in blocks of skin, soft tissue and bone, with the loops of
the session in step; the guarantees of touch are checked after each tick. Runs are determined by a
seed and a number, like those of ``palpate bench stress``.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field

from palpate import _core
from palpate.base.errors import OptionError
from palpate.base.progress import Progress, silent
from palpate.bench.goals.soft_tissue import MATTER_STRESS_ROWS, MODELS, stress_case
from palpate.bench.report import Row, row_of

__all__ = ["Worked", "checked_models", "rows_of", "work"]

TICKS = 10_000
"""Ticks of a run."""

COUNTS = (
    "ticks",
    "contacts",
    "bits",
    "edits",
    "answers",
    "in_bone",
    "drilled",
    "punctures",
    "rests",
)


@dataclass
class Worked:
    """Results of the runs with a model."""

    model: str
    counts: dict[str, int] = field(default_factory=lambda: dict.fromkeys(COUNTS, 0))
    violation: str | None = None


def checked_models(models: Sequence[str]) -> list[str]:
    """Returns the models of these names; "all" is all.

    Raises:
        OptionError: There is no such model.
    """
    for model in models:
        if model not in {*MODELS, "all"}:
            raise OptionError(f"model {model!r} given; allowed: {', '.join(MODELS)}, all")
    return [model for model in MODELS if model in models or "all" in models]


def work(
    model: str,
    *,
    moves: int,
    seed: int = 1,
    threads: int | None = None,
    progress: Progress = silent,
) -> Worked:
    """Runs a model until there are so many ticks, or a violation.

    Raises:
        OptionError: An argument is not allowed.
    """
    if moves < 1:
        raise OptionError(f"{moves} moves given; allowed: 1 or more")
    threads = threads or os.cpu_count() or 1
    worked = Worked(model)
    ticks, first = min(TICKS, moves), 0
    while worked.counts["ticks"] < moves and worked.violation is None:
        done = worked.counts["ticks"]
        progress(f"{model}: {done} ticks, no violation", done / moves)
        count = min(2 * threads, -(-(moves - done) // ticks))
        try:
            report = _core.bench_matter_stress(model, seed, first, count, ticks, threads)
        except (ValueError, OverflowError) as error:
            raise OptionError(str(error)) from None
        first += count
        for name, number in report.items():
            if isinstance(number, int):
                worked.counts[name] += number
        if report["violation"] is not None:
            worked.violation = (
                "guarantee {guarantee} violated in run {run} after {tick} ticks: {what}".format(
                    **report["violation"]
                )
            )
    return worked


def rows_of(found: Sequence[Worked]) -> list[Row]:
    """Returns the rows of the models."""
    reports = {
        stress_case(worked.model): {
            **{name: float(count) for name, count in worked.counts.items()},
            "violations": float(worked.violation is not None),
            "contact_share": worked.counts["contacts"] / max(1, worked.counts["ticks"]),
        }
        for worked in found
    }
    return [row_of(goal, reports[goal.case]) for goal in MATTER_STRESS_ROWS if goal.case in reports]
