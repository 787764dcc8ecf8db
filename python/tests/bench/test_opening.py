"""What ``palpate bench open`` writes and tells."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import palpate
import pytest
from palpate.bench.goals import GOALS
from palpate.bench.opening import rows_of, write_series
from palpate.volumes.volume import Volume


def test_the_series_is_the_scan_with_more_slices(tmp_path: Path) -> None:
    values = (np.arange(3)[:, None, None] * 100 + np.arange(20).reshape(4, 5)).astype(np.int16)
    flipped = np.diag([1.0, -1.0, 1.0])
    scan = Volume(values, spacing=(0.7, 0.7, 2.5), origin=(-3.0, 40.0, 7.0), direction=flipped)
    write_series(scan, tmp_path, slices=5)
    volume = palpate.read(tmp_path)
    assert volume.dimensions == (5, 4, 5)
    assert volume.spacing == (0.7, 0.7, 1.25)
    # the normal of slices whose rows run to the front points down: the series is turned over
    assert volume.orientation == "LAI"
    np.testing.assert_array_equal(volume.array[::-2], scan.array)
    np.testing.assert_array_equal(volume.array[3, 0], 50 + np.arange(5))
    corner = np.linalg.inv(volume.patient_from_grid) @ (-3.0, 40.0, 7.0, 1.0)
    np.testing.assert_allclose(corner[:3], (0.5, 0.5, 4.5), atol=1e-6)


def test_every_goal_has_its_row_and_the_budget_is_that_of_the_design() -> None:
    times = {"picture": [4.0, 9.0, 3.0], "read": [1.0, 2.0, 1.5], "itk": [3.0]}
    times |= {"served": [2.0], "whole": [9.5]}
    rows = rows_of(times, 512 * 512 * 275 * 2)
    # processor time is told where the kernel tells it
    used = {"page": [1.0, 3.0, 2.0], "graphics": [4.0], "rest": [0.5]}
    assert len(rows) == len(GOALS["open"]) - len(used)
    told = {row.metric: row.value for row in rows_of(times | used, 1)}
    assert len(told) == len(GOALS["open"])
    assert told["processor time until it, page"] == 2.0
    assert [(row.metric, row.goal) for row in rows if row.goal is not None] == [
        ("command to first picture", 5.0)
    ]
    told = {row.metric: row.value for row in rows}
    assert told["command to first picture"] == 4.0
    assert told["SimpleITK's time by ours"] == pytest.approx(2.0)
    assert told["memory of the values"] == pytest.approx(137.5)
