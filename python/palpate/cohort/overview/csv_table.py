"""The table of a cohort: a line for each segment of each case, units in the names of columns."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from io import StringIO
from typing import Any

from palpate.cohort.overview.told_cases import ToldCase

__all__ = ["cohort_csv"]

FIRST, LAST = ["case", "state", "segment"], ["outlier", "warnings", "wall_s", "reason"]


def cohort_csv(cases: Sequence[ToldCase]) -> str:
    """Returns the table; a case without segments, or that failed, has one line."""
    rows = [row for case in cases for row in _rows(case)]
    measured = dict.fromkeys(name for row in rows for name in row if name not in FIRST + LAST)
    text = StringIO()
    writer = csv.DictWriter(text, [*FIRST, *measured, *LAST], restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def _rows(case: ToldCase) -> list[dict[str, Any]]:
    state = "done" if case.reason is None else "failed"
    shared = {
        "case": case.name,
        "state": state,
        "warnings": "; ".join(case.warnings),
        "wall_s": case.wall_s,
        "reason": case.reason,
    }
    if not case.segments:
        return [shared]
    return [
        {
            **shared,
            **{name: _cell(cell) for name, cell in row.items() if name != "colour"},
            "segment": segment,
            "outlier": "; ".join(name for where, name in case.outliers if where == segment),
        }
        for segment, row in case.segments.items()
    ]


def _cell(cell: object) -> object:
    return f"{cell:.10g}" if isinstance(cell, float) else cell
