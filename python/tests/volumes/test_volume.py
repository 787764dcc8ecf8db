"""Volumes and segments against NumPy."""

from __future__ import annotations

import numpy as np
import pytest
from palpate import EmptySegmentError, OptionError, Scene, Volume, VolumeFormatError
from palpate.volumes.volume import VolumeTraits


@pytest.fixture
def volume() -> Volume:
    values = np.random.default_rng(2).integers(-1000, 1000, (9, 17, 20)).astype(np.int16)
    # x of the grid runs to posterior, y to superior, z to left
    return Volume(
        values,
        spacing=(0.5, 0.75, 2.0),
        origin=(10.0, -20.0, 30.0),
        direction=[[0, 0, 1], [1, 0, 0], [0, 1, 0]],
        slope=0.5,
        intercept=-3.0,
        traits=VolumeTraits(name="noise", unit="HU"),
    )


def physical(volume: Volume) -> np.ndarray:
    return volume.array * volume.slope + volume.intercept


def test_a_threshold_selects_values_from_low_to_high_both_included(volume: Volume) -> None:
    values = physical(volume)
    segment = volume.threshold(-3.0, 97.5, name="middle")
    expected = (values >= -3.0) & (values <= 97.5)
    np.testing.assert_array_equal(segment.mask() != 0, expected)
    assert segment.voxel_count == expected.sum()
    assert segment.range == (-3.0, 97.5)
    # 0.5 x 0.75 x 2 mm
    assert segment.volume_ml == pytest.approx(0.75e-3 * expected.sum())


def test_a_threshold_without_high_goes_to_the_end(volume: Volume) -> None:
    values = physical(volume)
    assert volume.threshold(100.0).voxel_count == (values >= 100.0).sum()
    assert volume.threshold(100.0).range == (100.0, values.max())


def test_the_bounding_box_is_that_of_the_mask(volume: Volume) -> None:
    mask = np.zeros(volume.shape, bool)
    mask[2:5, 3:16, 7] = True
    segment = volume.segment(mask, name="bar")
    assert segment.bounding_box == ((7, 3, 2), (8, 16, 5))
    np.testing.assert_array_equal(segment.mask() != 0, mask)
    assert segment.range is None


def test_points_are_in_the_voxels_that_hold_them(volume: Volume) -> None:
    segment = volume.threshold(0.0)
    random = np.random.default_rng(4)
    in_grid = random.uniform(-2.0, 22.0, (2000, 3))
    in_patient = in_grid @ volume.patient_from_grid[:3, :3].T + volume.patient_from_grid[:3, 3]

    voxels = np.floor(in_grid).astype(int)
    inside = ((voxels >= 0) & (voxels < volume.dimensions)).all(axis=1)
    expected = np.zeros(len(voxels), bool)
    x, y, z = voxels[inside].T
    expected[inside] = segment.mask()[z, y, x] != 0
    np.testing.assert_array_equal(segment.contains(in_patient), expected)


@pytest.mark.parametrize("bounds", [(5000.0, 6000.0), (-4000.0, -3000.0), (0.1, 0.2)])
def test_a_threshold_that_selects_nothing_says_the_range(
    volume: Volume, bounds: tuple[float, float]
) -> None:
    low, high = volume.range
    with pytest.raises(EmptySegmentError, match=rf"selects no voxel; .* {low:g} to {high:g} HU"):
        volume.threshold(*bounds)


def test_a_threshold_above_everything_says_the_range(volume: Volume) -> None:
    with pytest.raises(EmptySegmentError, match="threshold from 9000 HU selects no voxel"):
        volume.threshold(9000.0)


@pytest.mark.parametrize("bounds", [(1.0, 0.0), (np.nan, 1.0), (0.0, np.inf)])
def test_what_is_no_range_is_refused(volume: Volume, bounds: tuple[float, float]) -> None:
    with pytest.raises(OptionError, match="allowed: two finite values, the lower first"):
        volume.threshold(*bounds)


def test_a_mask_of_another_shape_is_refused(volume: Volume) -> None:
    with pytest.raises(OptionError, match=r"shape \[1, 2, 3\]; allowed: \[9, 17, 20\]"):
        volume.segment(np.zeros((1, 2, 3)), name="other")


def test_values_are_a_view_that_cannot_be_written(volume: Volume) -> None:
    with pytest.raises(ValueError, match="read-only"):
        volume.array[0, 0, 0] = 1


def test_the_histogram_counts_every_voxel_in_its_bin(volume: Volume) -> None:
    histogram = volume.histogram
    assert histogram.counts.sum() == volume.array.size
    # half a stored step wider on each side, so that the ends lie inside their bins
    low, high = volume.range
    assert (histogram.low, histogram.high) == (low - 0.25, high + 0.25)


@pytest.mark.parametrize("spacing", [(0.0, 1.0, 1.0), (-1.0, 1.0, 1.0), (np.nan, 1.0, 1.0)])
def test_an_impossible_spacing_is_refused(spacing: tuple[float, float, float]) -> None:
    with pytest.raises(VolumeFormatError, match="allowed"):
        Volume(np.zeros((2, 2, 2), np.int16), spacing=spacing)


def test_a_scene_takes_segments_of_its_own_scan_only(volume: Volume) -> None:
    other = Volume(np.zeros((2, 2, 2), np.int16), spacing=(1.0, 1.0, 1.0))
    with pytest.raises(OptionError, match="allowed: "):
        Scene(volume, [other.threshold(0.0)])


def test_segments_of_a_scene_get_different_colours(volume: Volume) -> None:
    scene = Scene(volume, [volume.threshold(low) for low in (0.0, 10.0, 20.0)])
    assert len({shown.colour for shown in scene}) == 3


def test_a_scene_takes_segments_of_its_own_grid_only() -> None:
    values = np.zeros((6, 7, 8), np.int16)
    scan = Volume(values, spacing=(0.5, 0.75, 2.0), origin=(10.0, 20.0, 30.0))
    rounded = Volume(values, spacing=(0.5, 0.75, 2.0), origin=(10.001, 20.0, 30.0))
    aside = Volume(values, spacing=(0.5, 0.75, 2.0), origin=(10.1, 20.0, 30.0))
    mask = np.ones(values.shape)
    assert len(Scene(scan, [rounded.segment(mask, name="same")])) == 1
    with pytest.raises(OptionError, match=r"segment 'aside' lies 0\.1 mm off the voxels of the"):
        Scene(scan, [aside.segment(mask, name="aside")])
    assert len(Scene(scan, [aside.segment(mask, name="aside").as_object()])) == 1
