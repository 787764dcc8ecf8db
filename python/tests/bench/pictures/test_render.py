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
    SIZES,
    peer_case,
    picture_case,
)
from palpate.bench.goals.seen import (
    BETTER_CASE,
    GIVEN_SCAN,
    LATE_CASE,
    LATE_MORE,
    MOVING_SCANS,
    SEEN_SCANS,
    moving_case,
    seen_case,
)
from palpate.bench.pictures.render import SURFACES, measure, rows_of

KEYS = {"key turning": 100.0, "key resting": 100.0}
BY_ENGINE = KEYS | {
    "rate": 10.0,
    "coarsest": 3.0,
    "mouse median": 100.0,
    "turned median": 100.0,
    "drill median": 200.0,
}
BY_BROWSER = KEYS | {"rate": 8.0, "coarsest": 4.0}
TIMES = {
    "CThead": {"first": 2.0, "sharp": 4.0, "rest sharp": 1.0},
    "AMOS": {"first": 3.0, "sharp": 6.0, "rest sharp": 2.0},
}
SEEN_GOALS = {
    **{
        (seen_case(scan, by_engine=True), key): goal
        for scan in (*SEEN_SCANS, GIVEN_SCAN)
        for key, goal in (BY_ENGINE | TIMES.get(scan, {})).items()
    },
    **{
        (seen_case(scan, by_engine=False), key): goal
        for scan in (*SEEN_SCANS, GIVEN_SCAN)
        for key, goal in BY_BROWSER.items()
    },
    **{
        (moving_case(scan), key): goal
        for scan in (*MOVING_SCANS, GIVEN_SCAN)
        for key, goal in (("ssim", 0.85), ("error", 8.0))
    },
    (LATE_CASE, "more"): 0.1,
    (BETTER_CASE, "ratio"): 1.5,
}
"""Those of pictures that a person sees, on two cores without a GPU; times in s and ms."""


def test_every_mode_and_size_has_its_rows_and_goals_are_those_of_the_issue() -> None:
    rows = GOALS["render"]
    assert len({(row.case, row.metric) for row in rows}) == len(rows)
    metrics = ["turning, median", "turning, p99", RESTING, "picture, median", "picture, p99"]
    for case in (picture_case(mode, size) for mode in MODES for size in SIZES):
        found = [row.metric for row in rows if row.case == case]
        assert [one.endswith(metric) for one, metric in zip(found, metrics, strict=True)]
    assert {(640, 480), (1366, 768)} <= set(SIZES)
    source = Path(__file__).parents[4] / "viewer" / "src" / "core" / "appearance" / "optics.ts"
    blends = re.search(r"export const blends = (\[.*?\])", source.read_text(encoding="utf-8"))
    assert blends is not None
    assert set(MODES) == {*json.loads(blends[1]), *SURFACES}
    told = {case for case, _ in SEEN_GOALS}
    goals = {
        (row.case, row.metric): row.goal
        for row in rows
        if row.goal is not None and row.case not in told
    }
    assert goals == {
        (OPENED_CASE, "first picture after the page"): 2.0,
        (EDIT_CASE, "of the 3-D textures"): 5.0,
        **{(peer_case(mode), "vtk.js's time by ours, equal quality"): 1.0 for mode in PEER_MODES},
        **{(picture_case(mode, size), RESTING): 0.5 for mode in MODES for size in SIZES},
    }


def test_full_quality_within_half_a_second_is_a_goal_of_gpus() -> None:
    report = {picture_case(MODES[0], SIZES[0]): {"resting": 0.6}}
    assert [row.met for row in rows_of(report, on_gpu=True)] == [False]
    assert [row.met for row in rows_of(report, on_gpu=False)] == [None]


def test_goals_of_what_is_seen_are_those_of_the_issue() -> None:
    rows = [row for row in GOALS["render"] if row.case in {case for case, _ in SEEN_GOALS}]
    goals = {(row.case, row.key): row.goal for row in rows if row.goal is not None}
    assert goals == SEEN_GOALS


def test_more_late_ticks_count_against_the_goal_with_real_time_priority_only() -> None:
    figures = {"without": 0.0, "with": 0.01, "more": 0.01, "pictures": 9.0}
    for priority, met in ((1.0, False), (0.0, None)):
        rows = rows_of({LATE_CASE: figures | {"real time": priority}}, on_gpu=False)
        assert {row.metric: row.met for row in rows}[LATE_MORE] is met


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
