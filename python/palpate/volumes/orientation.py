"""Names of image orientations: three letters, one for each axis of the file, x first.

Each letter names the side of the patient toward which the axis runs: L left, R right, P posterior,
A anterior, S superior, I inferior. "LPS" is the patient frame itself; ITK's own letters ("RAI" for
the same) name the side where an axis starts.

Frame: directions are matrices whose columns are the file's axes in LPS, shape [3, 3].
"""

from __future__ import annotations

from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError

__all__ = ["direction_of", "letters_of"]

SIDES = (("R", "L"), ("A", "P"), ("I", "S"))
"""Letters of each LPS axis: toward its negative side, toward its positive side."""


def letters_of(direction: NDArray[np.float64]) -> str:
    """Returns the letters of a direction; for an oblique scan, the nearest ones."""
    # the signed permutation nearest to the direction, so that no letter comes twice
    fit = max(permutations(range(3)), key=lambda rows: _along(direction, rows))
    return "".join(SIDES[row][int(direction[row, axis] > 0)] for axis, row in enumerate(fit))


def _along(direction: NDArray[np.float64], rows: tuple[int, ...]) -> float:
    return float(sum(abs(direction[row, axis]) for axis, row in enumerate(rows)))


def direction_of(letters: str) -> NDArray[np.float64]:
    """Returns the direction of three letters, shape [3, 3].

    Raises:
        OptionError: The letters do not name three different axes.
    """
    axes = {letter: row for row, sides in enumerate(SIDES) for letter in sides}
    given = letters.upper()
    if len(given) != 3 or {axes.get(letter) for letter in given} != {0, 1, 2}:
        raise OptionError(
            f"orientation {letters!r} is not known; allowed: one letter of L or R, one of P or A "
            'and one of S or I, for the sides toward which x, y and z run, such as "LPS" or "RAS"'
        )
    direction = np.zeros((3, 3))
    for axis, letter in enumerate(given):
        row = axes[letter]
        direction[row, axis] = 1.0 if letter == SIDES[row][1] else -1.0
    return direction
