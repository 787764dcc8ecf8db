"""``palpate transform``: each kind of file comes to lie where the transform takes it."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import palpate
import pytest
import SimpleITK
from numpy.typing import NDArray
from palpate.cli.commands import run
from palpate.saved.edited_scene import edited_scene
from palpate.saved.scene_file import open_scene, save_scene
from palpate.session.session import Session, SessionOptions

SHIFT = np.array([6.0, -4.0, 3.0])
"""From points of the fixed scan to the moving one [mm]: whole voxels of both."""
CENTRE = np.array([16.0, 14.0, 18.0])
"""Of the body in the moving scan [mm]; no two axes alike."""


def body(at: NDArray[np.float64]) -> NDArray[np.bool_]:
    z, y, x = np.indices((20, 22, 24))
    place = np.stack([x * 1.0, y * 2.0, z * 1.5], axis=-1)
    off = np.abs(place - at)
    inside: NDArray[np.bool_] = np.all(off < (5.0, 4.5, 5.0), axis=-1)
    return inside


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A transform, both scans, and everything of the moving one."""
    monkeypatch.chdir(tmp_path)
    for name, at in (("fixed.mha", CENTRE - SHIFT), ("moving.mha", CENTRE)):
        values = np.where(body(at), 700, -900).astype(np.int16)
        values += np.random.default_rng(0).integers(-9, 9, values.shape, np.int16)
        write(values, name)
    labels = np.where(body(CENTRE), 5, 0).astype(np.uint8)
    labels[body(CENTRE) & (np.indices(labels.shape)[2] > 16)] = 2
    write(labels, "labels.nii.gz")
    Path("labels.csv").write_text("id,structure,red,green,blue\n2,left lung,1,0,0\n5,liver,0,1,0\n")
    SimpleITK.WriteTransform(SimpleITK.TranslationTransform(3, SHIFT.tolist()), "T.tfm")
    return tmp_path


def write(values: NDArray[np.generic], name: str) -> None:
    image = SimpleITK.GetImageFromArray(values)
    image.SetSpacing([1.0, 2.0, 1.5])
    SimpleITK.WriteImage(image, name)


def transform(*words: str) -> int:
    return run(["transform", *words])


def middle(path: str, low: float = 0.5) -> NDArray[np.float64]:
    volume = palpate.read(path)
    z, y, x = np.nonzero(volume.values() > low)
    return np.array([x.mean() * 1.0, y.mean() * 2.0, z.mean() * 1.5])


TO_FIXED = ("--transform", "T.tfm", "--like", "fixed.mha")
TO_MOVING = ("--transform", "T.tfm", "--inverse", "--like", "moving.mha")


@pytest.mark.usefixtures("folder")
def test_a_table_of_names_that_would_replace_points_is_refused(
    capsys: pytest.CaptureFixture[str],
) -> None:
    Path("tip.csv").write_text("tip,14,12,12\n")
    outputs = ("-o", "carried.nii.gz", "-o", "carried.csv")
    assert transform("labels.nii.gz", "tip.csv", *TO_FIXED, *outputs) == 2
    said = capsys.readouterr().err
    assert "carried.csv is the table of names of carried.nii.gz too; allowed: another name" in said
    assert not Path("carried.nii.gz").exists()
    assert not Path("carried.csv").exists()


@pytest.mark.usefixtures("folder")
def test_scan_and_label_map_go_to_the_fixed_scan(capsys: pytest.CaptureFixture[str]) -> None:
    outputs = ("-o", "scan.nrrd", "-o", "carried.nii.gz")
    assert transform("moving.mha", "labels.nii.gz", *TO_FIXED, *outputs) == 0
    np.testing.assert_allclose(middle("scan.nrrd", 0.0), middle("fixed.mha", 0.0), atol=1e-6)
    labels = palpate.read("carried.nii.gz").values()
    assert set(np.unique(labels)) == {0, 2, 5}
    np.testing.assert_array_equal(labels > 0, body(CENTRE - SHIFT))
    with Path("carried.csv").open(newline="") as file:
        assert [row[:2] for row in csv.reader(file)][1:] == [["2", "left lung"], ["5", "liver"]]
    said = capsys.readouterr().out.splitlines()
    way = "carried from the moving scan to the fixed one"
    assert said == [
        f"scan.nrrd: a scan, interpolation linear, {way}",
        f"carried.nii.gz: a label map, interpolation nearest, {way}",
    ]


@pytest.mark.usefixtures("folder")
def test_back_again_everything_is_as_it_was() -> None:
    assert transform("labels.nii.gz", *TO_FIXED, "-o", "there.nii.gz") == 0
    assert transform("there.nii.gz", *TO_MOVING, "-o", "back.nii.gz") == 0
    before, after = (palpate.read(name).values() for name in ("labels.nii.gz", "back.nii.gz"))
    np.testing.assert_array_equal(after, before)


@pytest.mark.usefixtures("folder")
def test_a_label_that_does_not_reach_the_grid_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    far = SimpleITK.ReadImage("labels.nii.gz")
    far[0, 0, 0] = 9
    SimpleITK.WriteImage(far, "labels.nii.gz")
    assert transform("labels.nii.gz", *TO_FIXED, "-o", "out.mha") == 0
    assert "warning: labels 9 do not reach the grid" in capsys.readouterr().err


@pytest.mark.usefixtures("folder")
def test_segments_keep_names_colours_and_their_place() -> None:
    words = ("--segments", "labels.nii.gz", "-o", "given.seg.nrrd")
    assert run(["export", "moving.mha", *words]) == 0
    assert transform("given.seg.nrrd", *TO_FIXED, "-o", "out.seg.nrrd") == 0
    found = palpate.read_labels("out.seg.nrrd", palpate.read("fixed.mha")).labels
    assert [one.segment.name for one in found] == ["left lung", "liver"]
    assert found[0].colour == (1.0, 0.0, 0.0)
    together = np.any([one.segment.mask() for one in found], axis=0)
    np.testing.assert_array_equal(together, body(CENTRE - SHIFT))


@pytest.mark.usefixtures("folder")
def test_surfaces_and_points_go_the_same_way_as_images() -> None:
    assert run(["surface", "export", "moving.mha", "body.stl", "--threshold", "0"]) == 0
    Path("marks.csv").write_text(
        "name,kind,value,unit,L1 (mm),P1 (mm),S1 (mm),L2 (mm),P2 (mm),S2 (mm)\n"
        f'"a, b",distance,2.00,mm,{",".join(map(str, CENTRE))},18,14,18\n'
    )
    Path("plain.csv").write_text(f"tip,{','.join(map(str, CENTRE))}\n")
    outputs = ("-o", "out.ply", "-o", "out.csv", "-o", "tip.csv")
    assert transform("body.stl", "marks.csv", "plain.csv", "--transform", "T.tfm", *outputs) == 0
    vertices = palpate.read_mesh(Path("out.ply")).mesh.vertices
    np.testing.assert_allclose(
        0.5 * (vertices.min(axis=0) + vertices.max(axis=0)), middle("fixed.mha", 0.0), atol=0.1
    )
    with Path("out.csv").open(newline="") as file:
        rows = list(csv.reader(file))
    assert rows[1][:4] == ["a, b", "distance", "2.00", "mm"]
    np.testing.assert_allclose([float(cell) for cell in rows[1][4:7]], CENTRE - SHIFT)
    assert Path("tip.csv").read_text().strip() == "tip,10.0000,18.0000,15.0000"
    there = ("--transform", "T.tfm", "--inverse", "-o", "again.csv")
    assert transform("tip.csv", *there) == 0
    assert Path("again.csv").read_text().strip() == "tip,16.0000,14.0000,18.0000"


@pytest.mark.usefixtures("folder")
def test_a_scene_goes_with_its_segments_and_marks() -> None:
    scene = palpate.Scene(palpate.read("moving.mha"))
    scene.add(scene.volume.segment(body(CENTRE), name="lump"), colour=(0.1, 0.2, 0.3))
    mark = {"id": 1, "kind": "point", "name": "tip", "points": [CENTRE.tolist()], "visible": True}
    view = {"camera": None, "remembered": {"marks": {"list": [mark]}, "clip": {"on": True}}}
    with Session(scene, options=SessionOptions(real_time=False)) as session:
        save_scene(Path("moving.palpate"), session, view=view, copy=True)
    assert transform("moving.palpate", *TO_FIXED, "-o", "out.palpate") == 0
    saved = open_scene(Path("out.palpate"))
    made, _ = edited_scene(saved)
    (lump,) = made
    np.testing.assert_array_equal(lump.segment.mask() != 0, body(CENTRE - SHIFT))
    np.testing.assert_array_equal(made.volume.array > 0, body(CENTRE - SHIFT))
    carried = {**mark, "points": [(CENTRE - SHIFT).tolist()]}
    assert saved.view == {"kept": {"mark.1": carried}}


@pytest.mark.usefixtures("folder")
def test_the_inverse_is_written(capsys: pytest.CaptureFixture[str]) -> None:
    assert transform("--transform", "T.tfm", "--write-inverse", "I.tfm") == 0
    assert capsys.readouterr().out == "I.tfm: the inverse is exact\n"
    inverse = SimpleITK.ReadTransform("I.tfm")
    np.testing.assert_allclose(inverse.TransformPoint(CENTRE.tolist()), CENTRE - SHIFT)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            ["moving.mha", "-o", "a.nrrd"],
            "no grid given; allowed: the scan to which images are carried",
        ),
        (["moving.mha", "-o", "a.stl"], "'a.stl' given; allowed: a name with .nii.gz"),
        (["plain.csv", "-o", "a.nrrd"], "'a.nrrd' given; allowed: a name with .csv"),
        (["moving.mha"], "1 inputs and 0 outputs given; allowed: --output once for each INPUT"),
        ([], "nothing to carry given; allowed: one INPUT or more, or --write-inverse"),
        (["moving.mha", "-o", "moving.mha"], "moving.mha is what is read; allowed: a new file"),
        (["none.mha", "-o", "a.mha"], "none.mha does not exist"),
        (
            ["moving.mha", "-o", "a.mha", "--like", "fixed.mha", "--interpolation", "cubic"],
            "interpolation 'cubic' given; allowed: automatic, linear, nearest, labels",
        ),
        (["text.csv", "-o", "a.csv"], "text.csv is no table of points; allowed: X,Y,Z or NAME"),
        (["ras.csv", "-o", "a.csv"], "ras.csv has columns R and A; allowed"),
        (["short.csv", "-o", "a.csv"], "short.csv, line 2: '4,,' given; allowed"),
        (["bare.stl", "-o", "a.stl"], "does not say in which frame it is; allowed: --frame LPS"),
        (["bare.stl", "-o", "a.stl", "--frame", "XYZ"], "frame 'XYZ' given; allowed: LPS, RAS"),
        (
            ["labels.nii.gz", "-o", "a.seg.nrrd", "--like", "fixed.mha", "--of", "moving.mha"],
            "--of SCAN given for labels.nii.gz, which tells its grid itself",
        ),
    ],
)
def test_what_cannot_be_is_refused_and_nothing_is_written(
    folder: Path, capsys: pytest.CaptureFixture[str], words: list[str], said: str
) -> None:
    Path("plain.csv").write_text("1,2,3\n")
    Path("text.csv").write_text("hello,you\n")
    Path("ras.csv").write_text("r,a,s\n1,2,3\n")
    Path("short.csv").write_text("x,y,z\n4\n")
    Path("bare.stl").write_text(
        "solid bare\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 9 0 0\nvertex 0 9 0\n"
        "endloop\nendfacet\nendsolid\n"
    )
    before = sorted(folder.iterdir())
    assert transform(*words, "--transform", "T.tfm") == 2
    err = capsys.readouterr().err
    assert said in err
    assert len(err.strip().splitlines()) == 1
    assert sorted(folder.iterdir()) == before
