"""Files of DICOM are known without a mark too, and found through their directory."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
from dicom_cases import case, marker, values_of
from palpate.base.errors import VolumeFormatError
from palpate.io.browse import browsed
from palpate.io.dicom.series import is_dicom
from palpate.io.reading import list_series
from pydicom import dcmread
from pydicom.dataset import Dataset
from pydicom.filebase import DicomFileLike
from pydicom.filewriter import write_dataset


@pytest.mark.data
def test_data_sets_without_a_mark_are_read(data_folder: Path) -> None:
    volume = palpate.read(case(data_folder, 20))
    assert marker(volume) == [5.0, 6.0, 20.0]
    assert volume.dimensions[2] == 12


@pytest.mark.parametrize(("implicit", "little"), [(True, True), (False, True), (False, False)])
def test_data_sets_of_every_encoding_are_read(
    write_series: Any, *, implicit: bool, little: bool
) -> None:
    folder = write_series()
    expected = values_of(palpate.read(folder))
    for path in folder.iterdir():
        dataset = dcmread(path)
        if not little:
            swapped = np.frombuffer(dataset.PixelData, "<u2").astype(">u2")
            dataset.PixelData = swapped.tobytes()
        bare = Dataset()
        bare.update(dataset)
        with path.open("wb") as file:
            place = DicomFileLike(file)
            place.is_implicit_VR, place.is_little_endian = implicit, little
            write_dataset(place, bare)
    assert all(is_dicom(path) for path in folder.iterdir())
    np.testing.assert_array_equal(values_of(palpate.read(folder)), expected)


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\x08\x00\x05\x00",
        b"\x08\x00\x05\x00CS\x0a\x00ISO_IR 100",
        b"\x08\x00\x05\x00" * 100,
        b"\x08\x00\x05\x00CS\xff\x7f" + bytes(600),
        b"\x5c\x01\x00\x00" + bytes(600),
        bytes(4000),
        b"\x08\x00\x08\x00\x01\x00\x00\x00" * 400,
        np.random.default_rng(1).integers(0, 256, 5000, np.uint8).tobytes(),
    ],
)
def test_other_bytes_are_no_data_set(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "file").write_bytes(content)
    assert not is_dicom(tmp_path / "file")


# --- directories of media -----------------------------------------------------------------


@pytest.mark.data
def test_a_dicomdir_opens_what_it_lists(data_folder: Path) -> None:
    path = case(data_folder, 28) / "media" / "DICOMDIR"
    volume = palpate.read(path)
    assert marker(volume) == [5.0, 6.0, 20.0]
    assert volume.dimensions == palpate.read(path.parent).dimensions
    assert [series.slices for series in list_series(path)] == [volume.dimensions[2]]
    with browsed(path) as choices:
        assert [choice.size for choice in choices] == [volume.dimensions]


@pytest.mark.data
def test_files_that_a_dicomdir_lists_and_that_are_missing_are_told(
    data_folder: Path, tmp_path: Path
) -> None:
    media = tmp_path / "media"
    shutil.copytree(case(data_folder, 28) / "media", media)
    last = sorted(media.rglob("IM*"))[-1]
    last.unlink()
    warnings = palpate.read(media / "DICOMDIR").warnings
    assert f"1 file is missing and was left out, such as {last.name}" in warnings
    shutil.rmtree(media / "PT000000")
    with pytest.raises(VolumeFormatError, match=r"0 of \d+ files found below.*allowed"):
        palpate.read(media / "DICOMDIR")


@pytest.mark.data
@pytest.mark.filterwarnings("ignore:Invalid value for VR")
def test_a_dicomdir_leads_to_no_files_elsewhere(data_folder: Path, tmp_path: Path) -> None:
    source = case(data_folder, 28) / "media"
    (tmp_path / "media").mkdir()
    shutil.copytree(source / "PT000000", tmp_path / "PT000000")
    (tmp_path / "media" / "PT000000").symlink_to(tmp_path / "PT000000")
    directory = dcmread(source / "DICOMDIR")
    directory.save_as(tmp_path / "media" / "LINKED")
    for record in directory.DirectoryRecordSequence:
        if "ReferencedFileID" in record:
            record.ReferencedFileID = ["..", *record.ReferencedFileID]
    directory.save_as(tmp_path / "media" / "ABOVE")
    for name in ("LINKED", "ABOVE"):
        with pytest.raises(VolumeFormatError, match="0 of 12 files found below its folder"):
            palpate.read(tmp_path / "media" / name)


# --- files of other programs ----------------------------------------------------------------


def test_files_that_macos_keeps_beside_others_are_no_slices(write_series: Any) -> None:
    folder = write_series()
    (folder / "__MACOSX").mkdir()
    for path in [path for path in folder.iterdir() if path.is_file()]:
        (folder / f"._{path.name}").write_bytes(path.read_bytes()[:200])
        (folder / "__MACOSX" / path.name).write_bytes(path.read_bytes()[:200])
    volume = palpate.read(folder)
    assert volume.dimensions == (4, 3, 4)
    assert not any("left out" in warning for warning in volume.warnings)
