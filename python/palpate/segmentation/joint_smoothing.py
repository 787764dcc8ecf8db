"""Segments that are smoothed together, so that neighbours still meet afterwards.

Each has a share of every voxel, that of its mask under a Gaussian, and what is left is the share of
what is around; a voxel goes to the largest. Smoothed one by one, segments would leave gaps where
several meet.

Masks are bool, [z, y, x]; spacing is along x, y, z [mm].
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from palpate.base.errors import OptionError
from palpate.segmentation.mask_shape import Mask, box_of, shares

__all__ = ["smooth_together"]


def smooth_together(
    masks: Sequence[Mask], spacing: Sequence[float], deviation: float
) -> list[Mask]:
    """Returns masks of one shape, smoothed by a Gaussian of a standard deviation [mm].

    Raises:
        OptionError: Two of them share voxels.
    """
    covered = np.zeros_like(masks[0])
    for mask in masks:
        if (covered & mask).any():
            raise OptionError(
                "segments that share voxels given; allowed: segments that exclude each other"
            )
        covered |= mask
    box = box_of(covered, 3.0 * deviation, spacing)
    if covered[box].size == 0:
        return [mask.copy() for mask in masks]
    around = np.ones(covered[box].shape, np.float32)
    largest = np.zeros_like(around)
    owner = np.full(around.shape, -1, np.int16)
    for number, mask in enumerate(masks):
        share = shares(mask[box], spacing, deviation)
        around -= share
        owner[share > largest] = number
        np.maximum(largest, share, out=largest)
    owner[around >= largest] = -1
    smoothed = [np.zeros_like(mask) for mask in masks]
    for number, mask in enumerate(smoothed):
        mask[box] = owner == number
    return smoothed
