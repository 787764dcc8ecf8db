"""``palpate compare``, and the step of that name in recipes and cohorts."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK
from palpate.cli.commands import run

SPACING = (0.5, 1.0, 2.0)


def write(path: Path, values: Any, *, origin: tuple[float, ...] = (0.0, 0.0, 0.0)) -> None:
    image = SimpleITK.GetImageFromArray(values)
    image.SetSpacing(SPACING)
    image.SetOrigin(origin)
    path.parent.mkdir(parents=True, exist_ok=True)
    SimpleITK.WriteImage(image, str(path))


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A scan with a block of 6 voxels in x, and a reference that has it one voxel further."""
    values = np.zeros((12, 12, 12), np.int16)
    values[2:6, 2:6, 2:8] = 300
    write(tmp_path / "data" / "p1" / "ct.nii.gz", values)
    write(
        tmp_path / "data" / "p1" / "truth.nii.gz", np.roll(values > 0, 1, axis=2).astype(np.uint8)
    )
    monkeypatch.chdir(tmp_path)
    return tmp_path


SCAN, TRUTH = "data/p1/ct.nii.gz", "data/p1/truth.nii.gz"


def test_numbers_are_printed_and_written_with_units_in_their_names(
    folder: Path, capsys: Any
) -> None:
    command = ["compare", SCAN, "--threshold", "100", "--reference", TRUTH]
    assert run(command) == 0
    told = capsys.readouterr().out.splitlines()
    assert told[1].split()[:6] == ["threshold", "label", "1", "0.8333", "0.5", "0.125"]
    assert run([*command, "-o", "table.csv"]) == 0
    (row,) = csv.DictReader((folder / "table.csv").read_text().splitlines())
    assert float(row["dice"]) == pytest.approx(5 / 6)
    assert float(row["hausdorff95_mm"]) == 0.5
    assert float(row["reference_volume_ml"]) == 0.096
    capsys.readouterr()
    assert run([*command, "--json"]) == 0
    (same,) = json.loads(capsys.readouterr().out)["segments"]
    assert list(same) == list(row)


def test_a_reference_on_another_grid_is_refused_and_resampled_on_demand(
    folder: Path, capsys: Any
) -> None:
    values = np.zeros((12, 12, 12), np.uint8)
    values[2:6, 2:6, 2:8] = 1
    write(folder / "off.nii.gz", values, origin=(0.25, 0.0, 0.0))
    command = ["compare", SCAN, "--threshold", "100", "--reference", "off.nii.gz"]
    assert run(command) == 2
    said = capsys.readouterr()
    assert not said.out
    assert "off.nii.gz lies on another grid than the scan; allowed:" in said.err
    assert "--resample" in said.err
    assert run([*command, "--resample"]) == 0
    assert "lies on another grid" in capsys.readouterr().err


def test_a_recipe_over_scans_compares_each_with_its_own(folder: Path, capsys: Any) -> None:
    (folder / "recipe.yaml").write_text(
        "import:\n  path: '{scan}'\nsegment:\n  - threshold: 100\n    name: block\n"
        "compare:\n  - reference: '{truth}'\n    out: agreement.csv\nreport: report.html\n"
    )
    (folder / "cases.csv").write_text(f"case,scan,truth\np1,{SCAN},{TRUTH}\n")
    over = ["run", "recipe.yaml", "--table", "cases.csv", "-o", "out"]
    assert run(over) == 0
    (row,) = csv.DictReader((folder / "out" / "cohort.csv").read_text().splitlines())
    assert float(row["dice"]) == pytest.approx(5 / 6)
    assert float(row["mean_surface_distance_mm"]) > 0.0
    assert float(row["volume_ml"]) == 0.096
    assert (folder / "out" / "p1" / "agreement.csv").is_file()
    assert "Compared with truth.nii.gz" in (folder / "out" / "p1" / "report.html").read_text()
    # the reference is one of the inputs: where it changes, the case is run again
    write(folder / TRUTH, np.zeros((12, 12, 12), np.uint8))
    capsys.readouterr()
    assert run(over) == 0
    assert "1 done, 0 failed, 0 kept" in capsys.readouterr().out
    (row,) = csv.DictReader((folder / "out" / "cohort.csv").read_text().splitlines())
    assert (row["dice"], row["hausdorff95_mm"]) == ("0", "")
    assert "the reference is empty" in row["warnings"]


def test_a_recipe_with_a_wrong_reference_fails_before_anything_is_written(
    folder: Path, capsys: Any
) -> None:
    write(folder / "off.nii.gz", np.ones((12, 12, 12), np.uint8), origin=(0.2, 0.0, 0.0))
    (folder / "recipe.yaml").write_text(
        f"import:\n  path: {SCAN}\nsegment:\n  - threshold: 100\nsurface:\n  - out: s.stl\n"
        "compare:\n  - reference: off.nii.gz\n    segment: bone\n"
    )
    assert run(["run", "recipe.yaml"]) == 2
    assert "line 9: compare 1: segment 'bone' given; allowed: threshold" in capsys.readouterr().err
    text = (folder / "recipe.yaml").read_text()
    (folder / "recipe.yaml").write_text(text.replace("    segment: bone\n", ""))
    assert run(["run", "recipe.yaml"]) == 2
    assert "line 8: compare 1: label map off.nii.gz lies on another grid" in capsys.readouterr().err
    assert not (folder / "s.stl").exists()
