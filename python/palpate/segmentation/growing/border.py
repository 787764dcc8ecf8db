"""The border of a region of cells at the voxels of the scan: half-way between both sides' values.

Both sides have local means, of cells that lie off the border. A voxel near the border belongs to
the side whose mean is nearer to its value. Where both are nearly equal there is no edge; the
border stays where the cells have it. Source: Lankton and Tannenbaum, "Localizing region-based
active contours", 2008, of which this is one step, without a contour.

Arrays are [z, y, x].
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from palpate.segmentation.growing.cells import Box, Cells, blurred, connected, eroded, grown_by
from palpate.segmentation.growing.choice import Region, seed_value, span_of
from palpate.segmentation.mask_shape import Mask, filled
from palpate.volumes.volume import Volume

__all__ = ["at_voxels"]

REACH = 2
"""How many cells the border may move."""
LOCAL = 2.0
"""Standard deviation of the Gaussian of local means, in cells."""
CLEAR = 6.0
"""Differences of so many standard deviations of the noise need no smoothing."""
SLIGHT = 0.01
"""Smaller ones are no edge, as a share of the scan's values without the outermost ones."""
SURE = 3.0
"""Marks cells that the border cannot reach."""


def at_voxels(
    volume: Volume,
    cells: Cells,
    region: Region,
    *,
    seeds: list[NDArray[np.int64]],
    fill: bool,
    within_range: bool = False,
) -> tuple[Box, Mask]:
    """Returns a box of the scan, and the voxels of a region in it.

    Within its range no voxel beside it is taken that has another value: where what lies beside it
    is partly brighter and partly darker, the mean of both is no measure.
    """
    edges = np.array(volume.spacing[::-1])
    whole = np.zeros(cells.values.shape, bool)
    whole[region.box] = region.mask
    near = _wider(region.box, whole.shape, 3 * REACH)
    part = Cells(
        cells.values[near],
        cells.side,
        (),
        cells.box,
        cells.first + [side.start * cells.side for side in near],
    )
    mask = whole[near]
    mean, beside, place = _sides(part.values, mask)
    own = tuple(slice(0, length) for length in mask.shape)
    box = part.voxels_of((own[0], own[1], own[2]), 0, edges)
    level = part.at(0.5 * (mean + beside), box, edges)
    contrast = part.at(mean - beside, box, edges)
    soft = part.at(part.values, box, edges)
    state = part.at(place, box, edges)
    raw = volume.intensities(box)
    solid = state > 0.0
    noise = _noise(raw, state > 1.0)
    clear = np.abs(contrast) > CLEAR * noise
    values = np.where(clear, raw, soft)
    middle = seed_value(cells)
    slight = np.abs(contrast) < SLIGHT * span_of(cells, middle)
    inside = np.where(slight, solid, (values >= level) == (contrast > 0.0))
    if within_range:
        inside &= np.abs(values - middle) <= region.half
    inside = (inside | (state > 0.99 * SURE)) & (state > -0.5 * SURE)
    starts = [tuple(int(c) for c in seed - [one.start for one in box]) for seed in seeds]
    for start in starts:
        inside[start] = True
    found = connected(inside, starts)
    return box, filled(found) if fill else found


def _sides(
    values: NDArray[np.float32], mask: Mask
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
    """Returns local means within and beside a region, and where cells are.

    The last is 1 in the region and -1 beside it; ``SURE`` or minus it where the border cannot come.
    """
    inner = eroded(mask, 1)
    within = _local(values, inner if inner.any() else mask)
    wider = grown_by(mask, 1)
    beside = _local(values, grown_by(grown_by(wider, 0), 1) & ~wider)
    place = np.where(mask, np.float32(1.0), np.float32(-1.0))
    place[eroded(inner, 0)] = SURE
    place[~grown_by(wider, 0)] = -SURE
    return within, beside, place


def _local(values: NDArray[np.float32], where: Mask) -> NDArray[np.float32]:
    """Returns means of values of some cells, by a Gaussian around each cell."""
    overall = values[where].mean() if where.any() else values.mean()
    weight = blurred(where.astype(np.float32), LOCAL**2, most_error=0.01)
    off = np.where(where, values - overall, np.float32(0.0))
    total = blurred(off, LOCAL**2, most_error=0.01)
    means: NDArray[np.float32] = overall + total / np.maximum(weight, np.float32(1e-3))
    return means


def _noise(raw: NDArray[np.float32], calm: Mask) -> float:
    """Returns the standard deviation of noise, from differences of voxels beside each other."""
    steps = np.abs(np.diff(raw, axis=2))[calm[:, :, 1:] & calm[:, :, :-1]]
    return 1.4826 * float(np.median(steps)) / 2.0**0.5 if steps.size else 0.0


def _wider(box: Box, shape: tuple[int, ...], by: int) -> Box:
    first, second, third = (
        slice(max(0, side.start - by), min(length, side.stop + by))
        for side, length in zip(box, shape, strict=True)
    )
    return first, second, third
