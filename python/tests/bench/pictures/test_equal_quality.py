"""Renderers are compared at equal errors, and what is not installed is told."""

from __future__ import annotations

import sys

import numpy as np
import palpate
import pytest
from palpate import OptionError
from palpate.bench.goals.seen import SEEN_ROWS, VTK_CASE, VTK_JS_CASE
from palpate.bench.pictures.beside_vtk import Engine, beside_vtk
from palpate.bench.pictures.equal_quality import (
    LEAST,
    MOST,
    NARROW,
    TimedPicture,
    compared,
    steps_for,
    times_of,
)
from palpate.session.session import Session
from palpate.volumes.scene import Scene


@pytest.mark.parametrize("wanted", [0.3, 1.0, 2.2, 7.0])
def test_the_fewest_steps_are_found_with_which_an_error_is_small_enough(wanted: float) -> None:
    asked: list[float] = []

    def error(steps: float) -> float:
        asked.append(steps)
        return 1.0 / steps

    steps = steps_for(error, 1.0 / wanted)
    assert wanted <= steps <= wanted * 2.0**NARROW
    assert len(asked) <= 8


def test_steps_stay_in_their_range() -> None:
    assert steps_for(lambda _: 1.0, 0.5) == MOST
    assert steps_for(lambda _: 0.1, 0.5) == LEAST


def test_times_are_medians_of_rounds_in_changing_order_without_the_first() -> None:
    order: list[str] = []
    times = {"a": iter([9.0, 1.0, 2.0, 6.0]), "b": iter([9.0, 5.0, 3.0, 4.0])}

    def run(name: str) -> float:
        order.append(name)
        return next(times[name])

    assert times_of([lambda: run("a"), lambda: run("b")], 3) == [2.0, 4.0]
    assert order == ["b", "a", "a", "b", "b", "a", "a", "b"]


def test_the_other_renderer_gets_the_steps_that_its_own_fine_picture_asks_for() -> None:
    def renderer(seconds: float, error: float, brightness: float):  # type: ignore[no-untyped-def]  # noqa: ANN202
        def draw(steps: float) -> TimedPicture:
            off = error * (1.0 / steps - 1.0 / 16.0)
            return TimedPicture(seconds * steps, np.full((2, 2, 3), brightness + off))

        return draw

    found = compared(renderer(1.0, 0.1, 0.2), renderer(0.8, 0.2, 0.5), rounds=1)
    # 0.2 (1/s − 1/16) ≤ 0.1 (1 − 1/16) from s = 32/17 on
    assert 32.0 / 17.0 <= found.steps <= 32.0 / 17.0 * 2.0**NARROW
    assert found.theirs_off <= found.ours_off == pytest.approx(0.1 * 15.0 / 16.0)
    report = found.report()
    assert report["ratio"] == pytest.approx(0.8 * found.steps)
    assert report["same ratio"] == pytest.approx(0.8)
    assert {row.key for row in SEEN_ROWS if row.case == VTK_JS_CASE} == set(report)
    assert {row.key for row in SEEN_ROWS if row.case == VTK_CASE} == {*report, "whole"}


def test_without_vtk_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "vtk", None)
    values = np.full((8, 8, 8), 100, np.int16)
    values[2:6, 2:6, 2:6] = 900
    with pytest.raises(OptionError, match=r"vtk is not installed; .*palpate\[bench\]"):
        beside_vtk(palpate.Volume(values, spacing=(1.0, 1.0, 1.0)), rounds=1, size=(16, 16))


def test_the_engine_is_nearer_to_its_fine_picture_with_more_steps() -> None:
    z, y, x = np.mgrid[0:32, 0:32, 0:32] - 16.0
    values = np.where(x * x + y * y + z * z <= 12.0**2, 900, -1000).astype(np.int16)
    volume = palpate.Volume(values, spacing=(1.0, 1.0, 1.0))
    with Session(Scene(volume)) as session:
        plain = Engine.of(session, volume, (64, 64)).plain()
        fine, one, two = (plain.draw(steps).screen for steps in (16.0, 1.0, 2.0))
    assert fine.max() > 0.2
    assert np.abs(two - fine).mean() < np.abs(one - fine).mean()
