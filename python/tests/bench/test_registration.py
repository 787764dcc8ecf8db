"""The benchmark of registration: its goal, its landmarks, and figures from where points lie."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from palpate import OptionError, Volume
from palpate.bench import registration
from palpate.bench.goals import GOALS
from palpate.bench.goals.registration import (
    ELASTIX_CASE,
    LUNG_ROWS,
    METRICS,
    MODALITY_ROWS,
    STARTS,
    modality_case,
    registered_case,
)
from palpate.cli.commands import run
from palpate.registration.options import KINDS


def test_the_goal_is_ten_percent_beside_elastix() -> None:
    table = {(row.case, row.metric): row.goal for row in LUNG_ROWS}
    assert len(table) == len(LUNG_ROWS), "a row stands twice"
    assert set(LUNG_ROWS) <= set(GOALS["register"])
    goals = {key: goal for key, goal in table.items() if goal is not None}
    assert goals == {(registered_case("bspline"), "mean by elastix' mean"): 1.1}
    assert {case for case, _ in table} == {*map(registered_case, KINDS), ELASTIX_CASE}


def test_corners_by_mutual_information_have_a_goal_for_each_start() -> None:
    assert set(MODALITY_ROWS) <= set(GOALS["register"])
    goals = {(row.case, row.metric): row.goal for row in MODALITY_ROWS if row.goal is not None}
    cases = [modality_case(kind, METRICS[0], off) for kind in ("rigid", "affine") for off in STARTS]
    assert goals == {(case, "corners apart, most"): 1.0 for case in cases}


def test_landmarks_are_middles_of_voxels(tmp_path: Path) -> None:
    path = tmp_path / "points.txt"
    path.write_text("index\n2\n0 0 0\n3 2 1\n")
    scan = Volume(np.zeros((4, 4, 4), np.int16), spacing=(1.0, 2.0, 3.0), origin=(-5.0, 6.0, 7.0))
    found = registration.landmarks_of(path, scan)
    np.testing.assert_allclose(found, [[-5.0, 6.0, 7.0], [-2.0, 10.0, 10.0]])
    path.write_text("index\n3\n0 0 0\n3 2 1\n")
    with pytest.raises(OptionError, match="and so many lines of X Y Z"):
        registration.landmarks_of(path, scan)


def test_figures_are_distances_to_the_marked_places() -> None:
    here = np.zeros((2, 3))
    there = np.array([[0.0, 0.0, 10.0], [0.0, 20.0, 0.0]])
    found = {registered_case(kind): (there + np.array([3.0, 0.0, 0.0]), 1.5) for kind in KINDS}
    found[ELASTIX_CASE] = (there * 1.2, 2.0)
    rows = {(row.case, row.metric): row for row in registration.rows_of(found, here, there)}
    ours, theirs = registered_case("bspline"), ELASTIX_CASE
    assert rows[ours, "landmarks apart before, mean"].value == pytest.approx(15.0)
    assert rows[theirs, "landmarks apart, mean"].value == pytest.approx(3.0)
    assert rows[theirs, "landmarks apart, most"].value == pytest.approx(4.0)
    assert rows[ours, "mean by elastix' mean"].value == pytest.approx(1.0)
    assert rows[ours, "mean by elastix' mean"].met is True
    assert rows[ours, "processor time"].value == 1.5


def test_without_elastix_it_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "itk", None)
    assert run(["bench", "register"]) == 2
    assert "elastix is not installed; allowed: with it" in capsys.readouterr().err
