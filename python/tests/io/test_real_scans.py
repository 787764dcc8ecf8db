"""Real scans arrive with the values, places and units that their folders document."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
import SimpleITK
from palpate.base.errors import VolumeFormatError
from pydicom import dcmread

pytestmark = pytest.mark.data

FILES = [
    "cthead_stanford/CThead.mha",
    "amos_0336/amos_0336.mhd",
    "lidc0001_totalseg/cxr.nii.gz",
    "totalseg_tests/example_ct.nii.gz",
    "totalseg_tests/example_ct_sm.nii.gz",
    "elastix_lung_pair/3DCT_lung_baseline.mha",
    "elastix_lung_pair/3DCT_lung_baseline_small.mha",
    "dcmqi_seg/liver_seg.nrrd",
]


@pytest.mark.parametrize("name", FILES)
def test_files_have_the_values_and_places_that_itk_reads(data_folder: Path, name: str) -> None:
    volume = palpate.read(data_folder / name)
    image = SimpleITK.ReadImage(str(data_folder / name))

    # these scans are whole numbers within int16, also the one stored as float
    assert (volume.slope, volume.intercept) == (1.0, 0.0)
    np.testing.assert_array_equal(volume.array, SimpleITK.GetArrayViewFromImage(image))
    corners = np.array(np.meshgrid(*([0, n - 1] for n in image.GetSize()))).reshape(3, -1).T
    for index in corners.tolist():
        in_grid = (index[0] + 0.5, index[1] + 0.5, index[2] + 0.5, 1.0)
        expected = image.TransformIndexToPhysicalPoint(index)
        # 1e-6 mm: directions are made exactly perpendicular, which moves nothing farther
        np.testing.assert_allclose((volume.patient_from_grid @ in_grid)[:3], expected, atol=1e-6)


def test_cthead_is_as_its_readme_says(data_folder: Path) -> None:
    volume = palpate.read(data_folder / "cthead_stanford" / "CThead.mha")
    assert volume.dimensions == (256, 256, 113)
    assert volume.spacing == (1.0, 1.0, 2.0)
    assert volume.range == (0.0, 3272.0)
    assert (volume.unit, volume.orientation) == ("", "LPS")


def test_cthead_equals_the_slices_it_was_made_from(data_folder: Path) -> None:
    volume = palpate.read(data_folder / "cthead_stanford" / "CThead.mha")
    for k in (0, 56, 112):
        # slice 113 of the original is the lowest
        raw = data_folder / "cthead_stanford" / "raw" / f"CThead.{113 - k}"
        original = np.fromfile(raw, ">i2").reshape(256, 256)
        np.testing.assert_array_equal(volume.array[k], original)


def test_a_nifti_that_runs_to_the_front_is_told_as_such(data_folder: Path) -> None:
    volume = palpate.read(data_folder / "lidc0001_totalseg" / "cxr.nii.gz")
    assert volume.orientation == "LAS"
    assert volume.range == (-2048.0, 3071.0)


def test_jpeg_2000_slices_without_ending_or_series_uid_are_read(data_folder: Path) -> None:
    volume = palpate.read(data_folder / "totalseg_tests" / "example_ct_dicom")
    assert volume.dimensions == (512, 512, 20)
    assert volume.spacing == (0.9765625, 0.9765625, 2.0)
    assert volume.origin == (-249.51171875, -437.51171875, -804.5)
    assert volume.range == (-1024.0, 1839.0)
    assert (volume.modality, volume.unit, volume.name) == ("CT", "HU", "CT Body 3.0")
    assert volume.warnings == ()


def test_dicom_slices_lie_where_their_own_headers_put_them(data_folder: Path) -> None:
    folder = data_folder / "totalseg_tests" / "example_ct_dicom"
    volume = palpate.read(folder)
    for path in folder.iterdir():
        image = SimpleITK.ReadImage(str(path))
        grid_from_patient = np.linalg.inv(volume.patient_from_grid)
        in_grid = grid_from_patient @ np.append(image.GetOrigin(), 1.0)
        np.testing.assert_allclose(in_grid[:2], 0.5, atol=1e-6)
        slice_number = round(float(in_grid[2]) - 0.5)
        np.testing.assert_array_equal(
            volume.array[slice_number], SimpleITK.GetArrayViewFromImage(image)[0]
        )


def test_a_multi_frame_file_is_a_volume(data_folder: Path) -> None:
    folder = data_folder / "dcmqi_seg" / "23x38x3"
    from_frames = palpate.read(folder / "multiframe" / "mf.dcm")
    from_files = palpate.read(folder / "image")
    assert from_frames.spacing == from_files.spacing == (0.7, 0.7, 2.5)
    assert from_frames.origin == from_files.origin
    np.testing.assert_array_equal(from_frames.array, from_files.array)


def test_frames_from_top_to_bottom_keep_their_places(data_folder: Path) -> None:
    path = data_folder / "pydicom_transfer_syntaxes" / "eCT_Supplemental.dcm"
    volume, image = palpate.read(path), SimpleITK.ReadImage(str(path))
    # its rows run to the right, so that its normal points down, against the order of frames
    assert volume.orientation == "RPI"
    for frame, z in enumerate((-159.0, -149.0)):
        in_grid = np.linalg.inv(volume.patient_from_grid) @ (99.5, -301.5, z, 1.0)
        np.testing.assert_array_equal(
            volume.array[round(in_grid[2] - 0.5)], SimpleITK.GetArrayViewFromImage(image)[frame]
        )


@pytest.mark.parametrize(
    "name", ["emri_small_RLE", "emri_small_big_endian", "emri_small_jpeg_2k_lossless",
             "emri_small_jpeg_ls_lossless"]
)  # fmt: skip
def test_transfer_syntaxes_give_the_same_values(data_folder: Path, name: str) -> None:
    folder = data_folder / "pydicom_transfer_syntaxes"
    plain = palpate.read(folder / "emri_small.dcm")
    np.testing.assert_array_equal(palpate.read(folder / f"{name}.dcm").array, plain.array)


def test_a_tilted_and_uneven_series_lies_on_a_right_grid(data_folder: Path) -> None:
    folder = data_folder / "ge_gantry_tilt" / "GE_human_head_tilt+18.5"
    volume = palpate.read(folder)
    slices = [dcmread(path) for path in folder.iterdir()]
    slices.sort(key=lambda one: float(one.ImagePositionPatient[2]))
    # 152 mm along the table, times the sine and cosine of the tilt
    assert volume.dimensions == (512, 512 + 99, 37)
    assert volume.spacing == pytest.approx((0.48828, 0.48828, 4.0), abs=0.01)
    assert "tilted by 18.5 degrees" in volume.warnings[0]
    assert "1.08 to 7.00 mm, 14 of 27 off the usual 4.00 mm" in volume.warnings[0]

    # values at random voxels, worked out in the sheared cell that each lies in
    at_random = np.random.default_rng(1)
    inside = 0
    for i, j, k in at_random.integers(0, volume.dimensions, (3000, 3)):
        point = (volume.patient_from_grid @ (i + 0.5, j + 0.5, k + 0.5, 1.0))[:3]
        expected = value_in_cells(slices, point)
        inside += expected is not None
        wanted = -1000.0 if expected is None else expected
        # values are whole numbers
        assert volume.array[k, j, i] == pytest.approx(wanted, abs=0.51)
    assert inside > 2000


def value_in_cells(slices: list[Any], point: Any) -> float | None:
    """Returns the linear value between eight pixels of two slices; None outside all."""
    for lower, upper in pairwise(slices):
        corner = np.array(lower.ImagePositionPatient, float)
        cosines = np.array(lower.ImageOrientationPatient, float).reshape(2, 3)
        down, across = np.array(lower.PixelSpacing, float)
        edges = [cosines[0] * across, cosines[1] * down, upper.ImagePositionPatient - corner]
        x, y, share = np.linalg.solve(np.array(edges, float).T, point - corner)
        x, y = np.round((x, y), 6)
        if not (-1e-6 <= share <= 1 + 1e-6 and 0 <= x <= 511 and 0 <= y <= 511):
            continue
        i, j = min(int(x), 510), min(int(y), 510)
        weights = np.outer([1 - (y - j), y - j], [1 - (x - i), x - i])
        corners = np.stack([one.pixel_array[j : j + 2, i : i + 2] for one in (lower, upper)])
        # -1500 stands for no value
        below, above = (np.where(corners == -1500, -1000, corners) * weights).sum(axis=(1, 2))
        return float(below * (1 - share) + above * share)
    return None


@pytest.mark.parametrize(
    "name", ["liver.dcm", "liver_rle.dcm", "liver_deflate.dcm", "693_J2KR.dcm", "bad_sequence.dcm",
             "JPEG-LL.dcm", "emri_small_jpeg_2k_lossless_too_short.dcm"]
)  # fmt: skip
def test_files_that_are_no_volume_are_refused(data_folder: Path, name: str) -> None:
    with pytest.raises(VolumeFormatError, match="allowed"):
        palpate.read(data_folder / "pydicom_transfer_syntaxes" / name)


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [
        # not HU: about 1024 higher
        ("cthead_stanford/CThead.mha", 1250.0, 1400.0),
        # HU, but the file does not say so
        ("amos_0336/amos_0336.mhd", 180.0, 300.0),
        ("lidc0001_totalseg/cxr.nii.gz", 180.0, 300.0),
        ("totalseg_tests/example_ct.nii.gz", 180.0, 300.0),
        ("elastix_lung_pair/3DCT_lung_baseline.mha", 180.0, 300.0),
        ("totalseg_tests/aorta_models/ct_cropped.nii.gz", 180.0, 300.0),
    ],
)
def test_the_threshold_offered_for_bone_is_near_250_hu(
    data_folder: Path, name: str, low: float, high: float
) -> None:
    assert low < palpate.read(data_folder / name).anchors.bone < high


def test_the_bone_offered_for_amos_is_bone(data_folder: Path) -> None:
    folder = data_folder / "amos_0336"
    volume = palpate.read(folder / "amos_0336.mhd")
    organs = palpate.read(folder / "labels_from_meshes.nii.gz").array
    bone = volume.offered_bone().mask() != 0
    # nothing of the liver (6); its values end far below bone
    assert bone[organs == 6].mean() < 1e-3
    # a body of 256 x 256 x 157 voxels of 10 mm³ has some 1 to 3 l of bone and contrast medium
    assert 1000.0 < volume.offered_bone().volume_ml < 3000.0
