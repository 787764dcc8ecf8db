"""Each slice counts once, and a bad one among good ones is left out and named."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
from dicom_cases import case, marker, values_of
from palpate.base.errors import OptionError, PalpateError
from palpate.export.export import export_scene
from palpate.io.reading import list_series
from palpate.volumes.scene import Scene
from pydicom import dcmread
from pydicom.dataset import FileDataset
from pydicom.encaps import encapsulate
from pydicom.uid import JPEG2000Lossless, generate_uid

PLACES = [(-10.0, -20.0, 30.0 + 2.5 * k) for k in range(12)]


def said(volume: Any, words: str) -> bool:
    return any(words in warning for warning in volume.warnings)


# --- identifiers and doubles ------------------------------------------------------------------


@pytest.mark.data
def test_one_uid_for_all_slices_takes_none_away(data_folder: Path) -> None:
    volume = palpate.read(case(data_folder, 21))
    assert (marker(volume), volume.dimensions[2]) == ([5.0, 6.0, 20.0], 12)
    assert said(volume, "12 different slices share their SOP Instance UIDs")


@pytest.mark.data
@pytest.mark.parametrize(
    ("kind", "copies"),
    [
        ("one", "1 file is a copy of another and was"),
        ("twice", "12 files are copies of others and were"),
    ],
)
def test_doubles_of_slices_are_left_out_and_told(data_folder: Path, kind: str, copies: str) -> None:
    volume = palpate.read(case(data_folder, 29) / kind)
    assert (marker(volume), volume.dimensions[2]) == ([5.0, 6.0, 20.0], 12)
    assert said(volume, f"{copies} left out, such as ")


@pytest.mark.parametrize("uid", ["same", "other"])
def test_doubles_that_differ_are_refused_by_name(write_series: Any, uid: str) -> None:
    folder = write_series()
    dataset = dcmread(folder / "097")
    dataset.PixelData = np.arange(12, dtype="<u2").tobytes()
    if uid == "other":
        dataset.SOPInstanceUID = generate_uid()
    dataset.save_as(folder / "100")
    with pytest.raises(PalpateError, match=r"such as 097 and 100, whose pixels differ; allowed"):
        palpate.read(folder)


def test_the_same_numbers_with_another_slope_are_no_copies(write_series: Any) -> None:
    folder = write_series()
    dataset = dcmread(folder / "097")
    dataset.RescaleSlope = 2
    dataset.save_as(folder / "100")
    with pytest.raises(PalpateError, match="whose pixels differ"):
        palpate.read(folder)


def test_phases_with_one_uid_for_all_are_told_apart(write_series: Any) -> None:
    def change(number: int, dataset: FileDataset) -> None:
        dataset.SOPInstanceUID = "1.2.3"
        dataset.EchoTime = 10 + 20 * (number // 12)

    folder = write_series(positions=PLACES * 2, each=change)
    assert [series.slices for series in list_series(folder)] == [12, 12]


def test_nothing_refers_to_slices_that_share_a_uid(write_series: Any, tmp_path: Path) -> None:
    def change(_: int, dataset: FileDataset) -> None:
        dataset.SOPInstanceUID = "1.2.3"

    volume = palpate.read(
        write_series(each=change, StudyInstanceUID="1.2.4", FrameOfReferenceUID="1.2.5")
    )
    scene = Scene(volume, [volume.threshold(-800.0, name="a")])
    with pytest.raises(OptionError, match="have no SOPInstanceUID of their own"):
        export_scene(scene, tmp_path / "kept.dcm", kind="rtstruct", keep_identity=True)


# --- bad slices -----------------------------------------------------------------------------


def bad_slice(folder: Path, kind: str) -> str:
    """Makes one slice of a series bad; returns the name of its file."""
    path = folder / f"{97 * 5 % 101:03}"
    dataset = dcmread(path)
    if kind == "truncated":
        path.write_bytes(path.read_bytes()[:-10])
        return path.name
    if kind == "size":
        dataset.Rows, dataset.Columns = 4, 3
    elif kind == "orientation":
        dataset.ImageOrientationPatient = [0, 1, 0, 0, 0, 1]
    elif kind == "spacing":
        dataset.PixelSpacing = [0.7, 0.7]
    elif kind == "position":
        del dataset.ImagePositionPatient
    elif kind == "pixels":
        # eight bits that are announced as compressed
        dataset.file_meta.TransferSyntaxUID = JPEG2000Lossless
        dataset.PixelData = encapsulate([b"no picture at all"])
        dataset["PixelData"].VR = "OB"
        dataset["PixelData"].is_undefined_length = True
    dataset.save_as(path)
    return path.name


KINDS = ["truncated", "size", "orientation", "spacing", "position", "pixels"]


@pytest.mark.parametrize("kind", KINDS)
def test_one_bad_slice_is_left_out_by_name_and_its_gap_filled(write_series: Any, kind: str) -> None:
    folder = write_series(positions=PLACES)
    expected = values_of(palpate.read(folder))
    name = bad_slice(folder, kind)
    uid = str(dcmread(folder / "000").SeriesInstanceUID)
    for series in (None, uid):
        volume = palpate.read(folder, series=series)
        # values rise evenly from slice to slice, so that the gap is filled as it was
        np.testing.assert_array_equal(values_of(volume), expected)
        assert any("left out" in told and name in told for told in volume.warnings)
        assert said(volume, "1 slice is missing, after number 5")


@pytest.mark.parametrize("kind", ["truncated", "pixels", "spacing"])
def test_a_bad_slice_of_three_is_no_odd_one(write_series: Any, kind: str) -> None:
    folder = write_series(positions=PLACES[:3])
    (folder / "097").rename(folder / f"{97 * 5 % 101:03}")
    bad_slice(folder, kind)
    with pytest.raises(PalpateError, match="allowed"):
        palpate.read(folder)


def test_spacings_that_writers_round_are_one(write_series: Any) -> None:
    def change(number: int, dataset: FileDataset) -> None:
        dataset.PixelSpacing = [0.48849 if number == 3 else 0.4885, 0.4885]

    volume = palpate.read(write_series(positions=PLACES, each=change))
    assert volume.dimensions[2] == 12
    assert not said(volume, "left out")


@pytest.mark.parametrize("placed", [0, 1, 6])
def test_series_that_mostly_lack_positions_keep_all_slices(write_series: Any, placed: int) -> None:
    def change(number: int, dataset: FileDataset) -> None:
        dataset.InstanceNumber = number + 1
        if number >= placed:
            del dataset.ImagePositionPatient

    volume = palpate.read(write_series(positions=PLACES, each=change))
    assert (volume.dimensions[2], volume.orientation) == (12, "unknown")
    np.testing.assert_array_equal(values_of(volume)[:, 0, 0], np.arange(12) * 100 - 1024)
