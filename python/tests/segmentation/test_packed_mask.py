"""Masks of a bit each: as masks of a byte each."""

from __future__ import annotations

import numpy as np
import pytest
from palpate.segmentation.packed_mask import PackedMask
from scipy.ndimage import binary_dilation, generate_binary_structure


@pytest.mark.parametrize("width", [1, 5, 63, 64, 65, 130])
def test_layers_are_those_of_scipy_at_any_width(width: int) -> None:
    mask = np.random.default_rng(width).random((7, 6, width)) < 0.15
    packed = PackedMask.of(mask)
    np.testing.assert_array_equal(packed.mask(), mask)
    assert packed.count == np.count_nonzero(mask)
    for step, connectivity in ((0, 1), (1, 3)):
        around = generate_binary_structure(3, connectivity)
        np.testing.assert_array_equal(packed.grown(step).mask(), binary_dilation(mask, around))
        # beyond the grid lies what lies at its border
        taken = ~binary_dilation(~mask, around)
        np.testing.assert_array_equal(packed.eroded(step).mask(), taken)
    np.testing.assert_array_equal((~packed).mask(), ~mask)
    assert (packed & ~packed).count == 0
