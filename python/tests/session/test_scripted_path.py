"""Scripted paths: straight moves at even speed."""

from __future__ import annotations

import numpy as np
import pytest
from palpate import OptionError, ScriptedPath


def test_a_path_is_made_step_by_step() -> None:
    path = ScriptedPath((0.0, 0.0, 0.0)).move((2.0, 0.0, 0.0), seconds=1.0).hold(0.5)
    np.testing.assert_array_equal(
        path.rows, [[0.0, 0.0, 0.0, 0.0], [1.0, 2.0, 0.0, 0.0], [1.5, 2.0, 0.0, 0.0]]
    )
    assert path.duration == 1.5


def test_between_positions_the_way_is_straight_and_at_the_end_it_rests() -> None:
    path = ScriptedPath([(0.0, 0.0, 0.0), (4.0, -2.0, 1.0)], [0.0, 2.0])
    np.testing.assert_allclose(
        path.at([0.0, 0.5, 2.0, 9.0]),
        [(0.0, 0.0, 0.0), (1.0, -0.5, 0.25), (4.0, -2.0, 1.0), (4.0, -2.0, 1.0)],
    )


@pytest.mark.parametrize(
    ("points", "times"),
    [
        ([(0.0, 0.0)], [0.0]),
        ([(0.0, 0.0, 0.0)], [0.0, 1.0]),
        ([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)], [0.0, 0.0]),
        ([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)], [1.0, 2.0]),
        ([(0.0, 0.0, np.nan)], [0.0]),
        ([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)], [0.0, np.inf]),
    ],
)
def test_what_is_no_path_is_refused(points: list[tuple[float, ...]], times: list[float]) -> None:
    with pytest.raises(OptionError, match="allowed"):
        ScriptedPath(points, times)
