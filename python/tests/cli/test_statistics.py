"""``palpate statistics``: tables, CSV and JSON, with units in the names of columns."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from palpate.cli.commands import run
from palpate.io.reading import read
from palpate.saved.scene_file import save_scene
from palpate.session.session import Session
from palpate.volumes.scene import Scene


@pytest.fixture
def scan(write_image: Any) -> Path:
    values = np.zeros((6, 7, 8), np.int16)
    values[2:4, 2:5, 1:5] = 300
    values[2, 2, 1] = 420
    path: Path = write_image(values, "scan.mha", spacing=(0.5, 0.5, 1.0))
    return path


def table_of(*arguments: str | Path) -> int:
    return run(["statistics", *map(str, arguments)])


def test_csv_and_json_hold_the_same_numbers_with_units_in_their_names(
    scan: Path, tmp_path: Path, capsys: Any
) -> None:
    options: list[str | Path] = [scan, "--unit", "HU", "--threshold", "200"]
    assert table_of(*options, "--csv") == 0
    (row,) = csv.DictReader(capsys.readouterr().out.splitlines())
    assert float(row["volume_mm3"]) == 24 * 0.25
    assert float(row["volume_ml"]) == 0.006
    assert float(row["mean_HU"]) == 305.0
    assert float(row["max_HU"]) == 420.0
    out = tmp_path / "numbers.json"
    assert table_of(*options, "-o", out) == 0
    found = json.loads(out.read_text("utf-8"))
    assert (found["scan"], found["unit"]) == ("scan", "HU")
    (one,) = found["segments"]
    assert list(one) == list(row)
    assert one["centroid_S_mm"] == float(row["centroid_S_mm"]) == 2.5


def test_the_table_tells_small_volumes_in_cubic_millimetres(scan: Path, capsys: Any) -> None:
    assert table_of(scan, "--threshold", "200") == 0
    headings, row = capsys.readouterr().out.splitlines()
    assert headings.split()[:4] == ["segment", "volume", "voxels", "mean"]
    assert row.split()[:5] == ["threshold", "6", "mm³", "24", "305"]


def test_empty_segments_of_saved_scenes_have_a_row(scan: Path, tmp_path: Path, capsys: Any) -> None:
    volume = read(scan)
    scene = Scene(volume, [volume.segment(np.zeros(volume.shape), name="nothing")])
    file = tmp_path / "work.palpate"
    with Session(scene) as session:
        save_scene(file, session, looks=b"[]")
    capsys.readouterr()
    assert table_of(file, "--csv") == 0
    (row,) = csv.DictReader(capsys.readouterr().out.splitlines())
    assert (row["voxels"], row["volume_mm3"], row["mean"], row["note"]) == ("0", "0", "", "empty")


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ([], "no segments given; allowed: --segments FILE or --threshold LOW,HIGH"),
        (["--threshold", "1", "--csv", "--json"], "allowed: one of --csv, --json, and -o FILE"),
        (["--threshold", "1", "-o", "x.xls"], "allowed: a name with .csv, .json"),
    ],
)
def test_what_cannot_be_done_is_refused(
    scan: Path, options: list[str], said: str, capsys: Any
) -> None:
    assert table_of(scan, *options) == 2
    assert said in capsys.readouterr().err


@pytest.mark.data
def test_the_bone_of_a_head_is_measured(data_folder: Path, capsys: Any) -> None:
    scan = data_folder / "cthead_stanford" / "CThead.mha"
    assert table_of(scan, "--threshold", "1300", "--csv") == 0
    (row,) = csv.DictReader(capsys.readouterr().out.splitlines())
    assert int(row["voxels"]) == 406310
    # compared pair by pair once, over the ends of all rows of voxels
    assert float(row["diameter_mm"]) == pytest.approx(295.7786334)
