"""Named points of segments: in the patient, whatever way the scan lies."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
import SimpleITK
from palpate.base.errors import OptionError
from palpate.cli.commands import run


def cross(direction: Any = None) -> palpate.Scene:
    """Three bars of unequal ends that meet in the voxel (8, 7, 6)."""
    values = np.zeros((16, 18, 20), bool)
    values[6, 7, 3:17] = True
    values[6, 4:15, 8] = True
    values[2:13, 7, 8] = True
    more = {} if direction is None else {"direction": direction}
    volume = palpate.Volume(
        np.zeros(values.shape, np.int16), spacing=(1.0, 2.0, 3.0), origin=(-5.0, 4.0, 9.0), **more
    )
    return palpate.Scene(volume, [volume.segment(values, name="cross")])


def test_each_side_is_the_end_of_a_bar() -> None:
    found = {one.name: one.point for one in palpate.landmarks(cross())}
    assert found["right"] == pytest.approx((-5 + 3, 4 + 14, 9 + 18))
    assert found["left"] == pytest.approx((-5 + 16, 4 + 14, 9 + 18))
    assert found["anterior"] == pytest.approx((-5 + 8, 4 + 8, 9 + 18))
    assert found["posterior"] == pytest.approx((-5 + 8, 4 + 28, 9 + 18))
    assert found["inferior"] == pytest.approx((-5 + 8, 4 + 14, 9 + 6))
    assert found["superior"] == pytest.approx((-5 + 8, 4 + 14, 9 + 36))
    (measured,) = palpate.statistics(cross())
    assert found["centroid"] == pytest.approx(measured.centroid)


def test_sides_are_those_of_the_patient_where_axes_run_the_other_way() -> None:
    turned = cross(direction=np.diag([-1.0, -1.0, 1.0]))
    found = {one.name: one.point for one in palpate.landmarks(turned)}
    assert found["left"] == pytest.approx((-5 - 3, 4 - 14, 9 + 18))
    assert found["anterior"] == pytest.approx((-5 - 8, 4 - 28, 9 + 18))


def test_of_voxels_that_lie_equally_far_the_middle_one_is_taken() -> None:
    volume = palpate.Volume(np.zeros((9, 9, 9), np.int16), spacing=(1.0, 1.0, 1.0))
    block = np.zeros((9, 9, 9), bool)
    block[2:7, 2:7, 2:7] = True
    scene = palpate.Scene(volume, [volume.segment(block, name="block")])
    (one,) = palpate.landmarks(scene, points=["left"])
    assert one.point == (6.0, 4.0, 4.0)


def test_an_empty_segment_has_none_and_unknown_names_are_refused() -> None:
    scene = cross()
    scene.add(scene.volume.segment(np.zeros(scene.volume.shape), name="nothing"))
    assert {one.segment for one in palpate.landmarks(scene)} == {"cross"}
    with pytest.raises(
        OptionError, match=r"'anteror' given \(did you mean 'anterior'\?\); allowed: cent"
    ):
        palpate.landmarks(scene, points=["anteror"])


def test_the_command_and_a_cohort_list_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    monkeypatch.chdir(tmp_path)
    values = np.zeros((8, 8, 8), np.int16)
    values[2:5, 2:5, 3:6] = 300
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), "scan.nii.gz")
    assert run(["landmarks", "scan.nii.gz", "--threshold", "9", "--points", "left", "--csv"]) == 0
    (row,) = csv.DictReader(capsys.readouterr().out.splitlines())
    # a file without a frame lies as its axes say
    (one,) = palpate.landmarks(
        palpate.Scene(volume := palpate.read("scan.nii.gz"), [volume.threshold(9.0)]),
        points=["left"],
    )
    assert tuple(float(row[f"{axis}_mm"]) for axis in "LPS") == one.point
    Path("recipe.yaml").write_text(
        "segment:\n  - threshold: 9\nlandmarks:\n  - points: [left]\n    out: points.csv\n"
    )
    assert run(["run", "recipe.yaml", "--over", "*.nii.gz", "-o", "out"]) == 0
    (line,) = csv.DictReader(Path("out/cohort.csv").read_text().splitlines())
    assert line["landmark_left_L_mm"] == row["L_mm"]
    assert (
        Path("out/scan/points.csv").read_text().splitlines()[0] == "segment,landmark,L_mm,P_mm,S_mm"
    )
