"""Values as int16: exact where they can be, else kept beside them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.typing import NDArray
from palpate.base.errors import VolumeFormatError
from palpate.volumes.stored_values import STEPS, Scale, Stored, to_stored

SHAPE = (2, 3, 4)


def restored(stored: Stored) -> NDArray[np.float64]:
    return stored.values.astype(np.float64) * stored.scale.slope + stored.scale.intercept


@given(arrays.arrays(np.int32, SHAPE, elements=st.integers(-1000, STEPS - 1000)))
def test_whole_numbers_that_span_16_bits_are_exact(values: np.ndarray) -> None:
    stored = to_stored(values.astype(np.float64))
    assert stored.scale.slope == 1.0
    assert stored.exact is None
    np.testing.assert_array_equal(restored(stored), values)


def test_whole_floats_within_int16_keep_slope_1_and_intercept_0() -> None:
    values = np.array([[[-1024.0, 3071.0]]], np.float32)
    stored = to_stored(values)
    assert stored.scale == Scale(1.0, 0.0)
    np.testing.assert_array_equal(stored.values, values)


def test_unsigned_16_bits_are_shifted_without_loss() -> None:
    values = np.array([[[0, 40000, 65535]]], np.uint16)
    stored = to_stored(values)
    assert stored.exact is None
    np.testing.assert_array_equal(restored(stored), values)


@given(arrays.arrays(np.float64, SHAPE, elements=st.floats(-1e6, 1e6, width=32)))
def test_values_that_16_bits_do_not_hold_are_kept_to_the_bit(values: np.ndarray) -> None:
    stored = to_stored(values)
    if stored.exact is None:
        # 4 ulp of float32
        np.testing.assert_allclose(restored(stored), values, rtol=5e-7, atol=0.0)
    else:
        np.testing.assert_array_equal(stored.exact, values)
        # half a step, its rounding and that of this comparison
        assert np.abs(restored(stored) - values).max() <= 0.5 * stored.scale.slope + 1e-3


def test_multiples_of_the_files_own_slope_are_exact() -> None:
    numbers = np.arange(24).reshape(SHAPE) * 37
    values = (0.37 * numbers - 5.0).astype(np.float32)
    stored = to_stored(values, file_scale=Scale(0.37, -5.0))
    np.testing.assert_array_equal(stored.values, numbers)
    assert stored.exact is None


@pytest.mark.parametrize("slope", [1.0, 0.5, 1e-3])
def test_a_files_slope_that_explains_nothing_is_not_used(slope: float) -> None:
    values = (np.random.default_rng(1).normal(size=SHAPE) * 0.003).astype(np.float32)
    stored = to_stored(values, file_scale=Scale(slope, 0.0))
    np.testing.assert_array_equal(stored.exact, values)
    assert len(np.unique(stored.values)) == values.size


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("others", [[1.0, 2.0], [0.1, 0.25], [-32768.0, 32766.0]])
def test_voxels_without_a_value_are_stored_below_all_others(
    bad: float, others: list[float]
) -> None:
    values = np.array([[[bad, *others, bad]]], np.float32)
    stored = to_stored(values)
    assert stored.missing == 2
    np.testing.assert_array_equal(stored.exact, np.where(np.isfinite(values), values, np.nan))
    none, low, high, _ = stored.values.ravel()
    assert none < low < high


def test_outliers_leave_steps_to_all_other_values() -> None:
    values = np.random.default_rng(3).normal(size=(20, 30, 40)).astype(np.float32)
    values[0, 0, :2] = 1e9, -1e9
    stored = to_stored(values)
    np.testing.assert_array_equal(stored.exact, values)
    assert len(np.unique(stored.values)) > 100
    assert (stored.values[0, 0].argmax(), stored.values[0, 0].argmin()) == (0, 1)


def test_a_scan_without_any_value_is_refused() -> None:
    with pytest.raises(VolumeFormatError, match="all 24 values are NaN or infinite"):
        to_stored(np.full(SHAPE, np.nan))


def test_values_that_are_not_finite_can_be_filled() -> None:
    values = np.ones(SHAPE, np.float32)
    values[1, 2, 3] = np.nan
    stored = to_stored(values, fill=-1024.0)
    assert stored.filled == 1
    assert restored(stored)[1, 2, 3] == -1024.0
    assert restored(stored)[0, 0, 0] == 1.0


def test_a_scan_of_one_value_is_exact() -> None:
    stored = to_stored(np.full(SHAPE, 0.25))
    np.testing.assert_array_equal(restored(stored), 0.25)
