"""Lengths and volumes against a grid: what is equal but for rounding is equal.

Sides of voxels come as float32 or as decimal digits, and their multiples are rounded: 2 voxels of
0.8 mm are a little more or less than 1.6 mm. So squared distances are those of whole numbers of
voxels along each axis, summed in one order, and they are compared with a tolerance.

Lengths [mm], volumes [ml]; spacing is along x, y, z [mm].
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "SAME",
    "least_voxels",
    "most_voxels",
    "nearest_voxels",
    "shorter_than_voxel",
    "whole_voxels",
    "within",
]

SAME = 1e-6
"""Share by which two squared lengths, or two volumes, may differ and be the same.

It is above the rounding of sides that files hold in single precision (1e-7), and below the step
between squared distances on a grid of equal sides (1 / n² at n voxels) up to 1000 voxels.
"""


def within(squared: NDArray[Any], length: float) -> NDArray[np.bool_]:
    """Returns which squared distances [mm²] are those of at most a length."""
    reached: NDArray[np.bool_] = squared <= length**2 * (1.0 + SAME)
    return reached


def whole_voxels(length: float, side: float) -> int:
    """Returns how many sides of a voxel fit into a length."""
    return math.floor(length / side * (1.0 + SAME))


def nearest_voxels(length: float, side: float) -> int:
    """Returns the number of sides that is nearest to a length; a half is one more."""
    return math.floor(length / side * (1.0 + SAME) + 0.5)


def least_voxels(ml: float, voxel_volume: float) -> int:
    """Returns how many voxels of a volume [mm³] make so much at least."""
    return math.ceil(ml * 1000.0 / voxel_volume * (1.0 - SAME))


def most_voxels(ml: float, voxel_volume: float) -> int:
    """Returns how many voxels of a volume [mm³] make so much at most."""
    return math.floor(ml * 1000.0 / voxel_volume * (1.0 + SAME))


def shorter_than_voxel(length: float, spacing: Sequence[float]) -> dict[str, float]:
    """Returns the axes along which a length is less than a voxel's side, with that side."""
    sides = zip("xyz", spacing, strict=True)
    return {axis: side for axis, side in sides if whole_voxels(length, side) < 1}
