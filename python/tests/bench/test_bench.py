"""Benchmarks report every figure that has a goal."""

from __future__ import annotations

import itertools
import json
from pathlib import Path

import numpy as np
import palpate
import pytest
from palpate import OptionError, Scene, Volume, _core  # noqa: TID251  # the table is held against it
from palpate.bench import haptics, stress
from palpate.bench.goals import GOALS
from palpate.bench.goals.haptics import IMPROVED, haptics_rows
from palpate.bench.goals.passivity import DEFAULT_STIFFNESS
from palpate.bench.goals.quality import EXACT_TOUCHES, STROKES, TOUCHES
from palpate.bench.haptics_data import SOURCES, ground_of, skin
from palpate.bench.passivity import measure as rub_rows
from palpate.bench.passivity import rub
from palpate.bench.quality import all_cases, feel
from palpate.bench.report import Row, print_rows, write_rows

NAMED = {
    ("detection, 4 voxels, exact, r 0", "rate"): (15.0, "M/s", "higher"),
    ("hard proxy, exact, r 0", "rate"): (2.0, "M/s", "higher"),
    ("complete tick, exact, r 0", "rate"): (1.0, "M/s", "higher"),
    ("complete tick, exact, r 1", "rate"): (0.4, "M/s", "higher"),
    ("complete tick, exact, r 2", "rate"): (0.4, "M/s", "higher"),
    ("complete tick, exact, r 5", "rate"): (0.15, "M/s", "higher"),
    **{
        (f"complete tick, exact, r {radius}", "p99.9"): (20.0, "µs", "lower")
        for radius in (0, 1, 2, 5)
    },
    **{
        (f"{work}, exact, r {radius}", "in contact"): (95.0, "%", "higher")
        for work in ("hard proxy", "complete tick")
        for radius in (0, 1, 2, 5)
    },
}
"""Goals of the design's section 8."""

TIMED = (
    *(
        f"{work}, exact, r {radius}"
        for work in (*(f"detection, {way}" for way in ("1 voxel", "4 voxels", "10 voxels")),
                     "hard proxy", "complete tick")
        for radius in (0, 1, 2, 5)
    ),
    *(
        f"{work}, {model}, r 0"
        for work in ("detection, 4 voxels", "hard proxy", "complete tick")
        for model in ("thesis-original", "thesis-improved")
    ),
)  # fmt: skip
"""What the issue that asked for this benchmark names."""

SCANNED = ("CThead bone", "AMOS bone", "LIDC bone", "phantom 520×512×512", "phantom 1024³")
BALL = "ball: "


def test_every_named_goal_stands_in_the_table() -> None:
    table = {(row.case, row.metric): row for row in GOALS["haptics"]}
    assert len(table) == len(GOALS["haptics"]), "a row stands twice"
    for ground in SCANNED:
        for (case, metric), (goal, unit, better) in NAMED.items():
            row = table[f"{ground}: {case}", metric]
            assert (row.goal, row.unit, row.better) == (goal, unit, better)
    for work in ("hard proxy", "complete tick"):
        row = table[f"CThead bone in 113×256×256 and in 1024³: {work}", "ratio"]
        assert (row.goal, row.better) == (0.8, "higher")


def test_every_ground_has_a_row_for_each_case() -> None:
    table = {(row.case, row.metric) for row in GOALS["haptics"]}
    for ground in (*SCANNED, "LIDC bones and skin"):
        for case in TIMED:
            for metric in ("rate", "median", "p99", "p99.9", "max"):
                assert (f"{ground}: {case}", metric) in table


def test_of_many_segments_the_figures_are_told_only() -> None:
    goals = {
        (row.metric, row.goal)
        for row in GOALS["haptics"]
        if row.case.startswith("LIDC bones and skin: ") and row.goal is not None
    }
    assert goals == {("in contact", 95.0)}


def test_rows_have_median_and_tail_of_each_case(ball_scene: Scene) -> None:
    rows = haptics.measure_ground("ball", next(iter(ball_scene)).segment, 1000)
    for case in TIMED:
        figures = {row.metric: row.value for row in rows if row.case == BALL + case}
        # a call that is as short as the reading of the clock takes no time beside it
        assert 0.0 <= figures["median"] <= figures["p99"] <= figures["p99.9"] <= figures["max"]
        assert figures["rate"] > 0.0
    told = {(row.case.removeprefix(BALL), row.metric): row for row in rows}
    assert told.keys() >= NAMED.keys()
    ratio = told["hard proxy, exact, r 0", "ratio to thesis-improved"]
    assert (ratio.unit, ratio.goal, ratio.better) == ("x", None, "higher")
    rates = [told[f"hard proxy, {model}, r 0", "rate"].value for model in ("exact", IMPROVED)]
    assert ratio.value == pytest.approx(rates[0] / rates[1])


def test_models_of_the_thesis_have_no_goals() -> None:
    goals = {row.goal for row in GOALS["haptics"] if "thesis" in row.case}
    assert goals == {None}


def test_figures_of_others_stand_beside_ours_without_a_ratio() -> None:
    rows = {row.case: row for row in haptics.published()}
    assert rows["published: thesis table 4.1, response, Torso 520×512×512"].value == 0.138
    assert rows["published: thesis table 4.2, improved response, Head small 113×256×256"].value == (
        0.146
    )
    assert rows["published: CHAI3D 3.3, full update, heart CT, r 5"].value == 0.07
    assert {(row.metric, row.unit, row.goal) for row in rows.values()} == {("rate", "M/s", None)}


def test_a_body_in_a_larger_scan_is_compared(
    ball_scene: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(haptics, "EMBEDDED_IN", (130, 150, 140))
    ground = ground_of(next(iter(ball_scene)).segment)
    rows = haptics.measure_embedded(ground, haptics.Effort(1000, 5))
    assert [(row.case, row.metric) for row in rows] == [
        (goal.case, goal.metric)
        for goal in GOALS["haptics"]
        if goal.case.startswith("CThead bone in 113×256×256")
    ]
    figures = {(row.case.partition(": ")[2], row.metric): row.value for row in rows}
    rates = [figures["hard proxy", name] for name in ("rate, 1024³", "rate, small")]
    assert figures["hard proxy", "ratio"] == pytest.approx(rates[0] / rates[1])
    # a single call can be as short as the reading of the clock, which is taken off
    assert figures["hard proxy, cold random starts, 1024³", "median"] >= 0.0


def test_a_data_set_that_is_not_there_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from palpate.cli.commands import run

    monkeypatch.setenv("PALPATE_DATA", str(tmp_path))
    path = tmp_path / "b.json"
    named = ["--data", "AMOS bone", "--data", "CThead bone in 113×256×256 and in 1024³"]
    assert run(["bench", "haptics", "--quick", *named, "--json", str(path)]) == 0
    rows = {row["case"]: row for row in json.loads(path.read_text())["rows"]}
    told = rows["AMOS bone"]
    assert told["metric"] == "left out: no amos_0336/amos_0336.mhd (PALPATE_DATA)"
    assert (told["value"], told["goal"]) == (0.0, None)
    assert (
        "left out: no cthead_stanford/CThead.mha"
        in (rows["CThead bone in 113×256×256 and in 1024³"]["metric"])
    )
    assert "left out" in capsys.readouterr().out


def test_the_skin_is_the_outer_3_mm_of_the_body() -> None:
    z, y, x = np.mgrid[0:20, 0:40, 0:40].astype(float)
    from_axis = np.hypot(x - 20.0, y - 20.0)
    values = np.where(from_axis < 15.0, 0, -1000).astype(np.int16)
    # a lung that is open above, and a table
    values[(from_axis < 6.0) & (z > 4.0)] = -900
    values[:, 38:, :] = 0
    volume = Volume(values, spacing=(1.0, 1.0, 2.0))
    skin_of = skin(volume)
    # to half a voxel, in the voxel's middle
    assert not skin_of[(from_axis > 15.0) | (from_axis < 11.0)].any()
    assert skin_of[(from_axis < 14.5) & (from_axis > 12.5)].all()
    # also where the scan ends: it has no skin there
    assert skin_of[0].sum() == skin_of[10].sum()


@pytest.mark.long
@pytest.mark.data
def test_all_bones_and_the_skin_of_a_chest_are_touched(
    data_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PALPATE_DATA", str(data_folder))
    source = next(source for source in SOURCES if source.name == "LIDC bones and skin")
    bench = _core.TouchBench(source.load(), 1.0, 2000, 1)
    assert bench.run("tick")["contact_share"] > 0.95


@pytest.mark.data
def test_bones_of_scans_are_found(data_folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PALPATE_DATA", str(data_folder))
    for name in ("CThead bone", "AMOS bone"):
        source = next(source for source in SOURCES if source.name == name)
        assert _core.TouchBench(source.load(), 5.0, 2000, 1).run("proxy")["contact_share"] > 0.95


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


def test_what_is_not_allowed_is_refused(ball_scene: Scene) -> None:
    ball = next(iter(ball_scene)).segment
    with pytest.raises(OptionError, match="allowed"):
        haptics.measure_ground("ball", ball, 0)
    with pytest.raises(OptionError, match="or CThead bone"):
        haptics.sources(["CThead"])
    with pytest.raises(ValueError, match="allowed: 'detection, 1 voxel'"):
        _core.TouchBench(ground_of(ball), 0.0, 10, 1).run("deformation")
    with pytest.raises(ValueError, match="allowed: a point"):
        _core.TouchBench(ground_of(ball), 1.0, 10, 1).run("proxy", "thesis-original")
    with pytest.raises(ValueError, match="or more"):
        ground_of(ball).embedded((8, 100, 100))


def test_the_command_measures_a_scan_and_writes_its_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from palpate.cli.commands import run

    made = palpate.phantom((100, 70, 135)).volume
    path = tmp_path / "scan.nrrd"
    import SimpleITK

    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(made.array), str(path))
    options = ["--data", str(path), "--json", str(tmp_path / "b.json"), "--quick"]
    assert run(["bench", "haptics", *options]) == 0
    rows = json.loads((tmp_path / "b.json").read_text())["rows"]
    ours = [row["case"] for row in rows if not row["case"].startswith("published: ")]
    assert len(ours) == len(haptics_rows("any"))
    assert all(case.startswith("bone of scan.nrrd: ") for case in ours)
    assert "complete tick, exact, r 5" in capsys.readouterr().out


# --- touch-quality -----------------------------------------------------------------------

QUALITY_NAMED = {
    ("plane, cubes", "direction mean"): 3.0,
    ("sphere, cubes", "direction 95 %"): 8.0,
    ("torus, 0.7×0.7×2.5", "direction mean"): 6.0,
    ("plane, 0.7×0.7×2.5", "direction 95 %"): 12.0,
    ("plane below 10°, cubes", "ripple"): 0.05,
    ("plane, 0.7×0.7×2.5", "ripple"): 0.05,
    ("plane, cubes", "lag"): 0.5,
    ("sphere, 0.7×0.7×2.5", "lag"): 0.5,
    ("torus, cubes", "lag"): 1.5,
    ("bore, cubes", "jitter"): 0.0,
    ("shell of 1, 0.7×0.7×2.5", "pop-throughs"): 0.0,
    ("shell of 3, cubes", "solid samples"): 0.0,
    ("wedge, cubes", "stuck"): 0.0,
    ("sphere, cubes", "stuck"): 0.0,
    ("step up, cubes", "force step"): 0.1,
    ("torus, cubes", "in contact"): 95.0,
}
"""Goals of the issue that asked for this benchmark, by body and grid, for every stroke."""


def test_touch_has_every_named_goal_on_every_stroke() -> None:
    table = {(row.case, row.metric): row for row in GOALS["touch-quality"]}
    assert len(table) == len(GOALS["touch-quality"]), "a row stands twice"
    for (body, metric), goal in QUALITY_NAMED.items():
        for touch, (depth, step) in itertools.product(EXACT_TOUCHES, STROKES):
            row = table[f"{touch}: {body}, {depth:g} h deep, {step:g} h a move", metric]
            better = "higher" if metric == "in contact" else "lower"
            assert (row.goal, row.better) == (goal, better)
            magnitude = table[row.case, "magnitude RMSE"]
            if body.startswith(("plane,", "sphere", "torus")):
                assert magnitude.goal == {5.0: 5.0, 2.0: 10.0}[depth]


def test_the_cases_of_the_table_are_those_of_the_engine() -> None:
    told = list(dict.fromkeys(row.case for row in GOALS["touch-quality"]))
    assert told == [f"{touch}: {case}" for touch in TOUCHES for case in all_cases()]


def test_other_ways_of_touch_have_no_goals() -> None:
    rows = [row for row in GOALS["touch-quality"] if not row.case.startswith("exact")]
    assert rows
    assert all(row.goal is None for row in rows)


def test_a_case_or_touch_that_does_not_exist_is_refused() -> None:
    with pytest.raises(OptionError, match="allowed"):
        feel("a cube", "exact")
    with pytest.raises(OptionError, match="'thesis-improved'"):
        feel(all_cases()[0], "thesis")  # type: ignore[arg-type]


@pytest.mark.long
def test_the_quality_command_writes_its_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from palpate.cli.commands import run

    path = tmp_path / "q.json"
    assert run(["bench", "touch-quality", "--touch", "thesis-improved", "--json", str(path)]) == 0
    rows = json.loads(path.read_text())["rows"]
    assert len(rows) == len(GOALS["touch-quality"]) // len(TOUCHES)
    assert all(row["case"].startswith("thesis-improved: ") for row in rows)
    figures = {(row["case"], row["metric"]): row["value"] for row in rows}
    # what the thesis' errata found: it moves at rest, and crosses a thin shell
    case = "thesis-improved: {}, cubes, 5 h deep, 0.2 h a move"
    assert figures[case.format("plane"), "jitter"] > 0.0
    assert figures[case.format("shell of 1"), "pop-throughs"] > 0.0
    printed = capsys.readouterr().out
    assert "thesis-improved: cubes, 5 h deep, 0.2 h a move" in printed
    assert printed.count("shell of 2") == 8
    assert run(["bench", "touch-quality", "--touch", "thesis"]) == 2


# --- stress ------------------------------------------------------------------------------


def test_random_moves_break_no_promise(ball_scene: Scene) -> None:
    bone = next(iter(ball_scene)).segment
    found = stress.measure(bone, stress.Plan(seed=3), moves=300_000)
    assert found.violation is None
    assert found.moves >= 300_000
    figures = {row.metric: row for row in stress.rows_of(found)}
    assert (figures["violations"].value, figures["violations"].goal) == (0.0, 0.0)
    assert figures["violations"].met
    assert figures["moves"].value == pytest.approx(found.moves / 1e6)


def test_the_same_violation_is_found_on_any_threads(ball_scene: Scene) -> None:
    bone = next(iter(ball_scene)).segment
    plan = stress.Plan(seed=3, model="thesis-improved")
    one, two = (stress.measure(bone, plan, moves=1000, threads=count) for count in (1, 2))
    assert one.violation is not None
    assert one.violation == two.violation


def test_a_violation_is_told_and_replayed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from palpate.cli.commands import run

    case, rows = tmp_path / "case.json", tmp_path / "rows.json"
    options = ["--model", "thesis-improved", "--case", str(case), "--json", str(rows)]
    assert run(["bench", "stress", "--moves", "100000", *options]) == 1
    first = capsys.readouterr().out
    told = json.loads(case.read_text())
    assert told["model"] == "thesis-improved"
    assert told["guarantee"] in (1, 2)
    figures = {row["metric"]: row for row in json.loads(rows.read_text())["rows"]}
    assert figures["violations"]["value"] == 1.0

    assert run(["bench", "stress", "--replay", str(case)]) == 1
    again = capsys.readouterr().out
    assert told["what"] in first
    assert told["what"] in again
    # with the model that touch uses the same run is clean
    case.write_text(json.dumps({**told, "model": "exact"}))
    assert run(["bench", "stress", "--replay", str(case)]) == 0


def test_what_is_no_stress_is_refused(tmp_path: Path, ball_scene: Scene) -> None:
    from palpate.cli.commands import run

    bone = next(iter(ball_scene)).segment
    with pytest.raises(OptionError, match="allowed: 1 or more"):
        stress.measure(bone, stress.Plan(seed=1), moves=0)
    with pytest.raises(OptionError, match="allowed: 1 to 256"):
        stress.measure(bone, stress.Plan(seed=1), moves=1, threads=0)
    with pytest.raises(OptionError, match="allowed: 0 to"):
        stress.Plan(seed=-1)
    with pytest.raises(OptionError, match="allowed: 'exact'"):
        stress.again(bone, stress.Plan(seed=1, model="CHAI3D"))
    bad = tmp_path / "bad.json"
    for text in ("{}", "[]", "no json", '{"seed": 1, "run": "a", "model": "exact", "data": null}'):
        bad.write_text(text)
        with pytest.raises(OptionError, match="allowed: a file that it wrote"):
            stress.Plan.of_file(bad)
    assert run(["bench", "stress", "--replay", str(tmp_path / "none.json")]) == 2


# --- passivity ---------------------------------------------------------------------------


def test_every_device_wall_and_rate_has_its_goals() -> None:
    table = {(row.case, row.metric): row for row in GOALS["passivity"]}
    assert len(table) == len(GOALS["passivity"]), "a row stands twice"
    assert list(DEFAULT_STIFFNESS) == _core.passivity_devices()
    for device, stiffness in DEFAULT_STIFFNESS.items():
        for wall in ("flat wall", "bone"):
            for rate in (1, 2, 4):
                case = f"{device}, {rate} kHz, {wall}"
                energy = table[case, "net energy to the hand"]
                assert (energy.goal, energy.better) == (0.0, "lower")
                # what a device begins with must be passive
                assert table[case, "largest passive"].goal == stiffness


def test_the_goal_of_stiffness_is_what_the_device_begins_with() -> None:
    for device, stiffness in DEFAULT_STIFFNESS.items():
        told = rub(device, 1000, seconds=3.0, search_seconds=1.0)
        assert told["stiffness"] == stiffness, device


def test_a_device_gives_no_energy_on_a_wall_and_on_a_ball(ball_scene: Scene) -> None:
    ball = next(iter(ball_scene)).segment
    rows = rub_rows(ball, seconds=6.0, devices=["simulated"])
    assert {row.met for row in rows if row.metric == "net energy to the hand"} == {True}
    assert {row.met for row in rows if row.metric == "largest passive"} == {True}
    assert all(row.value > 5.0 for row in rows if row.metric == "in contact")


@pytest.mark.parametrize(
    ("device", "rate", "seconds"),
    [("knife", 1000, 3.0), ("Touch", 10, 3.0), ("Touch", 1000, float("nan"))],
)
def test_runs_that_are_not_allowed_are_refused(device: str, rate: int, seconds: float) -> None:
    with pytest.raises(OptionError, match="allowed"):
        rub(device, rate, seconds=seconds, search_seconds=1.0)


def test_the_command_of_passivity_writes_its_file(tmp_path: Path) -> None:
    from palpate.cli.commands import run

    file = tmp_path / "p.json"
    options = ["--seconds", "3", "--device", "Touch", "--json", str(file)]
    assert run(["bench", "passivity", *options]) == 0
    rows = json.loads(file.read_text())["rows"]
    assert len(rows) == len(GOALS["passivity"]) // len(DEFAULT_STIFFNESS)
    assert run(["bench", "passivity", "--device", "knife"]) == 2
