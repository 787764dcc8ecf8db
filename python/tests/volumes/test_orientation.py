"""Letters and directions name each other."""

from __future__ import annotations

from itertools import permutations, product

import numpy as np
import pytest
from palpate.base.errors import OptionError
from palpate.volumes.orientation import direction_of, letters_of

ALL = ["".join(pick) for axes in permutations(("LR", "PA", "SI")) for pick in product(*axes)]


@pytest.mark.parametrize("letters", ALL)
def test_letters_survive_the_way_to_a_direction_and_back(letters: str) -> None:
    assert letters_of(direction_of(letters)) == letters


def test_lps_is_the_patient_frame_itself() -> None:
    np.testing.assert_array_equal(direction_of("LPS"), np.eye(3))


def test_ras_turns_the_first_two_axes() -> None:
    np.testing.assert_array_equal(direction_of("RAS"), np.diag([-1.0, -1.0, 1.0]))


def test_columns_are_axes_of_the_file() -> None:
    # x of the file runs to posterior, y to superior, z to left
    np.testing.assert_array_equal(
        direction_of("PSL"), [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    )


def test_an_oblique_scan_has_the_nearest_letters_each_axis_once() -> None:
    # 50 degrees about z: x leans more to P than to L, and y more to R than to P
    cosine, sine = np.cos(np.radians(50)), np.sin(np.radians(50))
    direction = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    assert letters_of(direction) == "PRS"


@pytest.mark.parametrize("letters", ["", "LP", "LLS", "LRS", "XYZ", "LPSS", "lp "])
def test_other_letters_are_refused(letters: str) -> None:
    with pytest.raises(OptionError, match="allowed: one letter of L or R"):
        direction_of(letters)
