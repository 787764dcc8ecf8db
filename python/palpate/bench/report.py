"""Rows of figures: as a table, and as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path

from palpate.base.harmless_text import terminal
from palpate.base.whole_file import whole_file
from palpate.bench.goals import Goal

__all__ = ["Row", "print_rows", "row_of", "rows_in", "write_rows"]


@dataclass(frozen=True)
class Row:
    """One figure and its goal."""

    case: str
    metric: str
    value: float
    unit: str
    goal: float | None
    better: str

    @property
    def met(self) -> bool | None:
        """Whether the goal is met; None where there is none."""
        if self.goal is None:
            return None
        return self.value >= self.goal if self.better == "higher" else self.value <= self.goal


def row_of(goal: Goal, report: dict[str, float]) -> Row:
    """Returns the figure of a goal from the engine's report."""
    value = report[goal.key] * goal.scale
    return Row(goal.case, goal.metric, value, goal.unit, goal.goal, goal.better)


def rows_in(goals: Iterable[Goal], report: dict[str, dict[str, float]]) -> list[Row]:
    """Returns the rows of the goals that a report has figures for."""
    return [
        row_of(goal, report[goal.case]) for goal in goals if goal.key in report.get(goal.case, {})
    ]


def write_rows(bench: str, rows: Iterable[Row], path: Path) -> None:
    """Writes the figures of a benchmark as one JSON object."""
    content = {"bench": bench, "rows": [asdict(row) for row in rows]}
    with whole_file(path) as unfinished:
        unfinished.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


def print_rows(bench: str, rows: Iterable[Row]) -> None:
    """Prints the figures of a benchmark as a table."""
    from rich.table import Table

    table = Table(title=bench, title_justify="left")
    for name in ("case", "metric", "value", "unit", "goal"):
        table.add_column(name, justify="right" if name in ("value", "goal") else "left")
    for row in rows:
        sign = "≥" if row.better == "higher" else "≤"
        goal = "" if row.goal is None else f"{sign} {row.goal:g}"
        style = "red" if row.met is False else None
        table.add_row(row.case, row.metric, f"{row.value:.4g}", row.unit, goal, style=style)
    terminal().print(table)
