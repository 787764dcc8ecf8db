"""DICOM folders: one series as one stack, wherever its files come from."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
from palpate.base.errors import PalpateError, SeriesChoiceError, VolumeFormatError
from palpate.io.reading import list_series

UPRIGHT = [(-10.0, -20.0, 30.0 + 2.5 * k) for k in range(4)]


def refused(path: Path, **options: Any) -> str:
    with pytest.raises(PalpateError) as caught:
        palpate.read(path, **options)
    message = str(caught.value)
    assert "\n" not in message
    assert "allowed" in message or "choose one" in message
    return message


def test_slices_are_stacked_by_their_place_not_by_their_names(write_series: Any) -> None:
    volume = palpate.read(write_series())
    assert volume.dimensions == (4, 3, 4)
    assert volume.spacing == (0.75, 0.5, 2.5)
    assert volume.origin == (-10.0, -20.0, 30.0)
    assert volume.orientation == "LPS"
    assert (volume.name, volume.modality, volume.unit) == ("abdomen", "CT", "HU")
    slices = [100 * k + np.arange(12).reshape(3, 4) - 1024 for k in range(4)]
    np.testing.assert_array_equal(volume.array, slices)


def test_a_coronal_series_keeps_its_direction(write_series: Any) -> None:
    # rows run to the left, columns downward: the stack runs toward the front
    positions = [(5.0, 40.0 - 3.0 * k, 60.0) for k in range(5)]
    volume = palpate.read(write_series(positions=positions, orientation=(1, 0, 0, 0, 0, -1)))
    assert volume.orientation == "LIP"
    assert volume.spacing == (0.75, 0.5, 3.0)
    # the normal of these axes is +y: the backmost slice comes last
    assert volume.origin == (5.0, 28.0, 60.0)
    np.testing.assert_array_equal(volume.array[:, 0, 0], 100 * np.arange(4, -1, -1) - 1024)


def test_an_empty_series_uid_is_a_series_too(write_series: Any) -> None:
    assert palpate.read(write_series(uid="")).dimensions == (4, 3, 4)


@pytest.mark.parametrize(
    ("changes", "unit"),
    [
        ({}, "HU"),
        ({"RescaleType": "HU"}, "HU"),
        ({"RescaleType": "US"}, ""),
        ({"Modality": "MR"}, ""),
    ],
)
def test_hu_is_the_unit_of_rescaled_ct_only(
    write_series: Any, changes: dict[str, str], unit: str
) -> None:
    assert palpate.read(write_series(**changes)).unit == unit


def test_a_real_rescale_slope_is_kept(write_series: Any) -> None:
    volume = palpate.read(write_series(scale=(0.125, -3.0)))
    assert volume.slope == 0.125
    assert volume.range == (-3.0, 0.125 * 311 - 3.0)
    assert volume.warnings == ()


def test_several_series_are_listed_and_one_can_be_chosen(write_series: Any) -> None:
    write_series(uid="1.2.3", description="soft", prefix="a")
    folder = write_series(uid="1.2.4", description="lung", prefix="b", positions=UPRIGHT[:3])
    message = refused(folder)
    assert "holds 2 series; choose one with `series=" in message
    assert "[1] 1.2.3 'soft' CT, 4 of 4 x 3" in message
    assert "[2] 1.2.4 'lung' CT, 3 of 4 x 3" in message
    for chosen in ("1.2.4", "lung", "2"):
        assert palpate.read(folder, series=chosen).dimensions == (4, 3, 3)
    for wrong in ("1.2.5", "0", "3", ""):
        with pytest.raises(SeriesChoiceError, match=r"\[1\] 1\.2\.3"):
            palpate.read(folder, series=wrong)


def test_a_scout_beside_a_scan_is_left_out_and_told(write_series: Any) -> None:
    write_series(uid="1.2.3", prefix="a")
    folder = write_series(uid="1.2.9", description="scout", prefix="b", positions=UPRIGHT[:1])
    volume = palpate.read(folder)
    assert volume.dimensions == (4, 3, 4)
    assert "left out series 1.2.9 'scout'" in volume.warnings[0]


def test_files_that_are_no_scans_do_not_matter(write_series: Any) -> None:
    folder = write_series()
    write_series(prefix="s", positions=UPRIGHT[:1], Modality="SEG", uid="1.2.7")
    (folder / "notes.txt").write_text("taken on Monday")
    (folder / "empty").touch()
    (folder / "folder").mkdir()
    assert palpate.read(folder).dimensions == (4, 3, 4)


def test_slices_at_one_place_are_refused(write_series: Any) -> None:
    message = refused(write_series(positions=UPRIGHT + UPRIGHT[:2]))
    assert "2 slices at the place of another" in message
    # the first and the fifth, as the tests name them
    assert "000 and 085" in message


def test_steps_as_headers_round_them_are_even(write_series: Any) -> None:
    # 0.625 mm written with two digits, as some scanners do
    positions = [(0.0, 0.0, round(0.625 * k, 2)) for k in range(40)]
    # the largest rounding is 0.005 mm of 24.4 mm
    assert palpate.read(write_series(positions=positions)).spacing[2] == pytest.approx(
        0.625, abs=2e-4
    )


def test_copies_of_slices_are_left_out_and_told(write_series: Any) -> None:
    folder = write_series()
    path = sorted(folder.iterdir())[1]
    (folder / "copy").write_bytes(path.read_bytes())
    volume = palpate.read(folder)
    assert volume.dimensions == (4, 3, 4)
    assert "1 file is a copy of another and was left out, such as copy" in volume.warnings


def test_an_empty_series_uid_is_told_apart_by_geometry(write_series: Any) -> None:
    write_series(uid="", prefix="a", PixelSpacing=[0.9, 0.9])
    folder = write_series(uid="", prefix="b", positions=UPRIGHT[:3])
    assert "holds 2 series" in refused(folder)
    assert palpate.read(folder, series="2").dimensions == (4, 3, 3)


def test_one_slice_is_no_volume(write_series: Any) -> None:
    folder = write_series(positions=UPRIGHT[:1])
    assert "2-D image of 4 x 3 x 1" in refused(folder)
    assert "2-D image of 4 x 3 x 1" in refused(next(folder.iterdir()))


def test_slices_without_a_place_are_unknown(write_series: Any) -> None:
    from pydicom import dcmread

    folder = write_series()
    for path in folder.iterdir():
        dataset = dcmread(path)
        del dataset.ImagePositionPatient
        dataset.save_as(path)
    volume = palpate.read(folder)
    assert volume.orientation == "unknown"
    assert volume.warnings[0] == (
        "the files tell no positions: slices are in the order of their files' names; "
        "slices 1 mm apart are assumed"
    )


def test_colour_slices_are_refused(write_series: Any) -> None:
    folder = write_series(
        SamplesPerPixel=3,
        PhotometricInterpretation="RGB",
        PlanarConfiguration=0,
        BitsAllocated=8,
        BitsStored=8,
        HighBit=7,
        PixelData=bytes(36),
    )
    assert "3 numbers per pixel" in refused(folder)


def test_slices_coloured_by_a_table_are_refused(write_series: Any) -> None:
    folder = write_series(PhotometricInterpretation="PALETTE COLOR")
    with pytest.raises(VolumeFormatError, match="as colour images have; allowed: one intensity"):
        palpate.read(folder)


def test_truncated_slices_are_refused(write_series: Any) -> None:
    folder = write_series()
    # one of four is left out
    for path in sorted(folder.iterdir())[1:3]:
        path.write_bytes(path.read_bytes()[:-10])
    message = refused(folder)
    assert "truncated: 2 files" in message
    assert path.name in message or sorted(folder.iterdir())[1].name in message


def test_too_many_voxels_are_refused(write_series: Any) -> None:
    with pytest.raises(VolumeFormatError, match="4 x 3 x 4 = 48 voxels; allowed: at most 47"):
        palpate.read(write_series(), max_voxels=47)


def test_an_empty_folder_is_refused(tmp_path: Path) -> None:
    assert "empty folder" in refused(tmp_path)


def test_a_folder_without_images_is_refused(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("nothing here")
    assert "holds no DICOM images (1 files looked at)" in refused(tmp_path)


def test_a_series_in_folders_below_is_found(write_series: Any, tmp_path: Path) -> None:
    series = write_series()
    disc = tmp_path / "disc" / "IMAGES" / "ST01"
    disc.parent.mkdir(parents=True)
    series.rename(disc)
    assert palpate.read(tmp_path / "disc").dimensions == (4, 3, 4)


def test_series_are_listed_with_patient_and_study(write_series: Any) -> None:
    told = {"PatientName": "Doe^Jo", "PatientID": "7", "StudyDate": "20260102"}
    write_series(uid="1.2.3", prefix="a", StudyDescription="trauma", **told)
    folder = write_series(uid="1.2.4", prefix="b", positions=UPRIGHT[:3])
    write_series(uid="1.2.5", prefix="s", positions=UPRIGHT[:1], Modality="SEG")
    first, second = list_series(folder)
    assert (first.headers[0].patient, first.headers[0].study_told) == (
        "Doe^Jo 7",
        "2026-01-02 trauma",
    )
    assert (second.headers[0].patient, second.slices) == ("", 3)


def test_files_of_two_patients_are_two_series(write_series: Any) -> None:
    write_series(uid="1.2.3", prefix="a", PatientID="7")
    folder = write_series(uid="1.2.3", prefix="b", PatientID="8")
    assert "holds 2 series" in refused(folder)
    assert palpate.read(folder, series="2").dimensions == (4, 3, 4)


def test_a_damaged_header_is_told_and_its_slice_is_missing(write_series: Any) -> None:
    folder = write_series(positions=[(0.0, 0.0, 2.5 * k) for k in range(6)])
    path = next(file for file in folder.iterdir() if palpate_number(file) == 2)
    content = path.read_bytes()
    # columns of a kind that DICOM does not know
    place = content.index(bytes.fromhex("28001100"))
    path.write_bytes(content[: place + 4] + b"ZZ" + content[place + 6 :])
    volume = palpate.read(folder)
    assert f"1 file is damaged and was left out, such as {path.name}" in volume.warnings
    assert any("1 slice is missing, after number 2" in warning for warning in volume.warnings)
    with pytest.raises(
        VolumeFormatError, match=r"is damaged, or DICOM of an unknown kind .*allowed"
    ):
        palpate.read(path)


def palpate_number(path: Path) -> int:
    from pydicom import dcmread

    return int(dcmread(path).pixel_array[0, 0]) // 100


@pytest.mark.parametrize("seed", range(10))
def test_files_with_wrong_bytes_are_refused_or_read(write_series: Any, seed: int) -> None:
    at_random = np.random.default_rng(seed)
    folder = write_series()
    said: list[str] = []
    for _ in range(10):
        path = sorted(folder.iterdir())[int(at_random.integers(4))]
        content = bytearray(path.read_bytes())
        content[int(at_random.integers(132, len(content)))] = int(at_random.integers(256))
        path.write_bytes(content)
        try:
            palpate.read(folder)
        except PalpateError as error:
            said.append(str(error))
    assert all("allowed" in one or "choose one" in one for one in said)
