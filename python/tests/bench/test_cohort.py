"""``palpate bench cohort``: every figure of the goals is measured."""

from __future__ import annotations

import json
from importlib.util import cache_from_source
from pathlib import Path

import pytest
from palpate.bench.goals.cohort import COHORT_ROWS
from palpate.cli.commands import run
from palpate.cohort import worker


@pytest.mark.long
def test_bench_cohort_measures_each_figure(tmp_path: Path) -> None:
    told = tmp_path / "cohort.json"
    assert run(["bench", "cohort", "--cases", "20", "--json", str(told)]) == 0
    rows = json.loads(told.read_text("utf-8"))["rows"]
    assert [(row["case"], row["metric"]) for row in rows] == [
        (goal.case, goal.metric) for goal in COHORT_ROWS
    ]
    # a process of a case finds its modules compiled, as in an installed package
    assert Path(cache_from_source(worker.__file__)).is_file()
    figures = {row["metric"]: row["value"] for row in rows}
    assert figures["a case"] > 0.0
    assert figures["steps in one process, a case"] > 0.0
