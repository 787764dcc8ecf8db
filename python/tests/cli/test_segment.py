"""``palpate segment``: what it writes is read again, by the package and by SimpleITK."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK
from palpate.cli.commands import run
from palpate.io.reading import read
from palpate.labels.labels import read_labels
from palpate.segmentation.request import SegmentRequest
from palpate.volumes.volume import Volume, VolumeTraits

SPACING = (1.0, 1.5, 2.0)


@pytest.fixture
def scan(write_image: Any) -> Path:
    """Two balls of 300 and 600, the larger one hollow, with a speck."""
    z, y, x = np.indices((30, 32, 60))
    places = np.stack([x, y, z], axis=-1) * SPACING
    values = np.zeros(z.shape, np.int16)
    off = np.linalg.norm(places - (18.0, 24.0, 30.0), axis=-1)
    values[(off <= 14.0) & (off > 5.0)] = 300
    values[np.linalg.norm(places - (46.0, 24.0, 30.0), axis=-1) <= 8.0] = 600
    values[1, 1, 1] = 300
    path: Path = write_image(values, "scan.mha", spacing=SPACING)
    return path


def segment(*arguments: str | Path) -> int:
    return run(["segment", *map(str, arguments)])


@pytest.mark.parametrize("name", ["one.seg.nrrd", "one.nii.gz", "one.nrrd", "one.mha"])
def test_what_is_written_is_read_again(scan: Path, tmp_path: Path, name: str, capsys: Any) -> None:
    out = tmp_path / "made" / name
    out.parent.mkdir()
    options = ["--threshold", "200", "--keep-largest", "--fill", "--name", "ball"]
    assert segment(scan, *options, "-o", out) == 0
    volume = read(scan)
    (found,) = read_labels(out, volume).labels
    z, y, x = np.indices(volume.shape)
    off = np.linalg.norm(np.stack([x, y, z], axis=-1) * SPACING - (18.0, 24.0, 30.0), axis=-1)
    np.testing.assert_array_equal(found.segment.mask() != 0, off <= 14.0)
    image = SimpleITK.ReadImage(str(out))
    np.testing.assert_allclose(image.GetSpacing(), SPACING, rtol=1e-6)
    if name == "one.seg.nrrd":
        assert found.segment.name == "ball"
        low, high = found.segment.bounding_box or ((0,) * 3, (0,) * 3)
        extent = " ".join(f"{a} {b - 1}" for a, b in zip(low, high, strict=True))
        assert image.GetMetaData("Segment0_Extent") == extent
    # whole, with names beside it where they do not fit in
    beside = set() if name == "one.seg.nrrd" else {"one.csv"}
    assert {one.name for one in out.parent.iterdir()} == {name} | beside
    assert capsys.readouterr().out.startswith(f"{out}: ball, ")


def test_otsu_writes_each_class_as_a_label(scan: Path, tmp_path: Path) -> None:
    out = tmp_path / "classes.seg.nrrd"
    assert segment(scan, "--otsu", "3", "-o", out) == 0
    volume = read(scan)
    names = {one.segment.name: one.segment.mask() != 0 for one in read_labels(out, volume).labels}
    np.testing.assert_array_equal(names["Otsu 2 of 3"], volume.array == 300)
    np.testing.assert_array_equal(names["Otsu 3 of 3"], volume.array == 600)


def test_a_region_grows_from_a_point_of_the_patient(scan: Path, tmp_path: Path) -> None:
    out = tmp_path / "grown.mha"
    assert segment(scan, "--grow", "46,24,30", "--passage", "4", "-o", out) == 0
    mask = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(out))) != 0
    ball = read(scan).array == 600
    both = np.count_nonzero(mask & ball)
    assert 2.0 * both / (np.count_nonzero(mask) + np.count_nonzero(ball)) > 0.85


def test_other_segments_of_files_are_added_taken_away_or_kept(scan: Path, tmp_path: Path) -> None:
    values = read(scan).array
    soft = tmp_path / "soft.nii.gz"
    assert segment(scan, "--threshold", "200,400", "-o", soft) == 0
    for option, expected in [
        ("--unite", values > 0),
        ("--subtract", values == 600),
        ("--intersect", values == 300),
    ]:
        out = tmp_path / f"{option}.mha"
        low = "500" if option == "--unite" else "200"
        assert segment(scan, "--threshold", low, option, soft, "-o", out) == 0
        mask = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(out))) != 0
        np.testing.assert_array_equal(mask, expected)


def test_presets_are_ranges_of_tissues_in_hu_alone(
    write_image: Any, tmp_path: Path, capsys: Any
) -> None:
    values = np.zeros((10, 10, 10), np.int16)
    values[2:8, 2:8, 2:5] = 300
    values[2:8, 2:8, 5:8] = 100
    path = write_image(values, "ct.mha", spacing=SPACING)
    out = tmp_path / "bone.mha"
    assert segment(path, "--threshold", "bone", "-o", out) == 2
    assert "not known to be HU" in capsys.readouterr().err
    volume = Volume(values, spacing=SPACING, traits=VolumeTraits(unit="HU"))
    for name, value in (("bone", 300), ("muscle", 100)):
        request = SegmentRequest(threshold=name)
        request.check()
        ((found,), _) = request.make(volume)
        known = (values == value) | ((values == 0) & (name == "muscle"))
        np.testing.assert_array_equal(found.mask() != 0, known)
    assert segment(path, "--threshold", "marrow", "-o", out) == 2
    assert "or one of bone, compact bone" in capsys.readouterr().err


def test_the_sign_of_a_shell_tells_its_side_and_smoothing_takes_specks(
    scan: Path, tmp_path: Path
) -> None:
    ball = read(scan).array == 600
    masks = {}
    options = {"in": ["--hollow", "3"], "out": ["--hollow", "-3"], "median": ["--median", "1.2"]}
    options |= {"opening": ["--opening", "3"], "closing": ["--closing", "3"]}
    for name, option in options.items():
        out = tmp_path / f"{name}.mha"
        assert segment(scan, "--threshold", "500", *option, "-o", out) == 0
        masks[name] = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(out))) != 0
    assert (masks["in"] & ball).any()
    assert not (masks["in"] & ~ball).any()
    assert (masks["out"] & ~ball).any()
    assert not (masks["out"] & ball).any()
    assert not (masks["opening"] & ~ball).any()
    assert (masks["closing"] | ~ball).all()
    assert np.count_nonzero(masks["median"] ^ ball) < 0.2 * np.count_nonzero(ball)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--margin", "1"], "grow by 1 mm changes nothing along y (voxels of 1.5 mm) and z"),
        (["--opening", "1.5"], "open by 1.5 mm changes nothing along z (voxels of 2 mm)"),
        (["--hollow", "1.5"], "a shell of 1.5 mm is one voxel thick, so that it encloses, along z"),
        (["--margin", "2"], None),
    ],
)
def test_what_voxels_cannot_express_is_told_and_done(
    scan: Path, tmp_path: Path, capsys: Any, options: list[str], said: str | None
) -> None:
    assert segment(scan, "--threshold", "500", *options, "-o", tmp_path / "out.mha") == 0
    told = capsys.readouterr().err
    assert said in told if said else "voxel" not in told


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (
            [],
            "one of --threshold LOW,HIGH, --otsu CLASSES, --grow X,Y,Z, --seeds FILE, --auto",
        ),
        (["--threshold", "1", "--fast"], "--fast given; allowed: with --auto only"),
        (["--threshold", "1", "--otsu", "2"], "2 ways to make a segment given"),
        (["--grow", "1,2"], "point '1,2' given; allowed: X,Y,Z [mm]"),
        (["--grow", "900,0,0"], "seed 900, 0, 0 mm lies outside"),
        (["--threshold", "200", "--spread", "2"], "options of growing given"),
        (["--threshold", "200", "--margin", "-90"], "after shrink 90; allowed: smaller changes"),
        (
            ["--threshold", "200", "--hollow", "0.01"],
            "shell of 0.01 mm given; allowed: a voxel's smallest side at least, 1 mm",
        ),
        (["--threshold", "5000"], "selects no voxel"),
    ],
)
def test_what_cannot_be_is_refused_and_nothing_is_written(
    scan: Path, tmp_path: Path, capsys: Any, options: list[str], said: str
) -> None:
    out = tmp_path / "none.seg.nrrd"
    out.write_bytes(b"kept")
    assert segment(scan, *options, "--force", "-o", out) == 2
    assert said in capsys.readouterr().err
    assert out.read_bytes() == b"kept"
    assert sorted(one.name for one in tmp_path.iterdir()) == ["none.seg.nrrd", "scan.mha"]


def test_an_ending_that_says_no_format_is_refused(scan: Path, tmp_path: Path, capsys: Any) -> None:
    assert segment(scan, "--threshold", "200", "-o", tmp_path / "out.png") == 2
    assert "'out.png' given; allowed: a name with .seg.nrrd" in capsys.readouterr().err
