"""What ``palpate bench render`` tells, and which goals it is held against."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from palpate.base.errors import OptionError
from palpate.bench.goals import GOALS
from palpate.bench.goals.render import (
    EDIT_CASE,
    MODES,
    OPENED_CASE,
    PEER_MODES,
    RESTING,
    SEEN_CASE,
    SIZES,
    peer_case,
    picture_case,
)
from palpate.bench.render import SURFACES, measure, rows_of
from palpate.bench.seen import figures_of


def test_every_mode_and_size_has_its_rows_and_goals_are_those_of_the_issue() -> None:
    rows = GOALS["render"]
    assert len({(row.case, row.metric) for row in rows}) == len(rows)
    metrics = ["turning, median", "turning, p99", RESTING, "picture, median", "picture, p99"]
    for case in (picture_case(mode, size) for mode in MODES for size in SIZES):
        found = [row.metric for row in rows if row.case == case]
        assert [one.endswith(metric) for one, metric in zip(found, metrics, strict=True)]
    assert {(640, 480), (1366, 768)} <= set(SIZES)
    source = Path(__file__).parents[3] / "viewer" / "src" / "core" / "appearance" / "optics.ts"
    blends = re.search(r"export const blends = (\[.*?\])", source.read_text(encoding="utf-8"))
    assert blends is not None
    assert set(MODES) == {*json.loads(blends[1]), *SURFACES}
    goals = {(row.case, row.metric): row.goal for row in rows if row.goal is not None}
    assert goals == {
        (OPENED_CASE, "first picture after the page"): 2.0,
        (EDIT_CASE, "of the 3-D textures"): 5.0,
        (SEEN_CASE, "pictures while turning"): 8.0,
        (SEEN_CASE, "their resolution is divided by"): 4.0,
        (SEEN_CASE, "delay of keys while turning, p95"): 100.0,
        (SEEN_CASE, "delay of keys while refining, p95"): 100.0,
        **{(peer_case(mode), "vtk.js's time by ours, equal quality"): 1.0 for mode in PEER_MODES},
        **{(picture_case(mode, size), RESTING): 0.5 for mode in MODES for size in SIZES},
    }


def test_full_quality_within_half_a_second_is_a_goal_of_gpus() -> None:
    report = {picture_case(MODES[0], SIZES[0]): {"resting": 0.6}}
    assert [row.met for row in rows_of(report, on_gpu=True)] == [False]
    assert [row.met for row in rows_of(report, on_gpu=False)] == [None]


def test_what_is_seen_counts_from_the_last_turn() -> None:
    watched = {
        "turning": [[100.0, 8], [200.0, 4], [300.0, 4]],
        "rested": 500.0,
        "resting": [[510.0, 4], [900.0, 2], [1500.0, 1], [2500.0, 1]],
        "final": 2500.0,
        "delays": [[100.0, 20.0], [700.0, 5.0]],
    }
    figures = figures_of(watched)
    assert figures == pytest.approx(
        {
            "seen rate": 6.0,
            "seen divisor": 4.0,
            "seen 4": 0.01,
            "seen 2": 0.4,
            "seen 1": 1.0,
            "seen final": 2.0,
            "key turning": 0.02,
            "key resting": 0.005,
        }
    )
    assert {row.metric for row in rows_of({SEEN_CASE: figures}, on_gpu=False)} == {
        goal.metric for goal in GOALS["render"] if goal.case == SEEN_CASE
    }


def test_what_was_not_measured_has_no_row() -> None:
    case = picture_case(MODES[0], SIZES[0])
    figures = {"turning median": 0.03, "turning p99": 0.05, "whole median": 0.2, "whole p99": 0.3}
    rows = rows_of({case: figures}, on_gpu=False)
    assert {(row.case, row.unit) for row in rows} == {(case, "ms")}
    assert [row.value for row in rows] == pytest.approx([1e3 * value for value in figures.values()])


def test_a_script_that_is_not_there_is_named(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    browser = tmp_path / "chromium"
    browser.touch(mode=0o755)
    monkeypatch.setenv("PALPATE_CHROMIUM", str(browser))
    with pytest.raises(OptionError, match=r"no script at .*vtk\.js; allowed: .*build:bench"):
        measure(peer=tmp_path / "vtk.js")
