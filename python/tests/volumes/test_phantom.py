"""The phantom: the same for the same seed, with true labels."""

from __future__ import annotations

import numpy as np
import palpate
import pytest
from palpate import OptionError

SIZE = (50, 36, 60)


def test_the_same_seed_makes_the_same_phantom() -> None:
    first, second = (palpate.phantom(SIZE, seed=7) for _ in range(2))
    np.testing.assert_array_equal(first.volume.array, second.volume.array)
    assert (first.volume.array != palpate.phantom(SIZE, seed=8).volume.array).any()


def test_it_is_a_ct_in_hu_with_its_middle_at_zero() -> None:
    volume = palpate.phantom(SIZE).volume
    assert (volume.unit, volume.modality, volume.dimensions) == ("HU", "CT", SIZE)
    middle = volume.patient_from_grid @ (*(np.array(SIZE) / 2), 1.0)
    np.testing.assert_allclose(middle[:3], 0.0, atol=1e-9)


def test_its_bone_is_above_250_hu_and_its_liver_is_not() -> None:
    made = palpate.phantom(SIZE)
    bone = made.volume.array > 250
    liver = made.part("liver").mask() != 0
    assert liver.any()
    # voxels of 8 mm beside ribs are part bone
    assert bone[liver].mean() < 0.02
    assert bone.any()


def test_an_unknown_part_is_refused_with_the_known_ones() -> None:
    with pytest.raises(OptionError, match=r"part 'wing' is not known; allowed: .*liver"):
        palpate.phantom(SIZE).part("wing")


def test_impossible_dimensions_are_refused() -> None:
    with pytest.raises(OptionError, match="allowed"):
        palpate.phantom((0, 10, 10))
