"""Slices of a tilted or uneven stack, laid on a right grid.

Values are interpolated linearly along the stack's own axes, in whose sheared cells each is known
at the corners: between two slices at the same pixel, then between pixels. Nothing is made up
beyond the slices: there is air.

Frame: local to the stack, along x, y and the slices' normal [mm]; arrays are [z, y, x].
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.progress import Progress
from palpate.io.dicom.geometry import Grid, Stack

__all__ = ["resample"]

ROUNDING = 1e-6
"""How far beyond the last pixel rounding of positions may lead [pixel]."""


def resample(
    slices: NDArray[Any], stack: Stack, grid: Grid, *, air: float, progress: Progress
) -> NDArray[Any]:
    """Returns the values of slices on a grid; whole numbers stay whole.

    Args:
        slices: In the order of the stack, shape [slices, rows, columns].
        stack: Where they lie.
        grid: With the stack's axes and pixels.
        air: What stands outside the slices.
        progress: Told how far it is.
    """
    local = stack.local
    first = (np.array(grid.origin) - stack.positions[0]) @ stack.axes
    heights = np.arange(grid.size[2]) * grid.spacing[2]
    whole = slices.dtype.kind in "iu"
    # a grid as wide as its slices leaves out drift that cannot be seen
    tilted = grid.size[1::-1] != slices.shape[1:]

    filled = np.empty(grid.size[::-1], slices.dtype)
    for index, height in enumerate(heights):
        progress("laying slices on a right grid", index / len(heights))
        # between which two slices, and how far from the lower one
        lower = int(np.clip(np.searchsorted(local[:, 2], height, "right") - 1, 0, len(local) - 2))
        step = local[lower + 1, 2] - local[lower, 2]
        share = float(np.clip((height - local[lower, 2]) / step, 0.0, 1.0))
        plane = _between(slices[lower], slices[lower + 1], share)
        corner = local[lower] * (1.0 - share) + local[lower + 1] * share
        if tilted:
            across, down = (corner[:2] - first[:2]) / stack.pixel
            plane = _shifted(plane, float(down), size=grid.size[1], air=air)
            plane = _shifted(plane.T, float(across), size=grid.size[0], air=air).T
        filled[index] = np.rint(plane) if whole else plane
    return filled


def _between(lower: NDArray[Any], upper: NDArray[Any], share: float) -> NDArray[np.float32]:
    if share == 0.0:
        return lower.astype(np.float32)
    mixed = lower.astype(np.float32)
    mixed *= 1.0 - share
    mixed += np.float32(share) * upper
    return mixed


def _shifted(rows: NDArray[np.float32], by: float, *, size: int, air: float) -> NDArray[np.float32]:
    """Returns so many rows, each what lies ``by`` rows before it; air where nothing does."""
    source = np.arange(size) - by
    last = len(rows) - 1
    inside = (source >= -ROUNDING) & (source <= last + ROUNDING)
    source = np.clip(source, 0.0, last)
    below = np.minimum(source.astype(int), max(last - 1, 0))
    share = (source - below).astype(np.float32)[:, None]
    # whole shifts move values and change none
    if np.abs(share - np.rint(share)).max() < ROUNDING:
        moved: NDArray[np.float32] = rows[np.rint(source).astype(int)]
    else:
        moved = rows[below] * (1.0 - share)
        moved += rows[np.minimum(below + 1, last)] * share
    moved[~inside] = air
    return moved
