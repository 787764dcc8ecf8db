"""A round brush in slices: which voxels it covers on its way.

Frames: see ``volumes/volume.py``; masks are bool, [z, y, x].
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate.base.errors import OptionError
from palpate.segmentation.mask_shape import Mask
from palpate.volumes.volume import Volume

__all__ = ["Brush", "Point", "boxes_of", "covered"]

LARGEST = 50.0
"""Radius at most [mm]."""

TIE = 1e-6
"""Of half a voxel: a slice that runs between two layers has the one farther along the grid."""

Box = tuple[slice, slice, slice]
Corner = tuple[int, int, int]
Point = Sequence[float] | NDArray[np.float64]
"""x, y, z [scene]."""


@dataclass(frozen=True, kw_only=True)
class Brush:
    """How a brush paints."""

    radius: float = 5.0
    """Of its disc or ball [mm]."""
    normal: tuple[float, float, float] | None = None
    """Of the slice that it paints a disc in [scene]; None paints a ball."""
    values: tuple[float, float] | None = None
    """Only voxels with such values are changed [unit of the scan]; None is all."""

    def check(self) -> None:
        """Refuses what is out of range.

        Raises:
            OptionError: A number is.
        """
        if not 0.0 < self.radius <= LARGEST:
            raise OptionError(
                f"brush of {self.radius:g} mm given; allowed: more than 0, up to {LARGEST:g} mm"
            )
        if self.normal is not None and not 0.0 < np.linalg.norm(self.normal) < np.inf:
            raise OptionError(f"normal {self.normal} of a slice given; allowed: a direction")
        if self.values is not None and not self.values[0] <= self.values[1]:
            low, high = self.values
            raise OptionError(f"values {low:g} to {high:g} given; allowed: the lower value first")


def covered(volume: Volume, brush: Brush, ends: tuple[Point, Point]) -> tuple[Box, Mask]:
    """Returns the voxels that a brush covers on a straight way.

    Their centres are within its radius of the way: in space for a ball, seen along the normal for a
    disc, which has all voxels that the slice through its first end cuts.

    Args:
        volume: The scan.
        brush: The brush.
        ends: Where the way begins and ends [scene].

    Returns:
        A part of the scan, and which of its voxels.
    """
    edges = np.array(volume.spacing)
    grid_from_patient = np.linalg.inv(volume.patient_from_grid)
    # along the grid's axes, in mm: lengths are those in the scene
    first, last = (
        (grid_from_patient[:3, :3] @ np.asarray(point, np.float64) + grid_from_patient[:3, 3])
        * edges
        for point in ends
    )
    box = _box(
        volume, np.minimum(first, last) - brush.radius, np.maximum(first, last) + brush.radius
    )
    offsets = _offsets(box, edges, first)
    way = last - first
    out = np.float64(0.0)
    inside: NDArray[np.bool_] | bool = True
    if brush.normal is not None:
        normal = volume.direction.T @ np.asarray(brush.normal, np.float64)
        normal /= np.linalg.norm(normal)
        # toward higher voxels along the axis that it is nearest to
        normal *= np.sign(normal[np.argmax(np.abs(normal))])
        way = way - (way @ normal) * normal
        out = sum(offset * c for offset, c in zip(offsets, normal, strict=True))
        half = 0.5 * float(np.abs(normal) @ edges)
        inside = (out > half * (TIE - 1.0)) & (out <= half * (TIE + 1.0))
    length = float(way @ way)
    along = sum(offset * c for offset, c in zip(offsets, way, strict=True))
    share = np.clip(along / length, 0.0, 1.0) if length > 0.0 else 0.0
    from_start = sum(offset**2 for offset in offsets)
    squared = from_start - out**2 - 2.0 * share * along + share**2 * length
    mask: Mask = np.asarray(inside & (squared <= brush.radius**2 * (1.0 + TIE)))
    if brush.values is not None:
        mask &= volume.between(*brush.values, box)
    return box, mask


def boxes_of(mask: Mask) -> Iterator[tuple[Corner, Corner]]:
    """Yields boxes that together are a mask: lowest voxel and one past the highest, x, y, z.

    Each is made as long as it can be along x, then y, then z.
    """
    rest = mask.copy()
    while rest.any():
        z, y, x = (int(c) for c in np.unravel_index(int(rest.argmax()), rest.shape))
        ends = [z + 1, y + 1, x + 1]
        ends[2] = x + _run(rest[z, y, x:])
        ends[1] = y + _run(rest[z, y:, x : ends[2]].all(axis=1))
        ends[0] = z + _run(rest[z:, y : ends[1], x : ends[2]].all(axis=(1, 2)))
        rest[z : ends[0], y : ends[1], x : ends[2]] = False
        yield (x, y, z), (ends[2], ends[1], ends[0])


def _run(solid: ArrayLike) -> int:
    """Returns how many are true from the first one on."""
    line = np.asarray(solid)
    return len(line) if line.all() else int(line.argmin())


def _box(volume: Volume, low: NDArray[np.float64], high: NDArray[np.float64]) -> Box:
    """Returns the part of the scan between two corners [mm along its axes]."""
    sides = [
        slice(
            min(max(0, int(np.floor(begin / edge))), count), max(0, min(count, int(end / edge) + 1))
        )
        for begin, end, edge, count in zip(
            low[::-1], high[::-1], volume.spacing[::-1], volume.shape, strict=True
        )
    ]
    return sides[0], sides[1], sides[2]


def _offsets(
    box: Box, edges: NDArray[np.float64], point: NDArray[np.float64]
) -> list[NDArray[np.float64]]:
    """Returns from a point to the centres of voxels along x, y, z [mm], to be broadcast."""
    return [
        ((axis + 0.5) * edge - c)
        for axis, edge, c in zip(reversed(np.ogrid[box]), edges, point, strict=True)
    ]
