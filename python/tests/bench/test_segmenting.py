"""What ``palpate bench segment`` measures: counts and shapes, never times."""

from __future__ import annotations

import numpy as np
from palpate.bench import growing
from palpate.bench.goals import GOALS
from palpate.bench.segmenting import drawn_out, rows_of, surface_seconds
from palpate.volumes.volume import Volume


def test_a_scan_is_drawn_out_over_the_same_length() -> None:
    values = (np.arange(3)[:, None, None] * 100 + np.arange(20).reshape(4, 5)).astype(np.int16)
    long = drawn_out(Volume(values, spacing=(0.7, 0.7, 2.5), origin=(-3.0, 40.0, 7.0)), 5)
    assert long.spacing == (0.7, 0.7, 1.25)
    np.testing.assert_array_equal(long.array[::2], values)
    np.testing.assert_array_equal(long.array[3, 0], 150 + np.arange(5))


def test_a_threshold_is_waited_for_until_its_own_surface_is_there() -> None:
    z, y, x = np.indices((24, 24, 24))
    off = np.linalg.norm(np.stack([x, y, z]) - 11.5, axis=0)
    volume = Volume((1000.0 - 80.0 * off).astype(np.int16), spacing=(1.0, 1.0, 1.0))
    small = surface_seconds(volume, (200.0, 700.0), runs=1)
    large = surface_seconds(volume, (700.0, 200.0), runs=2)
    # radii of 3.75 and 10 mm: areas differ by a factor of 7
    assert 4.0 < large["triangles"] / small["triangles"] < 10.0


def test_every_goal_has_its_row() -> None:
    report = {goal.key: 1.0 for goal in GOALS["segment"]}
    rows = rows_of(report)
    assert [row.metric for row in rows] == [goal.metric for goal in GOALS["segment"]]
    assert {row.metric: row.goal for row in rows if row.goal is not None} == {
        "asked to surface": 1.0,
        "growing": 2.0,
        "Dice": 0.85,
        "file to session": 5.0,
    }


def test_clicks_are_counted_by_what_came_of_them_and_every_goal_has_its_row() -> None:
    ends: list[growing.End] = ["found", "found", "told", "leaked", "short"]
    tries = [
        (organ, growing.Try((0.0, 0.0, 0.0), end, 0.9, 1.0, 2.0, 3.0, "no" * (end == "told")))
        for organ in growing.ORGANS
        for end in ends
    ]
    rows = growing.rows_of(tries, 0.02)
    assert [(row.case, row.metric) for row in rows] == [
        (goal.case, goal.metric) for goal in GOALS["segment --grow"]
    ]
    everything = {row.metric: row.value for row in rows if row.case.endswith("all")}
    count = len(growing.ORGANS)
    assert (everything["found"], everything["stopped and told"]) == (2 * count, count)
    assert (everything["leaked in silence"], everything["short in silence"]) == (count, count)


def test_seeds_are_deep_and_off_the_border_and_a_ball_is_found() -> None:
    volume, mask = growing.crisp_ball(10.0, (1.0, 1.0, 1.5))
    seeds = growing.seeds_of(mask, volume)
    assert seeds == growing.seeds_of(mask, volume)
    off = np.linalg.norm(np.array(seeds) - 0.5 * np.array(volume.dimensions) * (1, 1, 1.5), axis=1)
    assert off[0] < 1.6
    assert (off < 7.5).all()
    found = growing.tried(volume, mask, seeds[0])
    assert (found.end, found.dice) == ("found", 1.0)
    none = growing.tried(volume, ~mask, seeds[0])
    assert none.end == "short"
