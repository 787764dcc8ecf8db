"""The benchmark of surfaces has its goals, says what it lacks, and its figures are true."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from palpate import OptionError, Volume, phantom
from palpate.bench import surface
from palpate.bench.flying_edges import FlyingEdges
from palpate.bench.goals import GOALS
from palpate.bench.goals.surface import DRILLED, SPHERES, SURFACES, sphere_case
from palpate.bench.haptics_data import MissingDataError
from palpate.bench.report import row_of
from palpate.cli.commands import run


def test_every_goal_of_surfaces_stands_in_the_table() -> None:
    table = {(row.case, row.metric): row for row in GOALS["surface"]}
    assert len(table) == len(GOALS["surface"]), "a row stands twice"
    for bone in SURFACES:
        for threads in ("one thread", "all threads"):
            for kind in ("vtkFlyingEdges3D", "vtkDiscreteFlyingEdges3D"):
                row = table[f"{bone}: {threads}", f"ratio to {kind}"]
                assert (row.goal, row.better) == (1.0, "higher")
        for kind in ("area", "volume"):
            row = table[f"{bone}: shape", f"{kind} beside VTK's"]
            assert (row.goal, row.unit, row.better) == (1.0, "%", "lower")
    assert (table[DRILLED, "median"].goal, table[DRILLED, "95 %"].goal) == (5.0, 5.0)
    assert SPHERES == {20.0: 1.0, 5.0: 3.0}


def test_without_vtk_it_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "vtk", None)
    with pytest.raises(OptionError, match="palpate"):
        surface.measure()
    assert run(["bench", "surface"]) == 2
    assert "pip install 'palpate[bench]'" in capsys.readouterr().err


def test_smoothed_spheres_meet_their_goals() -> None:
    reports = surface.spheres()
    goals = [goal for goal in GOALS["surface"] if goal.case in map(sphere_case, SPHERES)]
    assert len(goals) == 4
    for goal in goals:
        row = row_of(goal, reports[goal.case])
        assert row.met, row


def test_a_drill_is_timed_and_leaves_the_surface_as_it_was() -> None:
    made = phantom((60, 42, 80)).volume.offered_bone()
    bone = surface.bone_of(made)
    figures = surface.drill(bone, edits=5)
    assert set(figures) == {"median", "p95", "max"}
    assert 0.0 < figures["median"] <= figures["p95"] <= figures["max"]

    internal = bone.surface(None)
    before = internal.mesh()
    _, y, x = np.argwhere(made.mask())[0]
    assert internal.time_drill((int(x), int(y), 40), 5, 2) > 0.0
    for old, new in zip(before, internal.mesh(), strict=True):
        np.testing.assert_array_equal(old, new)


def test_a_data_set_that_is_missing_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def nowhere() -> surface.Bone:
        raise MissingDataError("CThead.mha")

    def small(_name: str, _bone: surface.Bone) -> dict[str, dict[str, float]]:
        raise AssertionError("nothing is there to be measured")

    monkeypatch.setattr(FlyingEdges, "check", lambda: None)
    monkeypatch.setattr(surface, "whole_surface", small)
    monkeypatch.setattr(surface, "LOADS", dict.fromkeys(SURFACES, nowhere))
    rows, missing = surface.measure()
    assert missing == [f"{name}: CThead.mha" for name in SURFACES]
    assert {row.case for row in rows} == set(map(sphere_case, SPHERES))


def test_a_surface_of_the_bits_has_the_area_and_volume_of_its_shape() -> None:
    values = np.zeros((12, 14, 16), np.int16)
    values[2:10, 2:12, 2:14] = 1
    segment = Volume(values, spacing=(0.5, 1.0, 2.0)).threshold(1)
    made = surface.bone_of(segment).surface(0)
    # a box of 6 x 10 x 16 mm, whose edges are cut by half a voxel
    assert made.volume() == pytest.approx(960.0, rel=0.03)
    assert made.area() == pytest.approx(2 * (60.0 + 96.0 + 160.0), rel=0.06)
