"""Benchmarks report every figure that has a goal."""

from __future__ import annotations

import json
from pathlib import Path

import palpate
import pytest
from palpate import OptionError, Scene
from palpate.bench.goals import GOALS
from palpate.bench.haptics import measure
from palpate.bench.report import Row, print_rows, write_rows

NAMED = {
    ("detection only", "rate"): (15.0, "M/s", "higher"),
    ("hard proxy", "rate"): (2.0, "M/s", "higher"),
    ("hard proxy", "in contact"): (95.0, "%", "higher"),
    ("complete tick", "rate"): (1.0, "M/s", "higher"),
    ("complete tick", "p99.9"): (20.0, "µs", "lower"),
    ("complete tick", "in contact"): (95.0, "%", "higher"),
}
"""Goals of the design's section 8 for what is built."""

CASES = (
    "detection only",
    "hard proxy",
    "hard proxy, thesis-original",
    "hard proxy, thesis-improved",
    "complete tick",
)


def test_every_named_goal_stands_in_the_table() -> None:
    table = {(row.case, row.metric): row for row in GOALS["haptics"]}
    assert len(table) == len(GOALS["haptics"]), "a row stands twice"
    for key, (goal, unit, better) in NAMED.items():
        assert (table[key].goal, table[key].unit, table[key].better) == (goal, unit, better)


def test_rows_have_median_and_tail_of_each_case(ball_scene: Scene) -> None:
    rows = measure(next(iter(ball_scene)).segment, count=2000)
    for case in CASES:
        figures = {row.metric: row.value for row in rows if row.case == case}
        assert 0.0 < figures["median"] <= figures["p99"] <= figures["p99.9"] <= figures["max"]
        assert figures["rate"] > 0.0
    assert {(row.case, row.metric) for row in rows} >= NAMED.keys()


def test_the_ratio_is_that_of_the_rates_of_the_same_run(ball_scene: Scene) -> None:
    rows = measure(next(iter(ball_scene)).segment, count=2000)
    figures = {(row.case, row.metric): row for row in rows}
    ratio = figures["hard proxy", "ratio to thesis-improved"]
    assert (ratio.unit, ratio.goal, ratio.better) == ("x", None, "higher")
    rates = [figures[case, "rate"].value for case in ("hard proxy", "hard proxy, thesis-improved")]
    assert ratio.value == pytest.approx(rates[0] / rates[1])


def test_models_of_the_thesis_have_no_goals() -> None:
    goals = [row.goal for row in GOALS["haptics"] if "thesis" in row.case]
    assert goals == [None] * 12


def test_the_file_has_the_agreed_form(tmp_path: Path) -> None:
    rows = [Row("a", "rate", 2.0, "M/s", 1.0, "higher"), Row("a", "max", 3.0, "µs", None, "lower")]
    write_rows("haptics", rows, tmp_path / "rows.json")
    told = json.loads((tmp_path / "rows.json").read_text())
    assert told == {
        "bench": "haptics",
        "rows": [
            {"case": "a", "metric": "rate", "value": 2.0, "unit": "M/s", "goal": 1.0,
             "better": "higher"},
            {"case": "a", "metric": "max", "value": 3.0, "unit": "µs", "goal": None,
             "better": "lower"},
        ],
    }  # fmt: skip


def test_the_table_shows_goals(capsys: pytest.CaptureFixture[str]) -> None:
    print_rows("haptics", [Row("tick", "p99.9", 31.0, "µs", 20.0, "lower")])
    assert "≤ 20" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("value", "better", "met"), [(2.0, "higher", True), (2.0, "lower", False), (1.0, "lower", True)]
)
def test_a_goal_is_met_in_its_direction(value: float, better: str, *, met: bool) -> None:
    assert Row("a", "b", value, "", 1.5, better).met is met


def test_a_count_that_is_not_allowed_is_refused(ball_scene: Scene) -> None:
    with pytest.raises(OptionError, match="allowed"):
        measure(next(iter(ball_scene)).segment, count=0)


def test_the_command_writes_its_file(tmp_path: Path) -> None:
    from palpate.cli import run

    made = palpate.phantom((40, 28, 54)).volume
    path = tmp_path / "scan.nrrd"
    import SimpleITK

    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(made.array), str(path))
    options = ["--data", str(path), "--json", str(tmp_path / "b.json"), "--count", "2000"]
    assert run(["bench", "haptics", *options]) == 0
    assert len(json.loads((tmp_path / "b.json").read_text())["rows"]) == len(GOALS["haptics"])
