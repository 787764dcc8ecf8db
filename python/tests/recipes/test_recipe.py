"""Recipes: whole pipelines from a file, and what is wrong in one is told with its line."""

from __future__ import annotations

import base64
import json
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK
import trimesh
from palpate.base.errors import OptionError
from palpate.cli.commands import run
from palpate.io.reading import read
from palpate.labels.labels import read_labels
from palpate.recipes.recipe import read_recipe
from projected_phantom import SIZE, projected, scanner_of, truth

SPACING = (1.0, 1.5, 2.0)

WHOLE = """
import:
  path: scan.mha
  unit: HU
segment:
  - threshold: 200
    keep-largest: true   # not the speck
    fill: true
    name: ball
  - grow: ["46,24,30"]
    passage: 4
    name: <small> & far
surface:
  - segment: ball
    out: ball.stl
    smoothing: 2
export:
  - out: both.seg.nrrd
  - out: labels.nii.gz
    only: [ball]
report: report.html
picture:
  - out: left.png
    view: left
    size: 60x40
"""


@pytest.fixture
def folder(write_image: Any) -> Path:
    """A folder with a scan of two balls of 300 and 600, the larger one hollow, and a speck."""
    z, y, x = np.indices((30, 32, 60))
    places = np.stack([x, y, z], axis=-1) * SPACING
    values = np.zeros(z.shape, np.int16)
    off = np.linalg.norm(places - (18.0, 24.0, 30.0), axis=-1)
    values[(off <= 14.0) & (off > 5.0)] = 300
    values[np.linalg.norm(places - (46.0, 24.0, 30.0), axis=-1) <= 8.0] = 600
    values[1, 1, 1] = 300
    path: Path = write_image(values, "scan.mha", spacing=SPACING)
    return path.parent


def written(folder: Path, text: str) -> Path:
    path = folder / "recipe.yaml"
    path.write_text(text, "utf-8")
    return path


def test_a_whole_pipeline_runs_and_its_files_are_read_again(folder: Path, capsys: Any) -> None:
    recipe = written(folder, WHOLE)
    assert run(["run", str(recipe), "--check"]) == 0
    assert sorted(each.name for each in folder.iterdir()) == ["recipe.yaml", "scan.mha"]
    assert run(["run", str(recipe)]) == 0
    said = capsys.readouterr().out
    volume = read(folder / "scan.mha")
    both = read_labels(folder / "both.seg.nrrd", volume).labels
    ball, small = (one.segment for one in both)
    z, y, x = np.indices(volume.shape)
    off = np.linalg.norm(np.stack([x, y, z], axis=-1) * SPACING - (18.0, 24.0, 30.0), axis=-1)
    np.testing.assert_array_equal(ball.mask() != 0, off <= 14.0)
    assert f"ball: {ball.volume_text}" in said
    numbers = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(folder / "labels.nii.gz")))
    np.testing.assert_array_equal(numbers != 0, off <= 14.0)
    mesh = trimesh.load_mesh(folder / "ball.stl")
    assert mesh.volume / 1000.0 == pytest.approx(ball.volume_ml, rel=0.1)

    report = (folder / "report.html").read_text("utf-8")
    assert f"{ball.volume_text}" in report
    assert f"{small.volume_text}" in report
    assert "&lt;small&gt; &amp; far" in report
    assert "<small>" not in report
    # nothing is loaded from elsewhere
    assert not re.search(r"(src|href)=\"(?!data:)", report)
    left = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(folder / "left.png")))
    assert left.shape == (40, 60, 3)
    assert left[20, 30].max() > left[0, 0].max() + 30
    pictures = re.findall(r"base64,([A-Za-z0-9+/=]+)", report)
    # from three sides, and three slices
    assert len(pictures) == 6
    file = folder / "slice.png"
    file.write_bytes(base64.b64decode(pictures[3]))
    picture = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(file)))
    assert picture.shape == (32, 60, 3)
    # the segment has a colour of its own; 0 HU is 0.4 of the way through the window
    assert set(picture[0, 30]) == {102}
    tinted = picture[16, 18].astype(int)
    assert tinted.max() > tinted.min()


def test_raw_voxels_are_imported_with_their_layout(folder: Path, capsys: Any) -> None:
    scan = read(folder / "scan.mha")
    (folder / "scan.raw").write_bytes(scan.array.astype(">i2").tobytes())
    text = """
import:
  path: scan.raw
  raw: 60x32x30,int16,big
  voxel-size: 1,1.5,{depth}
segment:
  - threshold: 200
    name: all
"""
    assert run(["run", str(written(folder, text.format(depth="2")))]) == 0
    made = scan.threshold(200.0)
    assert f"all: {made.volume_text}" in capsys.readouterr().out
    assert run(["run", str(written(folder, text.format(depth="deep")))]) == 2
    assert (
        "recipe.yaml, line 5: import: voxel-size '1,1.5,deep' given; allowed: 3 numbers, X,Y,Z"
        in capsys.readouterr().err
    )


def test_a_scan_is_reconstructed_before_its_segments_are_made(
    tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    # parallel beams need no library
    monkeypatch.setitem(sys.modules, "itk", None)
    images = projected(scanner_of("parallel")).astype(np.float32)
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(images), str(tmp_path / "projections.nrrd"))
    text = """
reconstruct:
  path: projections.nrrd
  beam: parallel
  pixel: [1.3, 1.6]
  arc: {arc}
  size: [48, 44, 24]
  voxel: [2, 2, 2]
  output: scan.nii.gz
segment:
  - {{threshold: -300, keep-largest: true, name: body}}
export:
  - out: body.nii.gz
report: report.html
"""
    recipe = written(tmp_path, text.format(arc=180))
    assert run(["run", str(recipe)]) == 0
    scan = read(tmp_path / "scan.nii.gz")
    assert scan.dimensions == SIZE
    (body,) = read_labels(tmp_path / "body.nii.gz", scan).labels
    right = truth() > -300.0
    both = np.count_nonzero(right & (body.segment.mask() != 0))
    assert 2.0 * both / (np.count_nonzero(right) + body.segment.voxel_count) > 0.97
    assert f"body: {body.segment.volume_text}" in capsys.readouterr().out
    assert "HU" in (tmp_path / "report.html").read_text("utf-8")
    # checked before anything is read, with its line
    for old, new, line, said in (
        ("arc: 180", "arc: 90", 2, "an arc of 90 degrees given"),
        ("projections.nrrd", "nowhere.nrrd", 3, "does not exist"),
        ("beam: parallel", "beam: cone", 2, "an arc of 180 degrees given"),
        ("scan.nii.gz", "scan.txt", 9, "scan.txt"),
        ("scan.nii.gz", "projections.nrrd", 9, "is read by another step"),
        ("  arc:", "  angle:", 6, "reconstruct: 'angle' is no option here.*; allowed: beam, pixel"),
        ("segment:", "import: {path: body.nii.gz}\nsegment:", 2, "both given"),
    ):
        wrong = written(tmp_path, text.format(arc=180).replace(old, new, 1))
        with pytest.raises(OptionError, match=f"recipe.yaml, line {line}: .*{said}"):
            read_recipe(wrong)


def test_another_scan_is_brought_to_the_first_one_and_segments_are_made_of_it(
    folder: Path, write_image: Any, capsys: Any
) -> None:
    scan = read(folder / "scan.mha")
    moved = np.zeros_like(scan.array)
    moved[3:, 2:, 4:] = scan.array[:-3, :-2, :-4]
    write_image(moved, "moved.mha", spacing=SPACING)
    recipe = written(
        folder,
        """
import: {path: scan.mha}
register: {moving: moved.mha, start: geometry, metric: correlation, output: T.tfm,
           picture: squares.png, resampled: back.mha, go-on-with: moving}
segment:
  - {threshold: 450, name: small}
export:
  - {out: small.mha}
report: report.html
""",
    )
    assert run(["run", str(recipe)]) == 0
    for name in ("T.tfm", "squares.png", "back.mha"):
        assert (folder / name).exists()
    assert "registration: " in capsys.readouterr().err
    mask = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(folder / "small.mha"))) != 0
    ball = scan.array == 600
    both = 2.0 * np.count_nonzero(mask & ball)
    # as it is, the moved one hardly overlaps
    assert both / (np.count_nonzero(mask) + np.count_nonzero(ball)) > 0.85
    shifted = moved == 600
    assert 2.0 * np.count_nonzero(shifted & ball) / (2.0 * np.count_nonzero(ball)) < 0.6


@pytest.mark.parametrize(
    ("wrong", "line", "said"),
    [
        (
            ("fill: true", "fil: true"),
            8,
            "segment 1: 'fil' is no option here (did you mean 'fill'?); allowed: threshold",
        ),
        (
            ("threshold: 200", "threshold: [200]"),
            6,
            "segment 1: threshold [200] given; allowed: text or a number",
        ),
        (("threshold: 200", "threshold: abc"), 6, "threshold 'abc' given"),
        (("passage: 4", "passage: 400"), 10, "passage 400 given; allowed: 0 to 40"),
        (("path: scan.mha", "path: gone.mha"), 3, "gone.mha does not exist"),
        (
            ("import:\n  path: scan.mha\n  unit: HU\n", ""),
            2,
            "neither given; allowed: 'import' or 'reconstruct', one of both",
        ),
        (
            ("segment: ball", "segment: bal"),
            14,
            "surface 1: segment 'bal' given (did you mean 'ball'?); allowed: ball, <small>",
        ),
        (("    segment: ball\n", ""), 14, "no segment given"),
        (("out: ball.stl", "out: ball.docx"), 15, "'ball.docx' given; allowed: a name with .stl"),
        (("out: both.seg.nrrd", "out: none/both.seg.nrrd"), 18, "given; allowed: one that exists"),
        (("out: labels.nii.gz", "out: both.seg.nrrd"), 19, "is written by another step"),
        (("out: labels.nii.gz", "out: scan.mha"), 19, "is read by another step"),
        (("report: report.html", "report: report.pdf"), 21, "allowed: a name with .html"),
        (("fill: true", "threshold: 3"), 8, "'threshold' is given twice"),
        (("fill: true", "fill: : true"), 8, "mapping values are not allowed"),
        (("smoothing: 2", "smoothing: 2\n    out2: 3"), 17, "'out2' is no option here"),
        (
            ("surface:", "surfaces:"),
            13,
            "'surfaces' is no option here (did you mean 'surface'?); allowed: import",
        ),
        (("segment:\n  - t", "register: {moving: gone.nii}\nsegment:\n  - t"), 5, "gone.nii does"),
        (
            ("segment:\n  - t", "register: {moving: scan.mha, output: a.txt}\nsegment:\n  - t"),
            5,
            "'a.txt' given; allowed: a name with .tfm",
        ),
        (("only: [ball]", "as: pdf"), 20, "export 2: as 'pdf' given; allowed: seg-nrrd, labels"),
    ],
)
def test_what_is_wrong_is_told_with_its_line_before_anything_is_done(
    folder: Path, capsys: Any, wrong: tuple[str, str], line: int, said: str
) -> None:
    text = WHOLE
    if wrong[0] == "    segment: ball\n":
        text = text.replace("  - segment: ball\n    out:", "  - out:")
    else:
        assert wrong[0] in text
        text = text.replace(*wrong, 1)
    recipe = written(folder, text)
    before = sorted(folder.iterdir())
    assert run(["run", str(recipe)]) == 2
    told = capsys.readouterr().err
    assert f"recipe.yaml, line {line}: " in told
    assert said in told
    assert sorted(folder.iterdir()) == before


@pytest.mark.parametrize("text", ["", "- 1\n- 2\n", "just words", "a: &a [*a]", "\x00", "[" * 5000])
def test_what_is_no_recipe_is_refused(folder: Path, text: str) -> None:
    with pytest.raises(
        OptionError, match=r"recipe\.yaml" if text else "is empty; allowed: a recipe"
    ):
        read_recipe(written(folder, text))


def test_a_recipe_that_is_not_there_is_told(tmp_path: Path, capsys: Any) -> None:
    assert run(["run", str(tmp_path / "none.yaml")]) == 2
    assert "none.yaml" in capsys.readouterr().err


CHECKED = """
import: {path: scan.mha, unit: HU}
register: {moving: scan.mha, metric: automatic, start: geometry, fixed-mask: mask.nii.gz,
           iterations: 2, samples: 200, seed: 3, report: found.json}
segment:
  - {threshold: bone, name: ball, intersect: mask.nii.gz}
export:
  - {out: ball.nii.gz, only: [ball]}
"""


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("[ball]", "[bal]", "line 8: export 1: segment 'bal' given (did you mean 'ball'?)"),
        ("[ball]", "[]", "line 8: export 1: only given without a name; allowed: names"),
        ("out: ball.nii.gz", "out: b.dcm, keep-identity: true", "line 8: export 1: the scan "),
        ("out: ball.nii.gz", "out: shared", "line 8: export 1: the scan "),
        ("out: ball.nii.gz", "out: found.json", "found.json is written by another step"),
        ("out: ball.nii.gz", "out: mask.nii.gz", "line 8: export 1: "),
        ("metric: automatic", "metric: automatik", "register: metric 'automatik' given (did you"),
        ("fixed-mask: mask", "fixed-mask: gone", "line 3: register: "),
        ("fixed-mask: mask.nii.gz", "landmarks: recipe.yaml", "line 3: register: no pairs"),
        ("iterations: 2", "iterations: 0", "line 3: register: iterations 0 given; allowed: 1 to"),
        ("moving: scan.mha", "moving: recipe.yaml", "line 3: register: "),
        ("intersect: mask", "intersect: coarse", "line 6: segment 1: "),
        ("unit: HU", "unit: Hu", "line 2: import: unit 'Hu' is not known; allowed: HU"),
        (", unit: HU", "", "line 6: segment 1: threshold 'bone' given for a scan whose values"),
        ("bone", "bones", "threshold 'bones' given (did you mean 'bone'?); allowed: LOW"),
        ("seed: 3", "sead: 3", "register: 'sead' is no option here (did you mean 'seed'?)"),
        ("name: ball", "name: 3", "line 6: segment 1: name 3 given; allowed: text"),
        ("export:", "surface: [{out: a.stl, step: 3}]\nexport:", "surface 1: step 3 given"),
        ("export:", "  - {threshold: 3, name: ball}\nexport:", "two segments are called 'ball'"),
    ],
)
def test_what_can_be_known_is_found_by_the_check_and_by_the_run(
    folder: Path, write_image: Any, capsys: Any, old: str, new: str, said: str
) -> None:
    scan = read(folder / "scan.mha")
    write_image((scan.array > 0).astype(np.uint8), "mask.nii.gz", spacing=SPACING)
    write_image(np.ones((3, 3, 3), np.uint8), "coarse.nii.gz", spacing=(7.3, 7.0, 7.0))
    assert old in CHECKED
    assert run(["run", str(written(folder, CHECKED)), "--check"]) == 0, capsys.readouterr().err
    recipe = written(folder, CHECKED.replace(old, new, 1))
    before = sorted(folder.iterdir())
    for check in ([], ["--check"]):
        assert run(["run", str(recipe), *check]) == 2
        told = capsys.readouterr().err
        assert said in told
        assert str(recipe) in told
        # a command that is told whole has flags
        words = re.sub(r"`palpate [^`]*`", "", told)
        for internal in ("<Volume", "Expected", "enum", "--"):
            assert internal not in words
    assert sorted(folder.iterdir()) == before


def test_a_registration_of_a_recipe_has_all_options_of_the_command(
    folder: Path, write_image: Any, capsys: Any
) -> None:
    scan = read(folder / "scan.mha")
    write_image((scan.array > 0).astype(np.uint8), "mask.nii.gz", spacing=SPACING)
    write_image(np.roll(scan.array, (1, 1, 2), axis=(0, 1, 2)), "moved.mha", spacing=SPACING)
    text = CHECKED.replace("moving: scan", "moving: moved").replace(
        "iterations: 2", "iterations: 40"
    )
    text = text.replace("samples: 200", "samples: 20000")
    assert run(["run", str(written(folder, text))]) == 0, capsys.readouterr().err
    files = [str(folder / name) for name in ("scan.mha", "moved.mha")]
    masked = ["--fixed-mask", str(folder / "mask.nii.gz"), "--start", "geometry"]
    options = ["--iterations", "40", "--samples", "20000", "--seed", "3"]
    other = folder / "other.json"
    assert run(["register", *files, *masked, *options, "--report", str(other)]) == 0
    one, two = (json.loads(file.read_text("utf-8")) for file in (other, folder / "found.json"))
    # sums over threads differ in their last digits
    for name in ("metric_before", "metric_after", "overlap", "moved_mean_mm"):
        assert one[name] == pytest.approx(two[name], rel=1e-6)
    assert (one["kind"], one["metric"], one["start"]) == (two["kind"], two["metric"], "geometry")


def test_an_option_that_no_step_has_is_told_as_a_whole_command(
    folder: Path, write_image: Any, capsys: Any
) -> None:
    scan = read(folder / "scan.mha")
    write_image((scan.array > 0).astype(np.uint8), "mask.nii.gz", spacing=SPACING)
    recipe = written(folder, CHECKED.replace("moving: scan.mha", "moving: mask.raw"))
    (folder / "mask.raw").write_bytes(bytes(1000))
    assert run(["run", str(recipe), "--check"]) == 2
    said = capsys.readouterr().err
    assert f"`palpate import {folder / 'mask.raw'} --voxel-size X,Y,Z -o NEW.nrrd`" in said
