"""Exported files are read again as what was written, and nothing half-written is ever there."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from io import BytesIO
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import httpx
import numpy as np
import palpate
import pytest
import SimpleITK
from numpy.typing import NDArray
from palpate.base.errors import OptionError
from palpate.base.whole_file import whole_file, whole_folder
from palpate.cli.commands import run
from palpate.export.export import export_scene
from palpate.export.kinds import KINDS, kind_of
from palpate.io.reading import read
from palpate.saved.scene_file import save_scene
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene
from palpate.volumes.terminology import BY_NAME, Code, Terminology, terminology_of_name
from palpate.volumes.volume import Volume
from pydicom.sr._concepts_dict import concepts

SHAPE = (5, 6, 7)
TURNED = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
LIVER = Terminology(
    Code("123037004", "SCT", "Anatomical Structure"), Code("10200004", "SCT", "Liver")
)
CYST = Terminology(
    Code("49755003", "SCT", "Morphologically Abnormal Structure"),
    Code("367643001", "SCT", "Cyst"),
    side=Code("7771000", "SCT", "Left"),
    region=Code("64033007", "SCT", "Kidney"),
)


def noise(*, slope: float = 1.0, intercept: float = -1024.0) -> Volume:
    """A scan whose values and axes all differ."""
    values = np.random.default_rng(3).integers(0, 3000, SHAPE).astype(np.int16)
    return Volume(
        values,
        spacing=(0.5, 0.75, 2.0),
        origin=(10.0, -20.0, 30.0),
        direction=TURNED,
        slope=slope,
        intercept=intercept,
    )


def box(volume: Volume, start: int, *, name: str) -> palpate.Segment:
    mask = np.zeros(volume.shape, np.uint8)
    mask[1:4, start : start + 3, 2:6] = 1
    return volume.segment(mask, name=name)


@pytest.fixture
def scene() -> Scene:
    """Three segments, of which two share voxels."""
    scene = Scene(noise())
    scene.add(box(scene.volume, 0, name="liver"), colour=(0.625, 0.25, 0.125))
    scene.add(box(scene.volume, 2, name="cyst; «left»\\ kidney"), colour=(0.1, 0.2, 1.0))
    scene.add(box(scene.volume, 3, name="third"))
    first, second, _ = scene
    first.segment.terminology, second.segment.terminology = LIVER, CYST
    return scene


def masks(scene: Scene) -> list[NDArray[np.uint8]]:
    return [one.segment.mask() for one in scene]


# --- segments -----------------------------------------------------------------------------


def test_a_seg_nrrd_keeps_overlaps_names_colours_and_codes(scene: Scene, tmp_path: Path) -> None:
    path = tmp_path / "organs.seg.nrrd"
    assert export_scene(scene, path) == []
    found = palpate.read_labels(path, scene.volume)
    assert found.warnings == ()
    for one, label, mask in zip(scene, found.labels, masks(scene), strict=True):
        assert label.segment.name == one.name
        assert label.colour == pytest.approx(one.colour)
        np.testing.assert_array_equal(label.segment.mask(), mask)
    codes = [label.segment.terminology for label in found.labels]
    assert codes == [LIVER, CYST, terminology_of_name("third")]


def test_segments_apart_take_one_layer(scene: Scene, tmp_path: Path) -> None:
    path = tmp_path / "organs.seg.nrrd"
    export_scene(scene, path, only=["liver", "third"])
    image = SimpleITK.ReadImage(str(path))
    assert (image.GetDimension(), image.GetNumberOfComponentsPerPixel()) == (3, 1)
    assert image.GetMetaData("Segment1_Extent") == "2 5 3 5 1 3"
    assert len(palpate.read_labels(path, scene.volume).labels) == 2


@pytest.mark.parametrize("name", ["labels.nii.gz", "labels.nrrd", "labels.mha", "labels.nii"])
def test_a_label_map_has_names_and_colours_beside_it(
    scene: Scene, tmp_path: Path, name: str
) -> None:
    told = export_scene(scene, tmp_path / name)
    found = palpate.read_labels(tmp_path / name, scene.volume).labels
    assert [label.segment.name for label in found] == [one.name for one in scene]
    assert found[1].colour == pytest.approx((0.1, 0.2, 1.0))
    first, second, third = masks(scene)
    # the last one holds: 12 and 24 voxels
    shared = np.count_nonzero(first & second) + np.count_nonzero(second & third)
    assert told[0].startswith(f"{shared} voxels belong to several segments")
    parts = [first & (1 - second), second & (1 - third), third]
    for label, mask in zip(found, parts, strict=True):
        np.testing.assert_array_equal(label.segment.mask(), mask)


def test_what_cannot_be_in_a_file_is_told(scene: Scene, tmp_path: Path) -> None:
    empty = scene.volume.segment(np.zeros(SHAPE), name="nothing")
    scene.add(empty)
    scene.add(box(scene.volume, 0, name="plate").as_object())
    told = export_scene(scene, tmp_path / "organs.seg.nrrd")
    assert told == [
        "plate has a grid of its own and is left out: write its surface instead",
        "nothing is empty and is left out",
    ]
    assert len(palpate.read_labels(tmp_path / "organs.seg.nrrd", scene.volume).labels) == 3


@pytest.mark.parametrize("row", BY_NAME, ids=lambda row: row[2])
def test_codes_of_names_are_those_of_snomed(row: tuple[str, str, str]) -> None:
    snomed: Any = concepts["SCT"]
    known = {code for codes in snomed.values() for code in codes}
    assert row[1] in known


def test_names_tell_kind_and_side() -> None:
    found = terminology_of_name("lung_upper_lobe_left")
    assert (found.kind.meaning, found.side and found.side.meaning) == ("Lung", "Left")
    assert terminology_of_name("urinary_bladder").kind.meaning == "Urinary bladder"
    assert terminology_of_name("cleft").side is None


# --- the scan -----------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["scan.nii.gz", "scan.nrrd", "scan.mha"])
@pytest.mark.parametrize(("slope", "intercept"), [(1.0, -1024.0), (0.25, 0.5)])
def test_a_scan_comes_back_with_its_values_and_its_place(
    tmp_path: Path, name: str, slope: float, intercept: float
) -> None:
    volume = noise(slope=slope, intercept=intercept)
    export_scene(Scene(volume), tmp_path / name)
    values = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(tmp_path / name)))
    np.testing.assert_array_equal(values, volume.array * slope + intercept)
    assert values.dtype == (np.int16 if slope == 1.0 else np.float32)
    again = read(tmp_path / name)
    # NIfTI keeps places as float32
    np.testing.assert_allclose(again.patient_from_grid, volume.patient_from_grid, atol=1e-5)


def test_a_saved_scene_is_exported_with_its_edits(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    z, y, x = np.mgrid[0:41, 0:41, 0:41] - 20.0
    ball = np.where(x * x + y * y + z * z <= 64.0, 100, -1000).astype(np.int16)
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(ball), str(tmp_path / "ball.nrrd"))
    volume = read(tmp_path / "ball.nrrd", unit="HU")
    scene = Scene(volume, [volume.threshold(0.0, name="ball")])
    path = tmp_path / "work.palpate"
    with Session(scene, options=SessionOptions(real_time=False, start=(20, 20, 40))) as session:
        session.set_tool("drill", radius=2.0, segment_ids=[1])
        session.stroke(on=True)
        session.hand((20.0, 20.0, 20.0))
        session.run(1.0)
        session.stroke(on=False)
        left = session.segment(1).mask()
        looks = b'[{"id":1,"touchable":true,"look":{"name":"bone ball","colour":[0,1,0]}}]'
        save_scene(path, session, looks=looks)
    drilled = (scene_mask := ball > 0) & (left == 0)
    assert 10 < np.count_nonzero(drilled) < np.count_nonzero(scene_mask)

    assert run(["export", str(path), "-o", str(tmp_path / "work.seg.nrrd")]) == 0
    label = palpate.read_labels(tmp_path / "work.seg.nrrd", volume).labels[0]
    assert (label.segment.name, label.colour) == ("bone ball", (0.0, 1.0, 0.0))
    np.testing.assert_array_equal(label.segment.mask(), left)

    assert run(["export", str(path), "--as", "scan", "-o", str(tmp_path / "work.nii.gz")]) == 0
    values = read(tmp_path / "work.nii.gz").array
    np.testing.assert_array_equal(values, np.where(drilled, -1000, ball))
    assert "work.nii.gz: " in capsys.readouterr().out


# --- what is refused ----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "options", "said"),
    [
        ("organs.stl", {}, "allowed: a name with .seg.nrrd, .nii.gz, .nii, .nrrd, .mha, .dcm"),
        ("organs.nii", {"kind": "seg-nrrd"}, "'organs.nii' given for seg-nrrd; allowed"),
        ("none/organs.seg.nrrd", {}, "allowed: one that exists"),
        ("organs.seg.nrrd", {"only": ["spleen"]}, "allowed: liver, "),
        ("organs.dcm", {}, "allowed: with `keep_identity=True` for an archive"),
        ("organs.dcm", {"keep_identity": True}, "comes from no file; allowed: .seg.nrrd, NIfTI"),
        ("folder", {}, "comes from no file; allowed: .seg.nrrd, NIfTI"),
    ],
)
def test_what_cannot_be_written_is_refused(
    scene: Scene, tmp_path: Path, name: str, options: dict[str, Any], said: str
) -> None:
    with pytest.raises(OptionError, match=said.replace(".", r"\.")):
        export_scene(scene, tmp_path / name, **options)
    assert list(tmp_path.iterdir()) == []


def test_a_scan_of_other_files_is_told_what_to_use(
    write_image: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write_image(noise().array)
    for name in ("seg.dcm", "folder"):
        options = ["--threshold", "100", "--keep-identity", "-o", str(tmp_path / name)]
        assert run(["export", str(path), *options]) == 2
        assert "is no DICOM series; allowed: .seg.nrrd, NIfTI or NRRD" in capsys.readouterr().err
    assert run(["export", str(path), "-o", str(tmp_path / "seg.seg.nrrd")]) == 2
    assert "no segments given; allowed: --segments FILE" in capsys.readouterr().err
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


def test_every_kind_has_a_name_that_asks_for_it() -> None:
    names = {"seg-nrrd": "a.seg.nrrd", "labels": "a.nii", "dicom-seg": "a.dcm", "dicom": "a"}
    assert {kind: kind_of(Path(name), has_segments=True) for kind, name in names.items()} == {
        kind: kind for kind in names
    }
    assert kind_of(Path("a.nii"), has_segments=False) == "scan"
    assert set(names) < set(KINDS)


# --- full disks ---------------------------------------------------------------------------

NARROW = """
import resource, sys
from palpate.base.reader_process import warm
from palpate.cli.commands import run
warm()  # a reader started below would keep the limit
resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))
sys.exit(run(sys.argv[1:]))
"""
"""Runs a command that may write files of 2000 bytes at most, as on a disk that is full then."""


@pytest.mark.parametrize("name", ["old.seg.nrrd", "old.nii.gz", "old.nii", "old.nrrd"])
def test_a_full_disk_leaves_what_was_there(tmp_path: Path, name: str) -> None:
    values = np.random.default_rng(1).integers(0, 1000, (40, 40, 40)).astype(np.int16)
    scan = tmp_path / "scan.mha"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(scan))
    out = tmp_path / "out"
    out.mkdir()
    (out / name).write_text("what was there")
    options = ["--threshold", "500", "-o", str(out / name)]
    ended = subprocess.run(
        [sys.executable, "-c", NARROW, "export", str(scan), *options],
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 2, ended.stderr
    assert "allowed" in ended.stderr
    assert "scan.mha" not in ended.stderr  # it is the writer that fails, not the reader
    assert "Traceback" not in ended.stderr
    assert (out / name).read_text() == "what was there"
    assert [file.name for file in out.iterdir()] == [name]


def test_files_and_folders_appear_when_they_are_whole(tmp_path: Path) -> None:
    def broken(target: Path) -> None:
        target.write_text("1")
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError), whole_folder(tmp_path / "made") as folder:
        broken(folder / "one")
    with pytest.raises(ZeroDivisionError), whole_file(tmp_path / "made.txt") as file:
        broken(file)
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "made").mkdir()
    with whole_folder(tmp_path / "made") as folder:
        (folder / "one").write_text("1")
    assert (tmp_path / "made" / "one").read_text() == "1"
    with pytest.raises(OptionError, match="is there already"), whole_folder(tmp_path / "made"):
        pass


# --- the page's door ----------------------------------------------------------------------


def asked(server: Any, door: str = "export", **wanted: Any) -> httpx.Response:
    access = server.access
    return httpx.post(
        f"{server.base}/api/{door}",
        headers={"Cookie": f"{access.cookie}={access.token}"},
        json=wanted,
        trust_env=False,
        timeout=60.0,
    )


def test_a_page_gets_what_the_command_writes(shared_server: Any, tmp_path: Path) -> None:
    volume = shared_server.session.scene.volume
    answer = asked(shared_server, kind="seg-nrrd")
    assert answer.status_code == 200
    assert 'filename="ball.seg.nrrd"' in answer.headers["content-disposition"]
    path = tmp_path / "ball.seg.nrrd"
    path.write_bytes(answer.content)
    label = palpate.read_labels(path, volume).labels[0]
    assert label.segment.name == "ball"
    np.testing.assert_array_equal(label.segment.mask(), shared_server.session.segment(1).mask())
    packed = asked(shared_server, kind="labels")
    assert 'filename="ball.zip"' in packed.headers["content-disposition"]
    with zipfile.ZipFile(BytesIO(packed.content)) as archive:
        assert sorted(archive.namelist()) == ["labels.csv", "labels.nii.gz"]


def test_a_page_gets_a_surface_and_what_it_keeps(shared_server: Any, tmp_path: Path) -> None:
    answer = asked(shared_server, "surface", segment=1, format="ply")
    assert answer.status_code == 200
    assert 'filename="ball.ply"' in answer.headers["content-disposition"]
    path = tmp_path / "ball.ply"
    path.write_bytes(answer.content)
    count = len(palpate.read_mesh(path).mesh.triangles)
    told = unquote(answer.headers["x-palpate-notes"]).split("\n")[0]
    assert told.startswith(f"ball.ply: segment 'ball', {count} triangles, ")
    assert "in 1 body (voxels: " in told
    assert told.endswith(" in 1 body), LPS")
    refused = asked(shared_server, "surface", segment=9)
    assert (refused.status_code, refused.text) == (400, "segment 9 cannot be used. Use 1")


@pytest.mark.parametrize(
    ("wanted", "said"),
    [
        ({"kind": "dicom"}, "comes from no file. Use .seg.nrrd"),
        ({"kind": "stl"}, "this is no export"),
        ({"kind": "x" * 300_000}, "at most 262144"),
    ],
)
def test_a_page_is_told_why_not(shared_server: Any, wanted: dict[str, str], said: str) -> None:
    answer = asked(shared_server, **wanted)
    assert answer.status_code == 400
    assert said in answer.text
