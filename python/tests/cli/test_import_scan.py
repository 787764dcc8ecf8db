"""``palpate import``: what is at a place, and a scan of it in one file."""

from __future__ import annotations

import json
import resource
import shutil
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
import SimpleITK
from palpate.base.errors import OptionError
from palpate.base.reader_process import warm
from palpate.cli.commands import run
from palpate.saved.scene_file import open_scene
from palpate.session.session import Session, SessionOptions


@pytest.fixture
def study(write_series: Any) -> Path:
    """A folder with two series of four slices, and one that is a single picture."""
    write_series(uid="1.2.3", prefix="a", description="thin", PatientName="Doe^Jane")
    write_series(uid="1.2.4", prefix="b", description="thick", scale=(1.0, 0.0))
    folder: Path = write_series(
        uid="1.2.5", prefix="c", description="scout", positions=[(0.0, 0.0, 0.0)]
    )
    return folder


def imported(capsys: pytest.CaptureFixture[str], *arguments: str | Path) -> Any:
    """Runs the command for programs; returns what it says."""
    assert run(["import", *map(str, arguments), "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def fails(capsys: pytest.CaptureFixture[str], *arguments: str | Path) -> str:
    """Runs what has to fail; returns the one line it says."""
    assert run(["import", *map(str, arguments)]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    return said.err


def test_several_series_are_listed_and_one_is_written(
    study: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    listed = imported(capsys, study)
    assert [one["series"] for one in listed] == ["thin", "thick", "scout"]
    assert listed[0] == {
        "number": 1,
        "patient": "Doe^Jane",
        "study": "",
        "series": "thin",
        "modality": "CT",
        "slices": 4,
        "columns": 4,
        "rows": 3,
        "spacing_mm": [0.75, 0.5, 2.5],
        "bytes": 96,
        "uid": "1.2.3",
        "refused": None,
    }
    assert run(["import", str(study)]) == 0
    table = capsys.readouterr().out
    assert "4 x 3 x 4" in table
    assert "3 cannot be read: it is a 2-D image" in table

    out = tmp_path / "thick.nii.gz"
    assert "choose one with --series NUMBER" in fails(capsys, study, "-o", out)
    assert not out.exists()
    for wanted in ("2", "1.2.4", "thick"):
        told = imported(capsys, study, "--series", wanted, "--output", out)
        assert told["dimensions"] == [4, 3, 4]
        assert told["written"] == [{"file": str(out), "holds": "scan", "bytes": out.stat().st_size}]
        again = palpate.read(out)
        expected = palpate.read(study, series="1.2.4")
        np.testing.assert_array_equal(again.array, expected.array)
        np.testing.assert_allclose(again.patient_from_grid, expected.patient_from_grid)
        out.unlink()


@pytest.mark.parametrize("name", ["ct.nii", "ct.nii.gz", "ct.nrrd", "ct.mha", "ct.palpate"])
def test_files_of_each_kind_hold_the_scan(
    study: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    told = imported(capsys, study, "--series", "1", "-o", tmp_path / name)
    assert [each["file"] for each in told["written"]] == [str(tmp_path / name)]
    expected = palpate.read(study, series="1")
    # whatever the scan came from is no longer needed
    shutil.rmtree(study)
    scene = name.endswith(".palpate")
    volume = open_scene(tmp_path / name).volume if scene else palpate.read(tmp_path / name)
    np.testing.assert_array_equal(volume.array, expected.array)
    np.testing.assert_allclose(volume.patient_from_grid, expected.patient_from_grid)
    assert b"Doe" not in (tmp_path / name).read_bytes()


def test_what_was_resampled_missing_and_left_out_is_said(
    write_series: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    places = [(0.0, 0.0, 2.0 * k) for k in (0, 1, 2, 4, 5)]
    folder = write_series(positions=places)
    content = (folder / "000").read_bytes()
    # columns of a kind that DICOM does not know
    place = content.index(bytes.fromhex("28001100")) + 4
    (folder / "damaged").write_bytes(content[:place] + b"ZZ" + content[place + 2 :])
    told = imported(capsys, folder, "-o", tmp_path / "ct.nrrd")
    assert told["dimensions"] == [4, 3, 6]
    assert any("1 slice is missing, after number 3" in each for each in told["warnings"])
    assert any("1 file is damaged and was left out" in each for each in told["warnings"])
    assert run(["import", str(folder)]) == 0
    assert "1 slice is missing" in " ".join(capsys.readouterr().out.split())


def test_files_given_one_by_one_are_one_scan(
    study: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = sorted(study.glob("a*"))
    out = tmp_path / "thin.mha"
    # the same one twice is no copy
    told = imported(capsys, *files, files[0], "-o", out)
    assert (told["series"], told["warnings"]) == ("1.2.3", [])
    expected = palpate.read(study, series="1.2.3")
    np.testing.assert_array_equal(palpate.read(out).array, expected.array)
    volume = palpate.read(files)
    np.testing.assert_array_equal(volume.array, expected.array)
    assert volume.source is None
    # files of several series are listed, folders among them are looked into
    listed = imported(capsys, *files, *study.glob("b*"))
    assert [one["uid"] for one in listed] == ["1.2.3", "1.2.4"]
    assert len(imported(capsys, study, files[0])) == 3
    note = tmp_path / "note.txt"
    note.write_text("x" * 200)
    assert "allowed together: DICOM files and folders" in fails(capsys, *files, note)
    assert "does not exist" in fails(capsys, *files, tmp_path / "nowhere")
    with pytest.raises(OptionError, match="for one file or folder"):
        palpate.read(files, raw="4x3,int16")
    with pytest.raises(OptionError, match="no path given"):
        palpate.read([])


def test_image_files_of_a_folder_or_an_archive_are_chosen_alike(
    write_image: Any, small_values: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "images"
    folder.mkdir()
    for number in (1, 2):
        write_image(small_values + number, f"{number}.nii.gz").rename(folder / f"{number}.nii.gz")
    archive = tmp_path / "images.zip"
    with zipfile.ZipFile(archive, "w") as packed:
        for file in folder.iterdir():
            packed.write(file, file.name)
    out = tmp_path / "one.nrrd"
    for place in (folder, archive):
        listed = imported(capsys, place)
        assert [(one["number"], one["series"]) for one in listed] == [
            (1, "1.nii.gz"),
            (2, "2.nii.gz"),
        ]
        for wanted in ("2", "2.nii.gz"):
            imported(capsys, place, "--series", wanted, "-o", out, "--force")
            np.testing.assert_array_equal(palpate.read(out).array, small_values + 2)
        out.unlink()
        assert "none is '3'" in fails(capsys, place, "--series", "3", "-o", out)


def test_a_number_goes_on_after_the_series(
    study: Path, write_image: Any, small_values: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    write_image(small_values, "mask.nii.gz").rename(study / "mask.nii.gz")
    listed = imported(capsys, study)
    assert (listed[3]["number"], listed[3]["series"]) == (4, "mask.nii.gz")
    assert imported(capsys, study, "--series", "4")["dimensions"] == [7, 6, 5]
    assert imported(capsys, study, "--series", "2")["series"] == "1.2.4"


def test_segments_go_beside_the_scan_or_into_the_scene(
    study: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    volume = palpate.read(study, series="1")
    mask = np.zeros(volume.shape, np.uint8)
    mask[1:3, 1:, 1:3] = 1
    labels = tmp_path / "labels.nrrd"
    image = SimpleITK.GetImageFromArray(mask)
    image.SetSpacing(volume.spacing)
    image.SetOrigin(volume.origin)
    SimpleITK.WriteImage(image, str(labels))
    asked: list[str | Path] = [study, "--series", "1", "--segments", labels, "-o"]
    told = imported(capsys, *asked, tmp_path / "ct.nii.gz")
    assert [(Path(each["file"]).name, each["holds"]) for each in told["written"]] == [
        ("ct.nii.gz", "scan"),
        ("ct.seg.nrrd", "1 segment"),
    ]
    again = palpate.read(tmp_path / "ct.nii.gz")
    (label,) = palpate.read_labels(tmp_path / "ct.seg.nrrd", again).labels
    np.testing.assert_array_equal(label.segment.mask() != 0, mask != 0)

    imported(capsys, *asked, tmp_path / "ct.palpate")
    saved = open_scene(tmp_path / "ct.palpate")
    with Session(saved.scene(), options=SessionOptions(real_time=False)) as session:
        saved.restore(session)
        assert [each["voxels"] for each in session.segments()] == [int(mask.sum())]

    beside = tmp_path / "ct.seg.nrrd"
    assert "is what is read" in fails(
        capsys, study, "--series", "1", "--segments", beside, "-o", tmp_path / "ct.nrrd"
    )
    assert "allowed: with --output FILE" in fails(capsys, study, "--segments", labels)
    nowhere = tmp_path / "nowhere"
    assert "does not exist" in fails(capsys, study, "--segments", nowhere, "-o", "ct.nrrd")


def test_raw_voxels_are_imported_with_their_layout(
    tmp_path: Path, small_values: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "scan.raw"
    path.write_bytes(small_values.astype(">i2").tobytes())
    options = ("--raw", "7x6x5,int16,big", "--voxel-size", "1,2,3", "--orientation", "RAS")
    told = imported(capsys, path, *options, "--unit", "HU", "-o", tmp_path / "scan.mha")
    assert (told["spacing_mm"], told["orientation"], told["unit"]) == ([1, 2, 3], "RAS", "HU")
    again = palpate.read(tmp_path / "scan.mha")
    np.testing.assert_array_equal(again.array, small_values)
    assert again.orientation == "RAS"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ([], "no place given; allowed: PATH…, or --dicomweb URL"),
        (["here", "--dicomweb", "http://host"], "a path and --dicomweb given"),
        (["here"], "here does not exist"),
        (["here", "-o", "ct.dcm"], "allowed: a name with .nii.gz, .nii, .nrrd, .mha, .palpate"),
        (["here", "-o", "ct.seg.nrrd"], "palpate export writes DICOM and .seg.nrrd"),
        (["here", "-o", "nowhere/ct.nrrd"], "folder 'nowhere' given; allowed: one that exists"),
        (["ct.nrrd", "-o", "ct.nrrd"], "ct.nrrd is what is read; allowed: a new file"),
        (["here", "--study", "1.2"], "allowed: with --dicomweb only"),
        (["here", "--volume", "2"], "allowed: with --dicomweb only"),
        (["--dicomweb", "http://host", "--unit", "HU"], "options of reading given"),
        (["--dicomweb", "http://host", "-o", "ct", "--volume", "2"], "options of reading given"),
    ],
)
def test_what_cannot_be_is_refused_before_anything_is_read(
    arguments: list[str],
    said: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ct.nrrd").touch()
    assert said in fails(capsys, *arguments)


def test_a_full_disk_leaves_what_was_there(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    values = np.random.default_rng(1).integers(0, 1000, (40, 40, 40)).astype(np.int16)
    scan = tmp_path / "scan.mha"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(scan))
    out = tmp_path / "out"
    out.mkdir()
    for name in ("old.nrrd", "old.palpate"):
        (out / name).write_text("what was there")
        with narrow_disk():
            # it is the writer that fails, not the reader
            assert "scan.mha" not in fails(capsys, scan, "-o", out / name)
        assert (out / name).read_text() == "what was there"
    assert {file.name for file in out.iterdir()} == {"old.nrrd", "old.palpate"}


@contextmanager
def narrow_disk() -> Iterator[None]:
    """Lets files have 2000 bytes at most, as on a disk that is full then."""
    # a reader started below would keep the limit, and could not hand over what it read
    warm()
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2000, limits[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
