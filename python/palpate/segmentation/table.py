"""What lies outside of the body in a CT and does not touch it: the table, headrests, cables, tubes.

The body is what is thick enough at the density of skin: a ball of some millimetres fits into it, as
into an arm and not into the shell of a table. What else has that density outside of the body, and
hangs together with it nowhere, is in the way of sight and touch. It is looked for in voxels of
about 2.5 mm, and found with a margin, so that the edge of it goes as well.

Frames: arrays are [z, y, x]; spacing is along x, y, z [mm].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import EmptySegmentError
from palpate.base.progress import Progress, silent
from palpate.segmentation.lengths_in_voxels import within
from palpate.segmentation.mask_shape import Mask, closed, islands, margin, squared_distance_to
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume

__all__ = ["LEAST_ML", "skin_value", "table"]

COARSE = 2.5
"""Side of the voxels in which it is looked for [mm]."""
SKIN = 0.7
"""Where skin begins, as a share of the way from air to soft tissue: -290 HU."""
CORE = 6.0
"""Radius of the ball that fits into the body everywhere [mm]."""
LEAST_BODY_ML = 2.0
"""Of the middles of such balls that are a part of the body."""
SKIN_DEPTH = 2.5
"""How far the body reaches beyond these balls [mm]."""
CAVITY = 15.0
"""Radius of the ball that does not come into the body's own cavities [mm]."""
MOST_TOUCHING = 0.02
"""Share of the voxels of what does not touch the body that may be beside it."""
EDGE = 5.0
"""Margin of what is found, and of the body that is left alone [mm]."""
LEAST_ML = 10.0
"""Less than this in all is no table."""


@dataclass(frozen=True)
class Coarse:
    """The highest values of blocks of voxels."""

    steps: tuple[int, int, int]
    """Voxels of a block along z, y, x."""
    values: NDArray[np.float32]
    spacing: tuple[float, float, float]

    @classmethod
    def of(cls, volume: Volume) -> Coarse:
        """Takes them from a scan."""
        z, y, x = (max(1, round(COARSE / side)) for side in reversed(volume.spacing))
        values = volume.intensities()
        for axis, step in enumerate((z, y, x)):
            # the shell of a table is thinner than these voxels
            firsts = np.arange(0, values.shape[axis], step)
            values = np.maximum.reduceat(values, firsts, axis)
        sides = tuple(side * step for side, step in zip(volume.spacing, (x, y, z), strict=True))
        return cls((z, y, x), values, (sides[0], sides[1], sides[2]))

    def fine(self, mask: Mask, shape: tuple[int, ...]) -> Mask:
        """Returns a mask of blocks in voxels of the scan."""
        for axis, step in enumerate(self.steps):
            mask = np.repeat(mask, step, axis).take(range(shape[axis]), axis)
        return mask


def table(volume: Volume, *, progress: Progress = silent) -> Segment:
    """Returns what lies outside of the body and does not touch it.

    Raises:
        EmptySegmentError: There is no such thing, or less than ``LEAST_ML``.
    """
    progress("finding the body", None)
    coarse = Coarse.of(volume)
    progress("finding the body", None)
    matter = coarse.values > skin_value(volume)
    body = _body(matter, coarse.spacing)
    progress("finding what it encloses", None)
    inside = _enclosed(body, volume, coarse.spacing)
    progress("finding what lies outside of it", None)
    found = _apart(matter & ~inside, body, coarse.spacing)
    if np.count_nonzero(found) * float(np.prod(coarse.spacing)) < 1000.0 * LEAST_ML:
        raise EmptySegmentError(
            "nothing that is no part of the body was found outside of it; allowed: a scan with a "
            "table that does not touch the body"
        )
    around = margin(found, coarse.spacing, EDGE) & ~margin(body, coarse.spacing, EDGE)
    return volume.segment(coarse.fine(around, volume.shape), name="Table")


def skin_value(volume: Volume) -> float:
    """Returns the value at which skin begins [unit of the scan]."""
    air = max(volume.range[0], -1000.0) if volume.unit == "HU" else _air(volume)
    return air + SKIN * (volume.anchors.soft_tissue - air)


def _air(volume: Volume) -> float:
    """Returns the value of air, which fills the scan where the body does not."""
    values = volume.intensities((slice(None, None, 4),) * 3)
    # what is outside of the scanner's field of view may be lower
    return float(np.percentile(values[values > volume.range[0]], 5.0))


def _body(matter: Mask, spacing: tuple[float, float, float]) -> Mask:
    middles = ~within(squared_distance_to(~matter, spacing), CORE)
    numbers, sizes = islands(middles)
    least = 1000.0 * LEAST_BODY_ML / float(np.prod(spacing))
    parts = np.isin(numbers, np.flatnonzero(sizes >= least)) & middles
    return matter & margin(parts, spacing, CORE + SKIN_DEPTH)


def _enclosed(body: Mask, volume: Volume, spacing: tuple[float, float, float]) -> Mask:
    """Returns the body with what it encloses, and its open cavities, as that of the nose."""
    from scipy.ndimage import binary_fill_holes, generate_binary_structure

    body = closed(body, spacing, CAVITY)
    across = np.array(generate_binary_structure(3, 1))
    along = 2 - int(np.argmax(np.abs(volume.direction[2])))
    across[tuple([0, 2] if axis == along else slice(None) for axis in range(3))] = False
    enclosed: Mask = binary_fill_holes(body, structure=across)
    return enclosed


def _apart(others: Mask, body: Mask, spacing: tuple[float, float, float]) -> Mask:
    """Returns what of others hangs together with the body nowhere."""
    numbers, sizes = islands(others)
    beside = margin(body, spacing, 1.5 * max(spacing))
    touching = np.bincount(numbers[others & beside], minlength=len(sizes))
    is_apart = touching <= MOST_TOUCHING * sizes
    return others & is_apart[np.where(others, numbers, 0)]
