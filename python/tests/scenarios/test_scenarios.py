"""The scenarios of the command line on the phantom, and the file that keeps a run."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from palpate.base.errors import OptionError
from palpate.cli.commands import run
from palpate.io.reading import read
from palpate.scenarios.hole import hole_of
from palpate.scenarios.lines import line_into
from palpate.scenarios.palpation import palpate_line
from palpate.scenarios.press_lines import SIDES, PressLine, line_over, square_on
from palpate.scenarios.run import (
    UNITS,
    Lump,
    Press,
    ScenarioEvent,
    ScenarioRun,
    read_run,
    write_run,
)
from palpate.scenarios.scenarios import Body, body_of_scan, run_palpation, run_palpation_map
from palpate.volumes.downsample import merged
from palpate.volumes.split import split_around
from palpate.volumes.volume import Volume


def told(name: str, tmp_path: Path, *options: str | Path) -> ScenarioRun:
    """Runs a scenario, by default on the phantom, with its files; reads what it wrote."""
    table, chart = tmp_path / "run.json", tmp_path / "run.png"
    given = map(str, options)
    assert run(["scenario", name, "--json", str(table), "--plot", str(chart), *given]) == 0
    assert chart.stat().st_size > 10_000
    assert json.loads(table.read_text())["figures"]["violations"] == 0
    return read_run(table)


@pytest.mark.parametrize("name", ["needle-skull", "needle-liver"])
def test_a_needle_rises_at_the_skin_and_at_bone_and_never_comes_into_that(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    driven = told(name, tmp_path)
    assert (driven.scenario, driven.scan, driven.spikes()) == (name, "phantom", 0)
    assert driven.wall_at is not None
    assert max(driven.tip.max(), driven.probe.max()) <= driven.wall_at
    punctured = [event.segment for event in driven.events if event.kind == "punctured"]
    assert punctured[0] == "skin"
    assert ("liver" in punctured) == (name == "needle-liver")
    stopped = next(event for event in driven.events if event.kind == "stopped")
    assert driven.events[-1].kind == "withdrawn"
    # the first rise ends where the skin gives way; at bone it goes up to the limit
    skin = next(event for event in driven.events if event.kind == "punctured")
    before, after = (driven.force[driven.time < event.time] for event in (skin, stopped))
    assert before.max() > 1.0
    assert after.max() < 6.0 <= driven.force.max()
    assert "spikes 0" in capsys.readouterr().out


def test_a_drill_goes_in_with_a_steady_force_and_leaves_a_hole(tmp_path: Path) -> None:
    driven = told("drilling", tmp_path, "--depth", "2", "--speed", "0.2")
    assert driven.spikes() == 0
    assert driven.events[0].kind == "contact"
    volume = driven.samples["volume"]
    assert (np.diff(volume) >= 0.0).all()
    assert volume[-1] > 30.0
    # it stays behind the drive by what the spring of 4 N/mm gives
    behind = driven.travel - driven.tip
    assert behind.max() < driven.force.max() / 4.0 + 0.1
    assert driven.radius == 2.0


@pytest.mark.long
def test_bone_of_particles_is_pushed_aside_to_the_rim_of_the_hole(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pressed = told(
        "drilling", tmp_path, "--particles", "--depth", "3", "--speed", "3", "--softening", "20000"
    )
    assert pressed.scenario == "drilling-particles"
    gone, come = (pressed.samples[name] for name in ("volume", "piled"))
    # afterwards all of it stands somewhere else
    assert gone[-1] == come[-1] > 10.0
    assert pressed.hole is not None
    assert pressed.hole.depth >= 2.0
    assert pressed.hole.rim >= 1.0
    signs = "".join(pressed.hole.section)
    assert {"-", "+", "#"} <= set(signs)
    assert f"{gone[-1]:.0f} mm³ elsewhere" in capsys.readouterr().out


def test_a_hole_is_as_deep_and_its_rim_as_high_as_voxels_show() -> None:
    before = np.zeros((9, 20, 9), dtype=bool)
    before[:, 10:] = True
    after = before.copy()
    after[4, 10:13, 3:6] = False
    after[4, 8:10, 2] = after[4, 9, 6] = True
    hole = hole_of(before, after, column=(4, 4), spacing=(1.0, 0.5, 2.0))
    assert (hole.depth, hole.rim) == (1.5, 1.0)
    rows = [row for row in hole.section if "-" in row or "+" in row]
    assert rows == ["  +      ", "  +   +  ", "###---###", "###---###", "###---###"]


def test_what_is_split_stands_where_it_was() -> None:
    values = np.arange(6 * 5 * 4, dtype=np.int16).reshape(6, 5, 4)
    volume = Volume(values, spacing=(1.0, 2.0, 3.0), origin=(5.0, -3.0, 2.0))
    mask = values % 3 == 0
    point = (volume.patient_from_grid @ np.array([2.0, 3.0, 3.0, 1.0]))[:3]
    small, part = split_around(volume, mask, point, reach=3.0, size=1.0)
    assert small.spacing == (1.0, 1.0, 1.0)
    assert part.shape == small.shape
    # each new voxel holds what was at its centre
    for z, y, x in ((0, 0, 0), (4, 5, 3), (5, 2, 1)):
        place = small.patient_from_grid @ np.array([x + 0.5, y + 0.5, z + 0.5, 1.0])
        i, j, k = np.floor((np.linalg.inv(volume.patient_from_grid) @ place)[:3]).astype(int)
        assert small.array[z, y, x] == values[k, j, i]
        assert part[z, y, x] == mask[k, j, i]


@pytest.mark.parametrize(
    "given",
    [
        ["--softening", "10"],
        ["--particles", "--softening", "0.5"],
        ["--particles", "--radius", "0"],
    ],
)
def test_what_no_particles_can_do_is_refused(
    given: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["scenario", "drilling", *given]) == 2
    assert "allowed:" in capsys.readouterr().err


@pytest.mark.data
def test_a_needle_goes_through_a_real_liver_and_never_into_the_bone_behind_it(
    data_folder: Path, tmp_path: Path
) -> None:
    folder = data_folder / "amos_0336"
    labels = folder / "labels_from_meshes.nii.gz"
    driven = told("needle-liver", tmp_path, folder / "amos_0336.mhd", "--segments", labels)
    assert driven.spikes() == 0
    assert driven.wall_at is not None
    assert max(driven.tip.max(), driven.probe.max()) <= driven.wall_at
    punctured = {event.segment: event for event in driven.events if event.kind == "punctured"}
    assert list(punctured) == ["soft tissue", "liver"]
    # the capsule rises above all that was before it; bone, far behind, to the limit
    capsule = driven.time < punctured["liver"].time
    assert driven.force[capsule].argmax() == np.count_nonzero(capsule) - 1
    # the liver there is some 120 mm thick
    assert driven.wall_at > punctured["liver"].depth + 20.0
    # where the drive stops
    assert driven.force.max() >= 6.0


@pytest.mark.data
@pytest.mark.parametrize("scan", ["cthead_stanford/CThead.mha", "amos_0336/amos_0336.mhd"])
def test_a_drill_makes_a_hole_in_real_bone_and_its_contact_begins_with_its_force(
    scan: str, data_folder: Path, tmp_path: Path
) -> None:
    driven = told("drilling", tmp_path, data_folder / scan)
    assert driven.spikes() == 0
    contact = driven.events[0]
    assert contact.kind == "contact"
    # samples are some ticks apart
    felt = np.flatnonzero(driven.force > 0.0)[0]
    assert driven.time[felt - 1] < contact.time <= driven.time[felt]
    # a burr of 2 mm radius has 34 mm³
    assert driven.samples["volume"][-1] > 30.0
    assert driven.samples["volume"][driven.time < contact.time].max() == 0.0


@pytest.mark.long
def test_soft_tissue_is_stiffer_where_bone_is_near(tmp_path: Path) -> None:
    pressed = told("palpation", tmp_path, "--places", "3", "--depth", "2")
    assert pressed.spikes() == 0
    first, middle, last = pressed.presses
    assert middle.thickness is not None
    assert middle.stiffness > 1.15 * max(first.stiffness, last.stiffness)
    assert middle.force > 1.4 * max(first.force, last.force) > 0.0
    assert set(pressed.samples["press"]) == {0.0, 1.0, 2.0}


@pytest.mark.long
def test_a_stiffer_lump_below_a_flat_face_is_found_by_what_the_ball_feels() -> None:
    z, y, x = np.indices((32, 20, 32))
    block = y >= 5
    lump = ((x - 9) ** 2 + (y - 10) ** 2 + (z - 16) ** 2) * 4.0 <= 7.5**2
    volume = Volume(np.zeros(block.shape, dtype=np.int16), spacing=(2.0, 2.0, 2.0))
    nothing = np.zeros_like(block)
    body = Body(volume=volume, soft={"liver": block}, bone=nothing, tumour=lump)
    felt = run_palpation_map(body, places=3, width=28.0, depth=4.0)
    assert felt.violations == felt.spikes() == 0
    assert felt.lump is not None
    assert felt.lump.hidden == pytest.approx((18.0, 20.0, 32.0))
    assert felt.lump.aside is not None
    # a quarter of the way from place to place
    assert felt.lump.aside < 3.5
    assert felt.lump.times > 1.3
    # far from the lump it feels like liver, of 5.5 kPa
    far = [press.young for press in felt.presses if press.along > 20.0]
    assert far == pytest.approx([5.5] * 3, rel=0.3)


@pytest.mark.long
def test_the_tumour_that_the_phantom_does_not_show_is_on_the_map(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    felt = told("palpation", tmp_path, "--map", "--places", "3", "--length", "24")
    assert felt.lump is not None
    assert len(felt.presses) == 9
    assert felt.lump.times > 1.2
    assert felt.lump.aside is not None
    # as near as places this far apart tell
    assert felt.lump.aside < 12.0
    assert "times the median; the tumour is" in capsys.readouterr().out


def test_a_square_lies_around_what_is_nearest_and_not_where_it_is_steep() -> None:
    volume, mask = slab(9)
    square = square_on(volume, mask, width=12.0, count=3)
    assert square.along == pytest.approx((0.0, 6.0, 12.0) * 3)
    assert square.across == pytest.approx((0.0,) * 3 + (6.0,) * 3 + (12.0,) * 3)
    assert {point[1] for point in square.surface} == {square.surface[0][1]}
    assert square.direction == pytest.approx((0.0, 1.0, 0.0))
    with pytest.raises(OptionError, match="allowed: one that lies on"):
        square_on(volume, mask, width=80.0, count=3)
    ridge = mask.copy()
    ridge[:, :18, :8] = ridge[:, :18, 17:] = False
    assert len(square_on(volume, ridge, width=12.0, count=3).surface) == 9
    with pytest.raises(OptionError, match="no steeper than"):
        square_on(volume, ridge, width=20.0, count=3)
    with pytest.raises(OptionError, match="nothing to press"):
        square_on(volume, np.zeros_like(mask), width=12.0, count=3)
    with pytest.raises(OptionError, match="3 or more"):
        square_on(volume, mask, width=12.0, count=2)


def example() -> ScenarioRun:
    ticks = np.arange(4.0)
    return ScenarioRun(
        scenario="drilling",
        scan="a block",
        layers=("bone",),
        radius=2.0,
        over="time",
        phase=("in", "in", "rest", "out"),
        samples=dict.fromkeys(UNITS, ticks),
        events=(ScenarioEvent(kind="contact", segment="bone", time=1.0, depth=2.0, force=0.5),),
        presses=(
            Press(
                place=(1.0, 2.0, 3.0),
                along=0.0,
                thickness=None,
                depth=1.0,
                force=0.1,
                stiffness=0.2,
                young=5.5,
                across=6.0,
            ),
        ),
        lump=Lump(place=(1.0, 2.0, 3.0), times=1.5, hidden=(1.0, 9.0, 7.0)),
        violations=0,
    )


def test_a_run_comes_back_from_its_file(tmp_path: Path) -> None:
    path = tmp_path / "run.json"
    padded = dataclasses.replace(
        example(), phase=("in",) * 40, samples={name: np.arange(40.0) for name in UNITS}
    )
    write_run(padded, path)
    again = read_run(path)
    for field in dataclasses.fields(ScenarioRun):
        was, now = getattr(padded, field.name), getattr(again, field.name)
        if field.name == "samples":
            assert list(was) == list(now)
            assert all((was[name] == now[name]).all() for name in was)
        else:
            assert was == now, field.name


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"format": "other"}', '{"format": "palpate-scenario-1"}']
)
def test_what_is_no_run_is_refused(text: str, tmp_path: Path) -> None:
    path = tmp_path / "run.json"
    path.write_text(text)
    with pytest.raises(OptionError, match="allowed"):
        read_run(path)


def test_what_is_told_of_a_file_that_is_no_run_has_nothing_of_the_file(tmp_path: Path) -> None:
    path = tmp_path / "scan.mha"
    path.write_bytes(b"ObjectType = Image\n" + bytes(range(256)) * 40)
    with pytest.raises(OptionError, match="no scenario's file") as refused:
        read_run(path)
    assert len(str(refused.value)) < 300 + len(str(path))


@pytest.mark.parametrize("given", [{"depth": -1.0}, {"voxel": 0.0}, {"length": float("nan")}])
def test_what_is_no_length_is_refused(given: dict[str, Any]) -> None:
    volume = Volume(np.zeros((4, 5, 6), np.int16), spacing=(1.0, 1.0, 1.0))
    nothing = np.zeros(volume.shape, bool)
    body = Body(volume=volume, soft={"muscle": nothing}, bone=nothing)
    with pytest.raises(OptionError, match=rf"{next(iter(given))} \S+ mm given; allowed: above 0"):
        run_palpation(body, **given)


def test_columns_of_unequal_lengths_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.json"
    ticks = {name: list(range(40)) for name in UNITS}
    given = {"format": "palpate-scenario-1", "phase": ["in"] * 40, "samples": {**ticks, "x": [1]}}
    path.write_text(json.dumps(given))
    with pytest.raises(OptionError, match="unequal"):
        read_run(path)


def slab(thick: int) -> tuple[Volume, np.ndarray[tuple[int, ...], np.dtype[np.bool_]]]:
    mask = np.zeros((20, 40, 24), dtype=bool)
    mask[:, 10 : 10 + thick, :] = True
    return Volume(np.zeros(mask.shape, dtype=np.int16), spacing=(2.0, 1.0, 3.0)), mask


def test_a_way_into_bone_begins_before_it_and_ends_as_deep_as_asked() -> None:
    volume, mask = slab(9)
    start, target = line_into(volume, mask, depth=4.0, margin=3.0)
    grid = np.linalg.inv(volume.patient_from_grid)
    first, last = ((grid @ np.append(point, 1.0))[1] for point in (start, target))
    assert (first, last) == pytest.approx((7.0, 14.0))
    with pytest.raises(OptionError, match="allowed"):
        line_into(volume, np.zeros_like(mask), depth=4.0, margin=3.0)


def test_a_line_over_bone_crosses_what_is_near_the_surface() -> None:
    volume, soft = slab(28)
    bone = np.zeros_like(soft)
    bone[:, 16:20, 11:13] = True
    line = line_over(volume, soft & ~bone, bone, length=20.0, count=5)
    assert line.thickness == (None, None, 6.0, None, None)
    assert line.along == pytest.approx((0.0, 6.0, 10.0, 14.0, 20.0), abs=2.1)
    assert line.direction == pytest.approx((0.0, 1.0, 0.0))
    with pytest.raises(OptionError, match="allowed"):
        line_over(volume, soft, np.zeros_like(bone), length=20.0, count=5)
    with pytest.raises(OptionError, match="3 or more"):
        line_over(volume, soft, bone, count=2)


def test_a_line_is_looked_for_on_the_side_of_the_patient_that_is_given() -> None:
    # axes of the arrays: head to foot, back to front, left to right
    turned = ((-1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0))
    soft = np.zeros((30, 40, 30), dtype=bool)
    soft[:, 8:32] = True
    bone = np.zeros_like(soft)
    bone[14:16, 24:27] = True
    scan = Volume(np.zeros(soft.shape, dtype=np.int16), spacing=(2.0, 1.0, 2.0), direction=turned)
    line = line_over(scan, soft & ~bone, bone, length=20.0, count=5)
    assert line.direction == pytest.approx((0.0, 1.0, 0.0))
    # up and down the body: around it the bone goes on
    assert line.thickness[2] == 5.0
    assert line.thickness[0] is line.thickness[-1] is None
    assert line.surface[2][1] == pytest.approx(-31.5)
    assert abs(line.surface[-1][2] - line.surface[0][2]) == pytest.approx(20.0)
    with pytest.raises(OptionError, match="3 to 10 mm below"):
        line_over(scan, soft & ~bone, bone, length=20.0, count=5, sides=("posterior",))
    everywhere = line_over(scan, soft & ~bone, bone, length=20.0, count=5, sides=tuple(SIDES))
    assert everywhere.direction == pytest.approx(line.direction)
    with pytest.raises(OptionError, match="anterior, posterior, left, right"):
        line_over(scan, soft, bone, sides=("top",))


def test_merged_voxels_stand_where_those_did_that_they_are_made_of() -> None:
    values = np.arange(4 * 6 * 7, dtype=np.int16).reshape(4, 6, 7)
    scan = Volume(values, spacing=(0.7, 0.7, 2.5), origin=(1.0, 2.0, 3.0), slope=2.0)
    mask = values % 7 < 2
    larger, masks = merged(scan, {"low": mask}, size=2.0)
    assert larger.spacing == pytest.approx((2.1, 2.1, 2.5))
    assert larger.origin == pytest.approx((1.7, 2.7, 3.0))
    assert larger.shape == (4, 2, 2)
    assert larger.array[0, 0, 0] == np.rint(values[0, :3, :3].mean())
    assert masks["low"][..., 0].all()
    assert not masks["low"][..., 1].any()
    same, _ = merged(scan, {}, size=0.5)
    assert same is scan


@pytest.mark.long
@pytest.mark.data
def test_the_spine_of_a_real_chest_is_felt_through_what_covers_it(data_folder: Path) -> None:
    body = body_of_scan(read(data_folder / "lidc0001_totalseg/cxr.nii.gz"))
    pressed = run_palpation(body, sides=("posterior",), places=3)
    beside, over, other = pressed.presses
    assert over.thickness is not None
    assert over.thickness < 10.0
    assert over.stiffness > 1.3 * max(beside.stiffness, other.stiffness) > 0.0
    assert pressed.spikes() == 0
    assert pressed.violations == 0


def test_a_scenario_that_cannot_be_drawn_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["scenario", "needle-skull", "--plot", str(tmp_path / "run.txt")]) == 2
    assert "allowed" in capsys.readouterr().err
    assert run(["scenario", "drilling", "--json", str(tmp_path / "nowhere" / "a.json")]) == 2
    assert "nowhere' given; allowed: one that exists" in capsys.readouterr().err


@pytest.mark.data
def test_the_skull_under_two_millimetres_of_skin_pushes_back_all_the_way(
    data_folder: Path,
) -> None:
    volume = read(data_folder / "cthead_stanford/CThead.mha")
    body = body_of_scan(volume)
    met, hard = (mask.argmax(axis=1) for mask in (body.all_soft | body.bone, body.bone))
    sides = [(axis, way) for axis in (0, 1) for way in (-2, -1, 1, 2)]
    flat = np.max([np.abs(met - np.roll(met, way, axis=axis)) for axis, way in sides], axis=0)
    thin = ((hard - met) * volume.spacing[1] == 2.0) & (flat <= 1)
    thin[:6] = thin[-6:] = False
    places = np.argwhere(thin)
    z, x = places[len(places) // 3]
    grid = np.array([[x + 0.5, y, z + 0.5, 1.0] for y in (met[z, x], met[z, x] + 1.0)])
    skin, inward = (grid @ volume.patient_from_grid.T)[:, :3]
    line = PressLine(
        surface=(skin,),
        direction=(inward - skin) / np.linalg.norm(inward - skin),
        along=(0.0,),
        thickness=(2.0,),
    )
    layers = [
        (volume.segment(body.all_soft, name="skin"), "muscle"),
        (volume.segment(body.bone, name="bone"), None),
    ]
    radius = 2.0 * min(volume.spacing)
    pressed = [
        palpate_line(volume, given, line, radius=radius, depth=5.0)
        for given in (layers, layers[1:])
    ]
    assert [run.violations for run in pressed] == [0, 0]
    # never less than the skull alone, whose smooth face a ball sinks into by less than a voxel
    travel = np.arange(0.0, min(run.travel.max() for run in pressed), 0.1)
    going_in = [np.array(run.phase) == "in" for run in pressed]
    with_skin, alone = (
        np.interp(travel, run.travel[inward], run.force[inward])
        for run, inward in zip(pressed, going_in, strict=True)
    )
    assert alone.max() > 2.0
    assert (with_skin > alone - 0.1).all()
