"""Values as int16: exact where they can be, else with the error that is reported."""

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
    assert stored.error == 0.0
    np.testing.assert_array_equal(restored(stored), values)


def test_whole_floats_within_int16_keep_slope_1_and_intercept_0() -> None:
    values = np.array([[[-1024.0, 3071.0]]], np.float32)
    stored = to_stored(values)
    assert stored.scale == Scale(1.0, 0.0)
    np.testing.assert_array_equal(stored.values, values)


def test_unsigned_16_bits_are_shifted_without_loss() -> None:
    values = np.array([[[0, 40000, 65535]]], np.uint16)
    stored = to_stored(values)
    assert stored.error == 0.0
    np.testing.assert_array_equal(restored(stored), values)


@given(arrays.arrays(np.float64, SHAPE, elements=st.floats(-1e6, 1e6, width=32)))
def test_no_value_is_farther_off_than_reported(values: np.ndarray) -> None:
    stored = to_stored(values)
    # 1e-9: rounding of the comparison itself, relative to the largest value
    assert np.abs(restored(stored) - values).max() <= stored.error + 1e-9 * 1e6
    # half a step and its rounding
    assert stored.error <= 0.5 * stored.scale.slope * (1 + 1e-6)


def test_multiples_of_the_files_own_slope_are_exact() -> None:
    numbers = np.arange(24).reshape(SHAPE) * 37
    values = (0.37 * numbers - 5.0).astype(np.float32)
    stored = to_stored(values, file_scale=Scale(0.37, -5.0))
    np.testing.assert_array_equal(stored.values, numbers)
    assert stored.error == 0.0


def test_a_files_slope_that_explains_nothing_is_not_used() -> None:
    values = np.random.default_rng(1).normal(size=SHAPE)
    stored = to_stored(values, file_scale=Scale(0.5, 0.0))
    assert 0.0 < stored.error < 1e-4


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_values_that_are_not_finite_are_counted_and_refused(bad: float) -> None:
    values = np.zeros(SHAPE, np.float32)
    values[0, 0, :2] = bad
    with pytest.raises(VolumeFormatError, match=r"2 of 24 values .* --fill"):
        to_stored(values)


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
