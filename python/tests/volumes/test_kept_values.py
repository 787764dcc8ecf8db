"""Values that int16 does not hold are read, compared and changed as they are."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
from numpy.typing import NDArray
from palpate import EmptySegmentError, OptionError, Scene, Volume, VolumeFormatError
from palpate.segmentation.brush import Brush, covered
from palpate.segmentation.multi_otsu import otsu
from palpate.volumes.downsample import merged
from palpate.volumes.scan_slice import ScanSlice

SMALL = np.array([0.0, 0.0007, 0.0011, 0.003], np.float32)
LARGEST = float(SMALL[-1])
"""Of a map of diffusion [mm²/s]."""


def volume_of(values: NDArray[Any], **more: Any) -> Volume:
    return Volume(values, spacing=(1.0, 1.5, 2.5), **more)


def diffusion(*, nan: int = 0) -> NDArray[np.float32]:
    """A map of four values, of which some first ones are none."""
    values = np.random.default_rng(5).choice(SMALL, (6, 7, 8))
    values.ravel()[:nan] = np.nan
    return values


# --- of files ---------------------------------------------------------------------------


@pytest.mark.data
@pytest.mark.parametrize("name", ["md.nii.gz", "pm.dcm"])
def test_small_numbers_of_files_are_not_rounded(data_folder: Path, name: str) -> None:
    case = data_folder.parent / "cases" / "01-small-floats-become-zero" / "input"
    volume = palpate.read(case / name)
    assert volume.range == (0.0, LARGEST)
    lesion = volume.threshold(0.002)
    slices, rows, columns = np.nonzero(lesion.mask())
    middle = [columns.mean() + 0.5, rows.mean() + 0.5, slices.mean() + 0.5, 1.0]
    # the frame of an index stands in the middle of its voxel
    np.testing.assert_allclose((volume.patient_from_grid @ middle)[:3], [5.0, 6.0, 20.0])


@pytest.mark.parametrize("name", ["a.nii.gz", "a.nrrd", "a.mha"])
@pytest.mark.parametrize(
    ("kind", "values"),
    [
        ("i2", [-32768, -5, 0, 32767]),
        ("u1", [0, 1, 200, 255]),
        ("u2", [0, 1, 40000, 65535]),
        ("i4", [-70000, -1, 0, 70000]),
        ("i4", [-(2**31), 16777217, 0, 2**31 - 1]),
        ("f4", [0.0, 0.0007, 0.25, 1.0]),
        ("f4", [1e-30, -1e30, 3.0, 0.1]),
        ("f4", [1.0, 2.0, 3.0, 16777216.0]),
        ("f8", [1e-300, 1.0, 2.0, 3.0]),
    ],
)
def test_what_is_exported_is_what_was_read(
    tmp_path: Path, write_image: Any, name: str, kind: str, values: list[float]
) -> None:
    given = np.random.default_rng(2).choice(np.array(values, kind), (4, 5, 6))
    volume = palpate.read(write_image(given, name))
    again = tmp_path / f"again-{name}"
    palpate.export_scene(Scene(volume), again)
    np.testing.assert_array_equal(palpate.read(again).values(), given)
    assert given.dtype.kind != "f" or palpate.read(again).range == volume.range


@pytest.mark.parametrize("name", ["a.nii", "a.nrrd", "a.mha"])
def test_no_value_is_exported_as_no_value(tmp_path: Path, name: str) -> None:
    volume = volume_of(diffusion(nan=5))
    palpate.export_scene(Scene(volume), tmp_path / name)
    again = palpate.read(tmp_path / name)
    np.testing.assert_array_equal(again.values(), volume.values())
    assert again.missing == 5


# --- of arrays --------------------------------------------------------------------------


@pytest.mark.parametrize(
    "values",
    [
        np.array([0, 40000], np.uint16),
        np.array([0, 70000], np.int32),
        np.array([-1, 2**40], np.int64),
        np.array([0, 255], np.uint8),
        np.array([-5, 123456], ">i4"),
        np.array([0.0, 0.5, 1.0], np.float32),
        np.array([0.0, 0.1, 2.0**24 + 1.0], np.float64),
        np.array([False, True]),
    ],
)
def test_no_array_is_cast_in_silence(values: NDArray[Any]) -> None:
    given = values.reshape(1, 1, -1)
    read = volume_of(given)
    expected = given.astype(np.float32) if given.dtype == np.float64 else given
    np.testing.assert_array_equal(read.values(), expected)
    low, high = read.range
    assert (low, high) == (float(expected.min()), float(expected.max()))


@pytest.mark.parametrize("kind", ["u2", "i4", "f4", "f8"])
def test_what_becomes_of_an_array_afterwards_changes_no_scan(kind: str) -> None:
    given = np.array([[[0.3, 1.5, 100000.3, 40000.0]]]).astype(kind)
    volume = volume_of(given)
    before = volume.values().copy()
    given[...] = 7
    np.testing.assert_array_equal(volume.values(), before)
    if volume.exact is not None:
        with pytest.raises(ValueError, match="read-only"):
            volume.exact[0, 0, 0] = 1


def test_whole_floats_beyond_single_precision_are_kept() -> None:
    given = np.array([[[0.0, 2.0**24 + 1.0, 614454277.0]]])
    np.testing.assert_array_equal(volume_of(given).values(), given)


@pytest.mark.parametrize(
    ("kind", "number", "slope"),
    [("u1", 200, 2), ("i4", 2**30, 4), ("u8", 2**63, 2), ("f2", 60000, 2)],
)
def test_values_wrap_around_in_no_type(kind: str, number: int, slope: int) -> None:
    given = np.array([[[0, number]]]).astype(kind)
    assert volume_of(given, slope=slope).range == (0.0, float(given.max()) * slope)


@pytest.mark.parametrize("slope", [0, 0.0, np.nan, np.inf])
def test_a_slope_that_gives_no_values_is_refused(slope: float) -> None:
    with pytest.raises(VolumeFormatError, match="slope"):
        volume_of(np.array([[[0.0, 1.0]]]), slope=slope)


@pytest.mark.parametrize("kind", ["i2", "u1", "f4"])
def test_masked_values_are_none(kind: str) -> None:
    given = np.ma.MaskedArray([[[1, 2, 3]]], mask=[[[False, True, False]]], dtype=kind)
    np.testing.assert_array_equal(volume_of(given).values(), [[[1.0, np.nan, 3.0]]])


def test_other_values_do_not_wait_for_masked_ones_to_be_imported() -> None:
    made = "import numpy, palpate; palpate.Volume(numpy.zeros((2, 2, 2)), spacing=(1, 1, 1))"
    asked = "import sys; sys.exit('numpy.ma' in sys.modules)"
    subprocess.run([sys.executable, "-c", f"{made}; {asked}"], check=True)


def test_slope_and_intercept_are_those_of_any_numbers_given() -> None:
    given = np.array([[[0, 40000, 65535]]], np.uint16)
    volume = volume_of(given, slope=0.1, intercept=-5.0)
    np.testing.assert_allclose(volume.values(), given * 0.1 - 5.0, rtol=1e-6)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        (np.zeros((64, 64), np.int16), r"values of shape \[64, 64\] given; allowed: \[depth,"),
        (np.zeros((2, 2, 2, 2)), r"values of shape \[2, 2, 2, 2\] given"),
        (np.zeros((0, 2, 2)), r"values of shape \[0, 2, 2\] given"),
        (np.zeros((2, 2, 2), complex), "values of type complex128 given; allowed: bool, integers"),
        ([["a"]], r"values of shape \[1, 1\] given"),
    ],
)
def test_what_is_no_volume_is_refused_by_its_shape(values: Any, said: str) -> None:
    with pytest.raises(VolumeFormatError, match=said) as caught:
        volume_of(values)
    assert "--" not in str(caught.value)


def test_spacing_origin_and_direction_are_refused_by_name() -> None:
    values = np.zeros((2, 2, 2), np.int16)
    with pytest.raises(VolumeFormatError, match=r"spacing \(1, 1\) given; allowed: three numbers"):
        Volume(values, spacing=(1, 1))
    with pytest.raises(VolumeFormatError, match="origin 5 given"):
        volume_of(values, origin=5)
    with pytest.raises(VolumeFormatError, match=r"direction of shape \[2, 2\] given"):
        volume_of(values, direction=np.eye(2))


@pytest.mark.parametrize("bad", [np.nan, -np.nan])
def test_a_mask_with_nan_is_refused(bad: float) -> None:
    volume = volume_of(diffusion())
    mask = np.ones(volume.shape)
    mask[0, 0, :3] = bad
    with pytest.raises(OptionError, match="mask of 'part' is NaN in 3 voxels; allowed: numbers"):
        volume.segment(mask, name="part")
    with pytest.raises(OptionError, match="mask of 'part' is of type <U1"):
        volume.segment(np.full(volume.shape, "a"), name="part")


# --- thresholds -------------------------------------------------------------------------


def test_thresholds_compare_values_as_they_were_read() -> None:
    values = diffusion()
    volume = volume_of(values)
    for low, high in [(0.0007, None), (0.0007, 0.0011), (0.0, 0.0), (0.00111, 0.003)]:
        expected = (values >= np.float32(low)) & (
            values <= np.float32(1.0 if high is None else high)
        )
        np.testing.assert_array_equal(volume.threshold(low, high).mask() != 0, expected)
    with pytest.raises(EmptySegmentError, match=r"within 0 to 0\.003"):
        volume.threshold(0.0008, 0.001)


# as Python and as the header of a NIfTI file know it
@pytest.mark.parametrize("slope", [0.1, float(np.float32(0.1))])
def test_limits_are_closed_where_products_are_rounded(slope: float) -> None:
    stored = np.arange(1000, dtype=np.int16).reshape(10, 10, 10)
    volume = volume_of(stored, slope=slope)
    for high, last in [(0.3, 3), (0.7, 7), (30.7, 307)]:
        assert volume.threshold(0.0, high).voxel_count == last + 1
        assert volume.threshold(high).voxel_count == 1000 - last
        assert volume.threshold(0.0, high - 0.001).voxel_count == last


# --- everything that reads them ---------------------------------------------------------


def test_slices_brushes_and_merged_voxels_are_made_of_the_values() -> None:
    values = diffusion()
    volume = volume_of(values)
    slice_ = ScanSlice(volume, 2, 3)
    np.testing.assert_array_equal(slice_.values, values[3])
    brush = Brush(radius=100.0, values=(0.0011, 0.0011))
    box, mask = covered(volume, brush, ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)))
    np.testing.assert_array_equal(mask, values[box] == np.float32(0.0011))
    larger, _ = merged(volume, {}, size=5.0)
    mean = values[:6, :6, :5].reshape(3, 2, 2, 3, 1, 5).mean(axis=(1, 3, 5))
    np.testing.assert_allclose(larger.values(), mean, rtol=1e-6)


def test_otsu_parts_all_values_with_none_between() -> None:
    values = np.random.default_rng(4).gamma(2.0, 0.0005, (20, 30, 40)).astype(np.float32)
    values[:2] = np.nan
    volume = volume_of(values)
    lower, upper = otsu(volume, classes=3)
    assert lower.range is not None
    assert upper.range is not None
    counted = lower.voxel_count + upper.voxel_count
    assert counted == (values >= lower.range[0]).sum()
    assert upper.range[1] == np.nanmax(values)


def test_stored_values_that_changed_change_the_values_there_only() -> None:
    values = diffusion(nan=3)
    volume = volume_of(values)
    stored = volume.array.copy()
    stored[5, 6, 7] = stored.max()
    changed = volume.with_values(stored)
    expected = values.copy()
    expected[5, 6, 7] = 0.003
    np.testing.assert_allclose(changed.values(), expected, rtol=1e-4)
    assert (changed.values() != values).sum() == (3 if values[5, 6, 7] == 0.003 else 4)
    assert changed.edited
    assert not volume.with_values(volume.array).edited


# --- no value ---------------------------------------------------------------------------


def test_voxels_without_a_value_are_left_out_and_told() -> None:
    values = diffusion(nan=10)
    volume = volume_of(values)
    assert volume.range == (0.0, LARGEST)
    assert volume.histogram.counts.sum() == values.size - 10
    assert volume.threshold(-1.0).voxel_count == values.size - 10
    assert not volume.threshold(0.0).mask().ravel()[:10].any()
    (told,) = volume.warnings
    assert told.startswith("10 of 336 values are NaN or infinite: taken as no value")
    assert np.isfinite(volume.intensities()).all()
    assert volume.intensities().ravel()[:10].max() < 0.0


def test_what_is_laid_on_another_grid_has_no_value_where_a_part_of_it_has_none() -> None:
    import SimpleITK
    from palpate.volumes.resampled import resampled

    volume = volume_of(diffusion(nan=8))
    moved = SimpleITK.TranslationTransform(3, (0.5, 0.0, 0.0))
    laid = resampled(volume, volume, moved)
    # the whole first row, of which the last voxel has its neighbour outside
    assert np.isnan(laid.values()[0, 0, :-1]).all()
    means = (volume.values()[1:, :, :-1] + volume.values()[1:, :, 1:]) / 2
    np.testing.assert_allclose(laid.values()[1:, :, :-1], means, rtol=1e-5)
