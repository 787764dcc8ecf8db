"""Touch by a script: where it goes, what it feels, and that it feels the same each time."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
from palpate.base.errors import OptionError
from palpate.cli.commands import run
from palpate.segmentation.measures.surface_place import direction_of, surface_places
from palpate.session.touch_table import touch_row
from palpate.volumes.volume import VolumeTraits

HU = VolumeTraits(unit="HU")
CENTRE = np.array([24.0, 20.0, 22.0])


def ellipsoid(axes: tuple[float, float, float] = (18.0, 12.0, 8.0)) -> palpate.Scene:
    """An ellipsoid along the axes of the patient, its longest axis along L; over it a plate."""
    z, y, x = np.indices((44, 40, 48)) + 0.0
    off = sum(
        ((index - middle) / axis) ** 2
        for index, middle, axis in zip((x, y, z), CENTRE, axes, strict=True)
    )
    values = np.where(off <= 1.0, 50, -1000).astype(np.int16)
    volume = palpate.Volume(values, spacing=(1.0, 1.0, 1.0), traits=HU)
    plate = np.zeros(values.shape, bool)
    plate[33:35] = True
    return palpate.Scene(
        volume, [volume.threshold(0.0, 100.0, name="body"), volume.segment(plate, name="plate")]
    )


def slab() -> palpate.Scene:
    """Matter up to z = 15.5 mm, flat."""
    values = np.full((32, 32, 32), -1000, np.int16)
    values[:16] = 50
    volume = palpate.Volume(values, spacing=(1.0, 1.0, 1.0), traits=HU)
    return palpate.Scene(volume, [volume.threshold(0.0, 100.0, name="slab")])


def request(**more: Any) -> palpate.TouchRequest:
    given = {"at": "superior", "offset": (0.3, 0.2, 0.0), "depth": 3.0, **more}
    return palpate.TouchRequest(**given)


def test_places_are_on_the_surface_at_sides_and_ends_of_axes() -> None:
    body = next(iter(ellipsoid())).segment
    for at, axis, sign in (
        ("left", 0, 1), ("axis 1+", 0, 1), ("axis 1-", 0, -1), ("axis 2-", 1, -1),
        ("anterior", 1, -1), ("axis 3+", 2, 1), ("inferior", 2, -1),
    ):  # fmt: skip
        (place,) = surface_places(body, at)
        way = np.zeros(3)
        way[axis] = sign
        np.testing.assert_allclose(place.inward, -way, atol=0.02)
        half = (18.0, 12.0, 8.0)[axis]
        # voxels end half an edge past their centres
        np.testing.assert_allclose(place.point, CENTRE + way * (half + 0.5), atol=0.4)
    (place,) = surface_places(body, "60,20,22")
    np.testing.assert_allclose(place.point, (42.5, 20.0, 22.0), atol=1e-2)
    (moved,) = surface_places(body, "superior", offset=(9.0, 0.0, 0.0))
    assert moved.point[2] == pytest.approx(22 + 8 * np.sqrt(1 - 0.25), abs=1.0)
    np.testing.assert_allclose(np.abs(direction_of(body, "axis 3-")), (0, 0, 1), atol=0.02)


def test_a_line_that_misses_and_words_that_are_no_place_are_refused() -> None:
    body = next(iter(ellipsoid())).segment
    with pytest.raises(OptionError, match=r"misses 'body'; allowed: a place over the segment"):
        surface_places(body, "superior", offset=(19.5, 0.0, 0.0))
    with pytest.raises(OptionError, match=r"place 'front' given; allowed: left, right"):
        surface_places(body, "front")
    with pytest.raises(OptionError, match=r"depth 0 given; allowed: more than 0"):
        palpate.touch(slab(), request(depth=0.0))
    with pytest.raises(OptionError, match=r"a touch of 16\d+ s given; allowed: at most 3600 s"):
        palpate.touch(slab(), request(speed=0.001))
    with pytest.raises(OptionError, match="which is the way in; allowed: a direction across it"):
        palpate.touch(slab(), request(do="stroke", along="superior"))
    with pytest.raises(OptionError, match="a rigid segment to drill"):
        palpate.touch(slab(), request(do="drill", material="liver"))


def test_a_rigid_press_feels_the_spring_of_the_hand_and_says_so() -> None:
    felt = palpate.touch(slab(), request())
    assert felt.place[2] == pytest.approx(15.5, abs=2e-3)
    assert felt.inward == (0.0, 0.0, -1.0)
    assert felt.stiffness is not None
    assert felt.residual is not None
    # the spring of touch has 1 N/mm by default
    assert felt.stiffness == pytest.approx(1.0, rel=0.01)
    assert felt.residual < 0.01
    assert felt.depths.max() == pytest.approx(3.0)
    # the ball stops at the surface, within a voxel
    assert felt.probes[:, 2].min() == pytest.approx(15.5 + 3.0, abs=0.6)
    assert felt.warnings == (
        "slab is rigid: the stiffness is that of the spring between ball and hand",
    )


def test_soft_tissue_is_softer_and_the_same_touch_gives_the_same_numbers() -> None:
    scene = slab()
    hard = palpate.touch(scene, request(depth=1.0, speed=20.0))
    soft, again = (
        palpate.touch(scene, request(depth=1.0, speed=20.0, material="liver")) for _ in range(2)
    )
    assert soft.stiffness is not None
    assert hard.stiffness is not None
    assert 0.0 < soft.stiffness < 0.5 * hard.stiffness
    assert soft.warnings == ()
    for name in ("times", "depths", "forces", "lateral", "devices", "probes"):
        np.testing.assert_array_equal(getattr(soft, name), getattr(again, name))


def test_a_drill_removes_what_it_works_at_and_leaves_the_scene_as_it_was() -> None:
    scene = slab()
    before = next(iter(scene)).segment.voxel_count
    felt = palpate.touch(scene, request(do="drill", radius=2.0, depth=4.0))
    volume = touch_row(felt)["drill_volume_mm3"]
    assert isinstance(volume, float)
    assert volume > 1.0
    assert next(iter(scene)).segment.voxel_count == before


def test_a_stroke_follows_the_surface_with_an_even_force() -> None:
    felt = palpate.touch(
        ellipsoid(), request(segment="body", do="stroke", length=16.0, depth=1.5, speed=10.0)
    )
    # from the middle of its rest to the end of its way
    there = (felt.times > 0.8) & (felt.times < 2.5)
    forces = felt.forces[there]
    # the hand stays as deep below the surface as that bends
    assert forces.min() > 0.3 * forces.max() > 0.0
    assert np.ptp(felt.devices[:, 0]) == pytest.approx(16.0, abs=0.1)
    assert felt.stiffness is None


def test_other_segments_are_felt_only_where_they_are_named() -> None:
    scene = ellipsoid()
    free = palpate.touch(scene, request(segment="body"))
    held = palpate.touch(scene, request(segment="body", rigid=["plate"]))
    # the ball has a radius of 3 mm: it reaches the body, or stays on the plate
    assert free.probes[:, 2].min() < 34.5 < 34.5 + 2.5 < held.probes[:, 2].min()
    with pytest.raises(OptionError, match="given as rigid too"):
        palpate.touch(scene, request(segment="body", rigid=["body"]))


def test_the_command_writes_curve_and_plot_the_same_each_time(
    tmp_path: Path, write_image: Any, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    pytest.importorskip("matplotlib")
    monkeypatch.chdir(tmp_path)
    values = np.zeros((16, 16, 16), np.int16)
    values[:8] = 300
    write_image(values, "scan.mha")
    command = ["touch", "scan.mha", "--threshold", "100", "--at", "superior", "--depth", "2"]
    for number in (1, 2):
        files = ["-o", f"{number}.csv", "--plot", f"{number}.svg"]
        assert run([*command, *files]) == 0
    assert "stiffness [N/mm]" in capsys.readouterr().out
    for ending in ("csv", "svg"):
        assert Path(f"1.{ending}").read_bytes() == Path(f"2.{ending}").read_bytes()
    rows = list(csv.DictReader(Path("1.csv").read_text().splitlines()))
    assert max(float(row["depth_mm"]) for row in rows) == pytest.approx(2.0)
    assert max(float(row["force_N"]) for row in rows) > 0.5
    assert run([*command, "-o", "1.json"]) == 0
    told = json.loads(Path("1.json").read_text())
    assert len(told["samples"]["force_N"]) == len(rows)
    assert told["press_stiffness_N_per_mm"] > 0.0

    Path("recipe.yaml").write_text(
        "segment:\n  - threshold: 100\n    name: block\n"
        "touch:\n  - at: superior\n    out: press.csv\n    plot: press.png\n"
        "  - at: superior\n    depth: 1\n"
    )
    for out in ("out", "again"):
        assert run(["run", "recipe.yaml", "--over", "*.mha", "-o", out]) == 0
    (row,) = csv.DictReader(Path("out/cohort.csv").read_text().splitlines())
    assert float(row["press_stiffness_N_per_mm"]) == pytest.approx(
        told["press_stiffness_N_per_mm"], rel=1e-6
    )
    assert float(row["press_largest_force_N_2"]) < float(row["press_largest_force_N"])
    for name in ("press.csv", "press.png"):
        assert Path(f"out/scan/{name}").read_bytes() == Path(f"again/scan/{name}").read_bytes()


def test_a_horn_that_gives_way_aside_has_no_stiffness_and_that_is_told() -> None:
    values = np.full((40, 32, 32), -1000, np.int16)
    values[:12] = 50
    values[12:28, 15:17, 15:17] = 50
    volume = palpate.Volume(values, spacing=(1.0, 1.0, 1.0), traits=HU)
    scene = palpate.Scene(volume, [volume.threshold(0.0, 100.0, name="horn")])
    felt = palpate.touch(scene, request(depth=8.0, material="liver", radius=2.0))
    assert felt.largest_force > 0.0
    assert felt.stiffness is None
    assert felt.residual is None
    assert any("does not rise with depth" in told for told in felt.warnings)


def test_a_single_voxel_has_axes_too() -> None:
    values = np.full((8, 8, 8), -1000, np.int16)
    values[4, 4, 4] = 50
    volume = palpate.Volume(values, spacing=(1.0, 1.0, 1.0), traits=HU)
    (place,) = surface_places(volume.threshold(0.0, 100.0, name="one"), "axis 1+")
    assert np.linalg.norm(place.inward) == pytest.approx(1.0)
