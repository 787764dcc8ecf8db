"""NIfTI files: which transform holds, scales, units, sheared axes, compression by bytes."""

from __future__ import annotations

import gzip
import shutil
from pathlib import Path
from typing import Any

import nibabel
import numpy as np
import palpate
import pytest
from file_cases import bright_middle, case_input, places_differ, values_of, write_nifti
from palpate.base.errors import VolumeFormatError

MARKER = (5.0, 6.0, 20.0)
"""Where the bright cube of all cases lies, LPS [mm]."""
OBLIQUE = np.array(
    [[-0.9, 0.3, 0.0, 12.0], [0.3, 0.9, 0.2, -30.0], [0.06, 0.18, -2.4, 7.0], [0, 0, 0, 1.0]]
)


def oblique() -> np.ndarray:
    """A transform to RAS with right angles, in no order of axes."""
    axes, _ = np.linalg.qr(OBLIQUE[:3, :3])
    affine = OBLIQUE.copy()
    affine[:3, :3] = axes * (0.7, 0.9, 2.5)
    return affine


@pytest.fixture
def noise() -> np.ndarray:
    """Whole numbers, shape [x, y, z]."""
    return np.random.default_rng(2).integers(-500, 500, (7, 6, 5)).astype(np.int16)


# --- cases --------------------------------------------------------------------------------


@pytest.mark.data
@pytest.mark.parametrize(
    ("number", "name"),
    [
        (4, "flip.nii.gz"),
        (4, "mni.nii.gz"),
        (5, "with_qform.nii.gz"),
        (5, "without_qform.nii.gz"),
        (7, "slope0_inter100.nii.gz"),
        (19, "off_1e-05.nii.gz"),
        (19, "off_0.0001.nii.gz"),
        (25, "CAPITALS.NII.GZ"),
        (25, "plain.nii.gz"),
        (27, "stick"),
    ],
)
def test_the_marker_of_a_case_lies_where_it_was_put(
    data_folder: Path, number: int, name: str
) -> None:
    volume = palpate.read(case_input(data_folder, number) / name)
    # 0.01 mm: less than what the case with bent angles is off by itself
    np.testing.assert_allclose(bright_middle(volume), MARKER, atol=0.01)
    assert volume.range == (0.0, 1000.0)


@pytest.mark.data
@pytest.mark.parametrize("name", ["off_0.001.nii.gz", "off_1e-3.nrrd"])
def test_nearly_right_angles_are_made_right_about_the_middle(data_folder: Path, name: str) -> None:
    volume = palpate.read(case_input(data_folder, 19) / name)
    # x moves with y by the bend: the file itself puts the marker at 5 ± 0.018
    np.testing.assert_allclose(bright_middle(volume), MARKER, atol=0.02)
    assert any("were made perpendicular" in told for told in volume.warnings)


@pytest.mark.data
def test_two_transforms_that_disagree_are_both_told(data_folder: Path) -> None:
    flipped, turned = (
        palpate.read(case_input(data_folder, 4) / name) for name in ("flip.nii.gz", "mni.nii.gz")
    )
    (told,) = (one for one in flipped.warnings if "disagree" in one)
    assert "sform (code 2) and qform (code 1)" in told
    assert "toward LPS and RPS; one mirrors the other" in told
    (told,) = (one for one in turned.warnings if "disagree" in one)
    assert "sform (code 4)" in told
    assert "mirrors" not in told


# --- place --------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", [nibabel.Nifti1Image, nibabel.Nifti2Image])
@pytest.mark.parametrize("forms", [(1, 0), (0, 1), (2, 1), (4, 2)])
def test_voxels_lie_where_nibabel_puts_them(
    tmp_path: Path, noise: np.ndarray, kind: Any, forms: tuple[int, int]
) -> None:
    image = kind(noise, oblique())
    image.header.set_xyzt_units("mm")
    other = oblique()
    other[:3, 3] += (0.0, 3.0, 4.0)
    image.header.set_sform(oblique(), forms[0])
    image.header.set_qform(other, forms[1])
    nibabel.save(image, tmp_path / "scan.nii.gz")

    volume = palpate.read(tmp_path / "scan.nii.gz", unit="HU")
    read = nibabel.load(tmp_path / "scan.nii.gz")
    np.testing.assert_array_equal(values_of(volume), read.get_fdata().T)
    assert places_differ(volume, read.affine) < 1e-4
    # both hold: they are 5 mm apart
    assert [told for told in volume.warnings if "by up to 5 mm" in told] == list(volume.warnings)
    assert bool(volume.warnings) == (0 not in forms)


def test_transforms_that_differ_by_rounding_are_not_told(tmp_path: Path, noise: Any) -> None:
    assert palpate.read(with_both_forms(tmp_path, noise), unit="HU").warnings == ()


def with_both_forms(folder: Path, values: np.ndarray) -> Path:
    """Writes a file whose transforms say the same."""
    image = write_nifti(folder / "both.nii", values, oblique())
    image.header.set_qform(oblique(), 1)
    nibabel.save(image, folder / "both.nii")
    return folder / "both.nii"


@pytest.mark.parametrize(("unit", "scale"), [("meter", 1000.0), ("micron", 0.001), ("mm", 1.0)])
def test_units_of_length_are_those_of_the_file(
    tmp_path: Path, noise: np.ndarray, unit: str, scale: float
) -> None:
    affine = oblique()
    affine[:3] /= scale
    image = write_nifti(tmp_path / "scan.nii", noise, affine)
    image.header.set_xyzt_units(unit)
    nibabel.save(image, tmp_path / "scan.nii")
    volume = palpate.read(tmp_path / "scan.nii", unit="HU")
    assert places_differ(volume, oblique()) < 1e-3
    assert volume.warnings == ()


def test_a_unit_of_length_that_nobody_told_is_noted_and_a_warning_where_mm_are_no_patient(
    tmp_path: Path, noise: Any
) -> None:
    nibabel.save(nibabel.Nifti1Image(noise, oblique()), tmp_path / "scan.nii")
    volume = palpate.read(tmp_path / "scan.nii", unit="HU")
    assert volume.warnings == ()
    assert "mm are assumed" in volume.notes[0]
    # in metres, and in micrometres
    for scale in (0.001, 1000.0):
        affine = oblique()
        affine[:3] *= scale
        nibabel.save(nibabel.Nifti1Image(noise, affine), tmp_path / "scan.nii")
        odd = palpate.read(tmp_path / "scan.nii", unit="HU")
        longest = max(np.multiply(odd.spacing, odd.dimensions))
        assert f"mm are assumed, so the scan is {longest:.3g} mm long" in odd.warnings[0]
        assert odd.notes == ()


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("flip", [1.0, -1.0])
def test_a_sheared_stack_is_laid_on_a_right_grid(tmp_path: Path, side: float, flip: float) -> None:
    # a plane of values, linear in space: where voxels lie is told by their values
    affine = np.diag([1.0, 1.5, 2.5 * flip, 1.0])
    affine[:3, 3] = (3.0, -7.0, 11.0)
    affine[1, 2] = 0.75 * side
    index = np.array(np.meshgrid(*map(np.arange, (20, 18, 12)), indexing="ij")).reshape(3, -1)
    x, y, z = (affine @ np.vstack([index, np.ones(index.shape[1])]))[:3]
    values = (2.0 * x + 5.0 * y - 3.0 * z + 100.0).reshape(20, 18, 12)
    write_nifti(tmp_path / "scan.nii", values.astype(np.float32), affine)

    volume = palpate.read(tmp_path / "scan.nii")
    assert any("tilted by 16.7 degrees" in told for told in volume.warnings)
    assert any("resampled linearly" in told for told in volume.warnings)
    read = values_of(volume)
    found = np.argwhere(read > read.min() + 1.0)[:, ::-1]
    lies = (volume.direction @ (found * volume.spacing).T).T + volume.origin
    expected = -2.0 * lies[:, 0] - 5.0 * lies[:, 1] - 3.0 * lies[:, 2] + 100.0
    measured = read[tuple(found[:, ::-1].T)]
    # 0.05: values of 200 in 16 bits, and single precision
    assert np.abs(measured - expected).max() < 0.05
    # at least the share of the box that the sheared stack fills
    assert len(found) > 0.9 * values.size


@pytest.mark.parametrize("qform", [0, 1])
def test_sheared_rows_and_columns_are_refused_in_any_case(
    tmp_path: Path, noise: np.ndarray, qform: int
) -> None:
    affine = np.diag([1.0, 1.5, 2.5, 1.0])
    affine[0, 1] = 0.3
    image = write_nifti(tmp_path / "scan.nii", noise, affine)
    image.header.set_qform(np.diag([1.0, 1.5, 2.5, 1.0]), qform)
    nibabel.save(image, tmp_path / "scan.nii")
    with pytest.raises(VolumeFormatError, match=r"rows and columns is 78.69 degrees; allowed"):
        palpate.read(tmp_path / "scan.nii")


@pytest.mark.parametrize("pixel", [0.0, np.nan, np.inf, 1e30])
def test_voxels_of_a_size_that_cannot_be_are_refused(
    tmp_path: Path, noise: np.ndarray, pixel: float
) -> None:
    path = with_both_forms(tmp_path, noise)
    packed = bytearray(path.read_bytes())
    packed[80:84] = np.float32(pixel).tobytes()  # pixdim[1]
    packed[254:256] = bytes(2)  # sform_code
    path.write_bytes(packed)
    with pytest.raises(
        VolumeFormatError, match=r"(by its qform \(code 1\)|pixdim .* cannot be).*allowed"
    ):
        palpate.read(path)


def test_a_broken_transform_beside_a_good_one_is_told(tmp_path: Path, noise: np.ndarray) -> None:
    path = with_both_forms(tmp_path, noise)
    packed = bytearray(path.read_bytes())
    packed[280:296] = bytes(16)  # srow_x
    path.write_bytes(packed)
    volume = palpate.read(path, unit="HU")
    assert places_differ(volume, oblique()) < 1e-4
    assert "qform (code 1) is used, since" in volume.warnings[0]


# --- values -------------------------------------------------------------------------------


@pytest.mark.parametrize("slope", [0.0, np.nan])
def test_a_slope_that_says_nothing_leaves_values_as_they_are(
    tmp_path: Path, noise: np.ndarray, slope: float
) -> None:
    path = written_with_scale(tmp_path, noise, slope, 100.0)
    np.testing.assert_array_equal(values_of(palpate.read(path)), noise.T)


@pytest.mark.parametrize("kind", ["u1", "i2", "u2", "i4", "f4"])
@pytest.mark.parametrize(("slope", "intercept"), [(0.5, -3.0), (-2.0, 7.0), (1.0, 40.0)])
def test_scaled_values_are_those_of_nibabel(
    tmp_path: Path, noise: np.ndarray, kind: str, slope: float, intercept: float
) -> None:
    path = written_with_scale(tmp_path, np.abs(noise % 200).astype(kind), slope, intercept)
    expected = nibabel.load(path).get_fdata().T
    np.testing.assert_allclose(values_of(palpate.read(path)), expected, rtol=1e-6)


def test_a_slope_without_an_intercept_that_can_be_is_refused(tmp_path: Path, noise: Any) -> None:
    with pytest.raises(VolumeFormatError, match="slope but invalid intercept nan"):
        palpate.read(written_with_scale(tmp_path, noise, 2.0, np.nan))


def written_with_scale(folder: Path, values: Any, slope: float, intercept: float) -> Path:
    path = folder / "scaled.nii"
    write_nifti(path, values, oblique())
    packed = bytearray(path.read_bytes())
    packed[112:120] = np.array([slope, intercept], np.float32).tobytes()
    path.write_bytes(packed)
    return path


def test_files_of_the_other_byte_order_are_read(tmp_path: Path, noise: np.ndarray) -> None:
    image = nibabel.Nifti1Image(noise, oblique(), nibabel.Nifti1Header(endianness=">"))
    nibabel.save(image, tmp_path / "scan.nii")
    np.testing.assert_array_equal(values_of(palpate.read(tmp_path / "scan.nii")), noise.T)


# --- files --------------------------------------------------------------------------------


@pytest.mark.parametrize("names", ["ab.hdr ab.img", "ab.HDR ab.IMG", "ab.hdr.gz ab.img.gz"])
def test_a_pair_is_read_by_either_of_its_files(tmp_path: Path, noise: Any, names: str) -> None:
    nibabel.save(nibabel.Nifti1Pair(noise, oblique()), tmp_path / "pair.img")
    paths = [tmp_path / name for name in names.split()]
    for path, made in zip(paths, ("pair.hdr", "pair.img"), strict=True):
        pack = gzip.compress if path.suffix == ".gz" else bytes
        path.write_bytes(pack((tmp_path / made).read_bytes()))
        (tmp_path / made).unlink()
    for path in paths:
        np.testing.assert_array_equal(values_of(palpate.read(path)), noise.T)


def test_bytes_after_the_compressed_ones_do_no_harm(tmp_path: Path, noise: np.ndarray) -> None:
    path = tmp_path / "scan.nii.gz"
    write_nifti(path, noise, oblique())
    path.write_bytes(path.read_bytes() + bytes(512) + b"padding")
    np.testing.assert_array_equal(values_of(palpate.read(path)), noise.T)


def test_a_header_that_promises_more_than_can_be_packed_is_refused(tmp_path: Path) -> None:
    image = nibabel.Nifti1Image(np.zeros((2, 3, 4), np.uint8), np.eye(4))
    image.header.set_data_shape((1000, 1000, 1000))
    (tmp_path / "scan.nii.gz").write_bytes(gzip.compress(image.header.binaryblock + bytes(100)))
    with pytest.raises(VolumeFormatError, match="announces 1000000000 bytes of voxels"):
        palpate.read(tmp_path / "scan.nii.gz")


def test_what_macos_lays_beside_files_is_no_scan(tmp_path: Path, noise: np.ndarray) -> None:
    folder = tmp_path / "stick"
    folder.mkdir()
    write_nifti(folder / "scan.nii.gz", noise, oblique())
    (folder / "._scan.nii.gz").write_bytes(b"\x00\x05\x16\x07" + bytes(116))
    assert palpate.read(folder).dimensions == (7, 6, 5)
    shutil.make_archive(str(tmp_path / "stick"), "zip", folder)
    assert palpate.read(tmp_path / "stick.zip").dimensions == (7, 6, 5)
    with pytest.raises(VolumeFormatError, match="what macOS keeps beside a file"):
        palpate.read(folder / "._scan.nii.gz")
