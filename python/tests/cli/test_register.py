"""``palpate register``: what it writes is read again."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
import SimpleITK
from palpate.cli.commands import run

SPACING = (3.0, 2.5, 3.0)
SHIFT = (4, 3, -2)
"""Voxels."""


@pytest.fixture
def scans(write_image: Any) -> tuple[Path, Path]:
    """A body, and the same shifted by whole voxels."""
    z, y, x = np.indices((24, 28, 30))
    off = np.sqrt((x - 13) ** 2 + 1.3 * (y - 12) ** 2 + 0.8 * (z - 12) ** 2)
    values = np.where(off < 9.0, 200.0 - 6.0 * off + 4.0 * x - 3.0 * z, -900.0)
    values[10:14, 9:13, 15:18] = 1200.0
    fixed = np.rint(values).astype(np.int16)
    moving = np.roll(fixed, SHIFT[::-1], axis=(0, 1, 2))
    return (
        write_image(fixed, "fixed.mha", spacing=SPACING),
        write_image(moving, "moving.mha", spacing=SPACING),
    )


def register(*arguments: str | Path) -> int:
    return run(["register", *map(str, arguments)])


QUICK = ("--samples", "6000", "--iterations", "50", "--start", "geometry")


def test_all_that_it_writes_says_the_same(
    scans: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fixed, moving = scans
    made = tmp_path / "made"
    made.mkdir()
    pairs = tmp_path / "pairs.csv"
    shift = np.multiply(SHIFT, SPACING)
    lines = [
        [*place, *(place + shift)]
        for place in np.array([[30.0, 30, 30], [60, 30, 30], [40, 50, 60]])
    ]
    pairs.write_text("x,y,z,x,y,z\n" + "\n".join(",".join(map(str, line)) for line in lines) + "\n")
    names = ("T.tfm", "R.nii.gz", "P.png", "R.json")
    targets = zip(("-o", "--resampled", "--picture", "--report"), names, strict=True)
    options = [word for option, name in targets for word in (option, str(made / name))]
    assert register(fixed, moving, *QUICK, "--landmarks", pairs, *options) == 0
    assert sorted(one.name for one in made.iterdir()) == sorted(names)

    transform = SimpleITK.ReadTransform(str(made / "T.tfm"))
    there = np.subtract(transform.TransformPoint((40.0, 30.0, 36.0)), (40.0, 30.0, 36.0))
    np.testing.assert_allclose(there, shift, atol=0.4)

    still, brought = palpate.read(fixed), palpate.read(made / "R.nii.gz")
    np.testing.assert_allclose(brought.patient_from_grid, still.patient_from_grid, atol=1e-5)
    assert np.abs(brought.array.astype(float) - still.array)[4:-4, 4:-4, 4:-4].mean() < 25.0

    report = json.loads((made / "R.json").read_text())
    assert report["maps"] == "points of the fixed scan to the moving one, LPS mm"
    assert report["kind"] == "rigid"
    assert report["metric_after"] < report["metric_before"]
    np.testing.assert_allclose(np.array(report["matrix"])[:3, :3], np.eye(3), atol=0.02)
    assert report["landmarks_mm"]["before_mean"] == pytest.approx(np.linalg.norm(shift))
    assert report["landmarks_mm"]["after_mean"] < 0.5
    assert {level["stage"] for level in report["curve"]} == {"rigid"}
    assert all(level["values"] for level in report["curve"])

    picture = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(made / "P.png")))
    above, below = np.array_split(picture.astype(float), 2)
    # squares of scans that fit have fewer steps between them
    assert np.abs(np.diff(below, axis=1)).mean() < 0.9 * np.abs(np.diff(above, axis=1)).mean()
    assert "landmarks 15.37 → 0." in capsys.readouterr().out


def test_a_label_map_is_resampled_to_its_own_labels(
    scans: tuple[Path, Path], write_image: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    _, moving = scans
    grey = palpate.read(moving).array
    numbers = np.where(grey > 1000, 5, np.where(grey > 0, 2, 0)).astype(np.uint8)
    labels = write_image(numbers, "labels.mha", spacing=SPACING)
    fixed = write_image(np.roll(numbers, (1, -1, 2), axis=(0, 1, 2)), "f.mha", spacing=(3, 2.6, 3))
    out, few = tmp_path / "R.nii.gz", ("--samples", "2000", "--iterations", "20")
    assert register(fixed, labels, *few, "--resampled", out) == 0
    assert set(np.unique(palpate.read(out).values())) == {0, 2, 5}
    assert "resampled by the nearest voxel" in capsys.readouterr().out
    words = ("--resampled", out, "--interpolation", "linear", "--json", "--force")
    assert register(fixed, labels, *few, *words) == 0
    assert {1, 3, 4} & set(np.unique(palpate.read(out).values()).tolist())
    assert json.loads(capsys.readouterr().out)["interpolation"] == "linear"


@pytest.mark.parametrize("kind", ["rigid", "bspline"])
def test_the_inverse_leads_back(
    scans: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str], kind: str
) -> None:
    there, back = tmp_path / "T.tfm", tmp_path / "I.tfm"
    few = ("--samples", "3000", "--iterations", "40", "--kind", kind, "--metric", "correlation")
    assert register(*scans, *few, "-o", there, "--write-inverse", back, "--json") == 0
    told = json.loads(capsys.readouterr().out)["inverse"]
    assert told["exact"] == (kind == "rigid")
    both = [SimpleITK.ReadTransform(str(path)) for path in (there, back)]
    for point in np.random.default_rng(0).uniform(20.0, 50.0, (50, 3)):
        again = both[1].TransformPoint(both[0].TransformPoint(point.tolist()))
        off = float(np.linalg.norm(again - point))
        assert off <= max(1e-6, 3.0 * told["error_of_99_in_100_mm"])


def test_the_inverse_alone_is_something_to_write(scans: tuple[Path, Path], tmp_path: Path) -> None:
    back = tmp_path / "I.tfm"
    few = ("--samples", "3000", "--iterations", "40", "--metric", "correlation")
    assert register(*scans, *few, "--write-inverse", back) == 0
    assert back.is_file()


def test_the_report_is_printed(
    scans: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "T.tfm"
    few = ("--samples", "500", "--iterations", "3")
    assert register(*scans, *few, "--kind", "affine", "-o", out, "--json") == 0
    report = json.loads(capsys.readouterr().out)
    assert report["kind"] == "affine"
    assert len(report["matrix"]) == 4


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ([], "nothing to write given; allowed: --output"),
        (["-o", "T.txt"], "'T.txt' given; allowed: a name with .tfm"),
        (["-o", "T.tfm", "--kind", "bent"], "kind 'bent' given; allowed: rigid, affine, bspline"),
        (["--resampled", "R.mha", "--interpolation", "cubic"], "interpolation 'cubic' given; allo"),
        (["-o", "T.tfm", "--knots", "0.1"], "knots 0.1 given; allowed: 1 to 1000"),
        (["-o", "T.tfm", "--landmarks", "wrong.csv"], "wrong.csv, line 2: '1,2' given; allowed"),
        (["-o", "T.tfm", "--landmarks", "none.csv"], "no pairs of points in none.csv; allowed"),
        (["-o", "T.tfm", "--landmarks", "far.csv"], "the scans do not overlap enough"),
    ],
)
def test_what_cannot_be_is_refused_and_nothing_is_written(
    scans: tuple[Path, Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    options: list[str],
    said: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("wrong.csv").write_text("0,0,0,0,0,0\n1,2\n")
    Path("none.csv").write_text("x,y,z,x,y,z\n")
    Path("far.csv").write_text("0,0,0,900,0,0\n1,0,0,901,0,0\n0,1,0,900,1,0\n")
    Path("T.tfm").write_text("kept")
    before = sorted(tmp_path.iterdir())
    assert register(*scans, *options, "--force") == 2
    assert said in capsys.readouterr().err
    assert Path("T.tfm").read_text() == "kept"
    assert sorted(tmp_path.iterdir()) == before


def test_the_help_has_examples(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["register", "--help"]) == 0
    assert "palpate register ct/ mr/ -o mr-to-ct.tfm" in capsys.readouterr().out
