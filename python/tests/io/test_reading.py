"""Image files: values, place and orientation as written; what is no scan is refused."""

from __future__ import annotations

import os
import struct
from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
import SimpleITK
from palpate.base.errors import OptionError, PalpateError, VolumeFormatError

FORMATS = ["scan.nii", "scan.nii.gz", "scan.mha", "scan.mhd", "scan.nrrd", "scan.nhdr"]


def oblique_image(values: np.ndarray) -> Any:
    """An image that is turned about two axes, shifted, and of uneven spacing."""
    turn = SimpleITK.Euler3DTransform()
    turn.SetRotation(0.3, 0.0, -0.5)
    image = SimpleITK.GetImageFromArray(values)
    image.SetDirection(turn.GetMatrix())
    image.SetSpacing((0.7, 0.9, 2.5))
    image.SetOrigin((-12.0, 34.0, -560.0))
    return image


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("name", FORMATS)
def test_voxels_stand_where_itk_puts_them(
    tmp_path: Path, small_values: np.ndarray, name: str, *, compressed: bool
) -> None:
    image = oblique_image(small_values)
    SimpleITK.WriteImage(image, str(tmp_path / name), compressed)
    volume = palpate.read(tmp_path / name)

    np.testing.assert_array_equal(volume.array, small_values)
    assert volume.dimensions == image.GetSize()
    assert volume.traits.orientation_known
    for index in [(0, 0, 0), (6, 0, 0), (0, 5, 0), (0, 0, 4), (3, 2, 1)]:
        in_grid = np.array([*np.add(index, 0.5), 1.0])
        in_patient = volume.patient_from_grid @ in_grid
        # 1e-3 mm: NIfTI keeps single precision of coordinates in the hundreds
        expected = image.TransformIndexToPhysicalPoint(index)
        np.testing.assert_allclose(in_patient[:3], expected, atol=1e-3)


@pytest.mark.parametrize("kind", ["u1", "i1", "u2", "i2", "u4", "i4", "f4", "f8"])
def test_whole_values_of_any_type_arrive_exactly(write_image: Any, kind: str) -> None:
    values = np.arange(60).reshape(3, 4, 5).astype(kind)
    volume = palpate.read(write_image(values), unit="HU")
    assert (volume.slope, volume.intercept) == (1.0, 0.0)
    np.testing.assert_array_equal(volume.array, values)
    assert volume.warnings == ()


def test_an_unknown_unit_is_said_with_what_to_do(write_image: Any) -> None:
    path = write_image(np.arange(60, dtype=np.int16).reshape(3, 4, 5))
    assert any("give `unit=HU`" in warning for warning in palpate.read(path).warnings)


def test_real_values_are_kept_beside_rounded_ones(write_image: Any) -> None:
    values = np.random.default_rng(3).normal(0.0, 100.0, (3, 4, 5)).astype(np.float32)
    volume = palpate.read(write_image(values), unit="HU")
    assert volume.warnings == ()
    np.testing.assert_array_equal(volume.values(), values)
    np.testing.assert_allclose(
        volume.array * volume.slope + volume.intercept, values, atol=volume.slope / 2 * 1.001
    )


def test_the_slope_of_a_nifti_file_is_kept(tmp_path: Path, small_values: np.ndarray) -> None:
    path = tmp_path / "scaled.nii"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(small_values), str(path))
    packed = bytearray(path.read_bytes())
    struct.pack_into("<ff", packed, 112, 0.25, -7.0)  # scl_slope, scl_inter
    path.write_bytes(packed)
    volume = palpate.read(path, unit="HU")
    assert (volume.slope, volume.intercept) == (0.25, -7.0)
    np.testing.assert_array_equal(volume.array, small_values)
    assert volume.warnings == ()


def test_a_fourth_axis_of_one_voxel_is_dropped(tmp_path: Path, small_values: np.ndarray) -> None:
    image = SimpleITK.JoinSeries([SimpleITK.GetImageFromArray(small_values)])
    path = tmp_path / "one.nii"
    SimpleITK.WriteImage(image, str(path))
    np.testing.assert_array_equal(palpate.read(path).array, small_values)


# --- what a person can add --------------------------------------------------------------


def nifti_without_forms(folder: Path, values: np.ndarray) -> Path:
    path = folder / "unknown.nii"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(path))
    packed = bytearray(path.read_bytes())
    struct.pack_into("<hh", packed, 252, 0, 0)  # qform_code, sform_code
    path.write_bytes(packed)
    return path


def test_an_orientation_that_nobody_told_is_unknown(
    tmp_path: Path, small_values: np.ndarray
) -> None:
    volume = palpate.read(nifti_without_forms(tmp_path, small_values))
    assert volume.orientation == "unknown"
    assert "`orientation=LPS`" in volume.warnings[-1]


def test_nrrd_and_metaimage_without_axes_are_unknown_too(tmp_path: Path) -> None:
    raw = np.zeros((2, 3, 4), np.uint8).tobytes()
    nrrd = b"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 3 2\nencoding: raw\n\n"
    (tmp_path / "plain.nrrd").write_bytes(nrrd + raw)
    meta = b"ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\nElementType = MET_UCHAR\n"
    (tmp_path / "plain.mha").write_bytes(meta + b"ElementDataFile = LOCAL\n" + raw)
    for name in ("plain.nrrd", "plain.mha"):
        assert palpate.read(tmp_path / name).orientation == "unknown"


def test_a_person_can_tell_the_orientation(tmp_path: Path, small_values: np.ndarray) -> None:
    path = nifti_without_forms(tmp_path, small_values)
    volume = palpate.read(path, orientation="ras", unit="HU")
    assert volume.orientation == "RAS"
    assert volume.warnings == ()
    np.testing.assert_array_equal(volume.direction, np.diag([-1.0, -1.0, 1.0]))


def test_an_orientation_against_the_file_is_taken_and_told(write_image: Any) -> None:
    path = write_image(np.zeros((2, 3, 4), np.int16))
    volume = palpate.read(path, orientation="RAS")
    assert volume.orientation == "RAS"
    assert "replaces the file's own, LPS" in volume.warnings[0]


def test_the_unit_is_unknown_unless_a_person_tells_it(write_image: Any) -> None:
    path = write_image(np.zeros((2, 3, 4), np.int16))
    assert palpate.read(path).unit == ""
    assert palpate.read(path, unit="HU").unit == "HU"
    # that there is none is told too, and nothing is asked then
    without = palpate.read(path, unit="none")
    assert without.unit == ""
    assert not any("unit" in told for told in (*without.warnings, *without.notes))


@pytest.mark.parametrize(
    ("options", "allowed"),
    [
        ({"unit": "hu"}, "allowed: HU"),
        ({"orientation": "LPX"}, "allowed: one letter"),
        ({"max_voxels": 0}, "allowed: 1 or more"),
        ({"series": "1"}, "allowed: with a DICOM folder"),
    ],
)
def test_options_that_are_not_allowed_are_refused(
    write_image: Any, options: dict[str, Any], allowed: str
) -> None:
    path = write_image(np.zeros((2, 3, 4), np.int16))
    with pytest.raises(OptionError, match=allowed):
        palpate.read(path, **options)


@pytest.mark.parametrize("kind", ["f4", "f8"])
@pytest.mark.parametrize("name", ["a.nrrd", "a.mha", "a.nii", "a.nii.gz", "a.hdr"])
def test_values_that_are_not_finite_are_none_or_filled_or_refused(
    write_image: Any, name: str, kind: str
) -> None:
    values = np.zeros((3, 4, 5)).astype(kind)
    values[0, 0, 0], values[1, 1, 1] = np.nan, np.inf
    path = write_image(values, name)
    volume = palpate.read(path)
    np.testing.assert_array_equal(np.isnan(volume.values()), ~np.isfinite(values))
    assert volume.range == (0.0, 0.0)
    assert volume.threshold(0.0).voxel_count == 58
    assert any(
        "2 of 60 values are NaN or infinite: taken as no" in each for each in volume.warnings
    )
    with pytest.raises(VolumeFormatError, match=r"2 of 60 values are NaN or infinite.*\(fill\)"):
        palpate.read(path, strict=True)
    palpate.read(path, strict=True, fill=0.0)
    volume = palpate.read(path, fill=-1000.0)
    assert volume.range == (-1000.0, 0.0)
    assert "2 NaN or infinite values were set to -1000" in volume.warnings
    np.testing.assert_array_equal(volume.array == -1000, ~np.isfinite(values))


# --- what is refused --------------------------------------------------------------------


def refused(path: Path) -> str:
    with pytest.raises(PalpateError) as caught:
        palpate.read(path)
    message = str(caught.value)
    assert "\n" not in message
    assert str(path.parent) in message
    assert "allowed:" in message
    return message


def test_a_missing_path_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="does not exist; allowed: an existing file"):
        palpate.read(tmp_path / "nothing.nii")


@pytest.mark.parametrize("name", ["note.txt", "note.nii", "note.mha", "note.nrrd", "note.dcm"])
@pytest.mark.parametrize("content", [b"", b"not an image", b"\x00" * 500, b"NRRD0004\n", b"DICM"])
def test_what_is_no_image_is_refused(tmp_path: Path, name: str, content: bytes) -> None:
    (tmp_path / name).write_bytes(content)
    refused(tmp_path / name)


@pytest.mark.parametrize("name", ["flat.nii", "flat.mha", "flat.nrrd", "flat.png", "flat.tif"])
def test_a_2d_image_is_refused(write_image: Any, name: str) -> None:
    assert "2-D image of 5 x 4" in refused(write_image(np.zeros((4, 5), np.uint8), name))


def test_a_volume_of_one_slice_is_refused(write_image: Any) -> None:
    assert "2-D image of 5 x 4 x 1" in refused(write_image(np.zeros((1, 4, 5), np.int16)))


@pytest.mark.parametrize("name", ["colour.nii", "colour.mha", "colour.nrrd"])
def test_a_colour_volume_is_refused(write_image: Any, name: str) -> None:
    path = write_image(np.zeros((3, 4, 5, 3), np.uint8), name, vector=True)
    assert "3 numbers per voxel" in refused(path)


def test_a_colour_picture_is_refused(write_image: Any) -> None:
    path = write_image(np.zeros((4, 5, 3), np.uint8), "colour.png", vector=True)
    assert "3 numbers per voxel" in refused(path)


def test_a_4d_image_is_refused_where_no_volume_is_chosen(
    tmp_path: Path, small_values: np.ndarray
) -> None:
    image = SimpleITK.GetImageFromArray(small_values)
    path = tmp_path / "four.nii"
    SimpleITK.WriteImage(SimpleITK.JoinSeries([image, image]), str(path))
    assert "4-D image of 2 volumes" in refused(path)


def test_a_sheared_image_is_refused(tmp_path: Path) -> None:
    header = (
        "NRRD0004\ntype: uchar\ndimension: 3\nspace: LPS\nsizes: 4 3 2\nencoding: raw\n"
        "space directions: (1,0,0) (0.3,1,0) (0,0,1)\nspace origin: (0,0,0)\n\n"
    )
    path = tmp_path / "sheared.nrrd"
    path.write_bytes(header.encode() + bytes(24))
    assert "perpendicular" in refused(path)


def test_too_many_voxels_are_refused_before_they_are_read(tmp_path: Path) -> None:
    # 2^31 voxels that take no room on the disk
    header = (
        "NRRD0004\ntype: uchar\ndimension: 3\nspace: LPS\nsizes: 2048 1024 1024\nencoding: raw\n"
        "endian: little\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n\n"
    )
    path = tmp_path / "huge.nrrd"
    path.write_text(header)
    assert f"announces {len(header) + (1 << 31)} bytes" in refused(path)
    os.truncate(path, len(header) + (1 << 31))
    assert "2048 x 1024 x 1024 = 2147483648 voxels" in refused(path)


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("name", FORMATS)
@pytest.mark.parametrize("kept", [0.6, 0.95])
def test_a_truncated_file_is_refused(
    tmp_path: Path, name: str, kept: float, *, compressed: bool
) -> None:
    noise = np.random.default_rng(5).integers(-1000, 1000, (20, 30, 40)).astype(np.int16)
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(noise), str(tmp_path / name), compressed)
    held = max(tmp_path.iterdir(), key=lambda path: path.stat().st_size)
    packed = held.read_bytes()
    held.write_bytes(packed[: int(len(packed) * kept)])
    assert "truncated" in refused(tmp_path / name)


@pytest.mark.parametrize("name", ["scan.nii.gz", "scan.mha", "scan.mhd", "scan.nrrd", "scan.nhdr"])
def test_damaged_compressed_voxels_are_refused(tmp_path: Path, name: str) -> None:
    noise = np.random.default_rng(6).integers(-1000, 1000, (40, 60, 80)).astype(np.int16)
    SimpleITK.WriteImage(
        SimpleITK.GetImageFromArray(noise), str(tmp_path / name), useCompression=True
    )
    held = max(tmp_path.iterdir(), key=lambda path: path.stat().st_size)
    packed = bytearray(held.read_bytes())
    middle = len(packed) // 2
    packed[middle : middle + 40] = bytes(byte ^ 0x5A for byte in packed[middle : middle + 40])
    held.write_bytes(packed)
    assert "damaged" in refused(tmp_path / name)


@pytest.mark.parametrize("name", ["scan.mhd", "scan.nhdr"])
def test_a_header_without_its_voxels_is_refused(
    tmp_path: Path, small_values: np.ndarray, name: str
) -> None:
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(small_values), str(tmp_path / name))
    for path in tmp_path.iterdir():
        if path.name != name:
            path.unlink()
    message = refused(tmp_path / name)
    assert "does not exist" in message or "couldn't open" in message


def test_minc_files_are_read_with_their_place(write_image: Any, small_values: Any) -> None:
    volume = palpate.read(write_image(small_values, "scan.mnc", spacing=(0.5, 0.6, 0.7)))
    np.testing.assert_array_equal(volume.array, small_values)
    assert volume.spacing == pytest.approx((0.5, 0.6, 0.7))
    assert volume.orientation == "LPS"
