"""Basins of depths: of bodies that are joined by necks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from palpate.segmentation.growing.basins import basins_of
from scipy.ndimage import distance_transform_edt


def two_balls(neck: float) -> NDArray[np.bool_]:
    """Two balls of 10 cells whose middles are 28 apart, joined by a tube of this radius."""
    z, y, x = np.indices((25, 25, 55)).astype(float)
    off = np.minimum(abs(x - 13.0), abs(x - 41.0)) ** 2 + (y - 12.0) ** 2 + (z - 12.0) ** 2
    tube = ((y - 12.0) ** 2 + (z - 12.0) ** 2 <= neck**2) & (abs(x - 27.0) < 14.0)
    return np.asarray((off <= 100.0) | tube)


def test_a_narrow_neck_parts_two_balls_and_a_wide_one_does_not() -> None:
    for neck, parts in ((3.0, 2), (8.0, 1)):
        mask = two_balls(neck)
        depths = distance_transform_edt(mask).astype(np.float32)
        basins = basins_of(depths, mask, same=0.6)
        assert len(np.unique(basins.numbers[mask])) == parts
        assert not basins.numbers[~mask].any()
        assert len(basins.ways.depths) == parts - 1
    assert basins.depths[basins.numbers[12, 12, 13]] == depths.max()


def test_cells_of_one_depth_are_one_basin() -> None:
    mask = np.zeros((6, 7, 8), bool)
    mask[1:5, 1:6, 1:7] = True
    basins = basins_of(np.ones(mask.shape, np.float32), mask, same=0.9)
    np.testing.assert_array_equal(basins.numbers > 0, mask)
    assert len(np.unique(basins.numbers[mask])) == 1
