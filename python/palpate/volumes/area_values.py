"""Values of a scan in an ellipse or a rectangle of a plane: a region of interest in a slice.

In a slice along the scan's own axes these are the voxels of that slice whose centres lie inside,
with the values as they were read; in an oblique one samples at the distance of the smallest edge
of a voxel, interpolated linearly. The area is that of the shape. Points are in the patient, LPS
[mm]; arrays are [z, y, x].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.volumes.scan_slice import ScanSlice, axis_along, index_of
from palpate.volumes.volume import Volume

__all__ = ["Area", "AreaValues", "values_in_area"]

Vectors = NDArray[np.float64]
"""Shape [count, 3]."""

MOST_SAMPLES = 1 << 24
"""In an oblique plane."""
BLOCK = 1 << 16
"""Of them that are worked out at once: each takes some hundred bytes meanwhile, and 8 at last."""


@dataclass(frozen=True)
class Area:
    """An ellipse or a rectangle by its middle and the ends of two half axes [mm]."""

    kind: Literal["ellipse", "rectangle"]
    middle: Sequence[float]
    first: Sequence[float]
    second: Sequence[float]

    @property
    def half_axes(self) -> tuple[Vectors, Vectors]:
        """Vectors from the middle [mm].

        Raises:
            OptionError: They are no numbers, have no length or are not at right angles.
        """
        middle, first, second = (
            np.asarray(point, np.float64) for point in (self.middle, self.first, self.second)
        )
        u, v = first - middle, second - middle
        lengths = np.linalg.norm(u) * np.linalg.norm(v)
        # NaN compares false
        if not (lengths > 0 and np.isfinite(lengths) and abs(u @ v) <= 1e-3 * lengths):
            raise OptionError(
                f"half axes {u.tolist()} and {v.tolist()} given; allowed: two at right angles, "
                "each with a length"
            )
        return u, v

    @property
    def size(self) -> float:
        """Its area [mm²]."""
        u, v = self.half_axes
        shape = np.pi if self.kind == "ellipse" else 4.0
        return float(shape * np.linalg.norm(np.cross(u, v)))

    def holds(self, points: Vectors) -> NDArray[np.bool_]:
        """Whether points lie inside, seen along the normal; shape [count]."""
        from_middle = points - np.asarray(self.middle, np.float64)
        # shares of the half axes; of a point on the edge rounding decides nothing
        shares = np.stack([from_middle @ axis / (axis @ axis) for axis in self.half_axes])
        reach = np.hypot(*shares) if self.kind == "ellipse" else np.abs(shares).max(axis=0)
        return np.asarray(reach <= 1 + 1e-9)


@dataclass(frozen=True, kw_only=True)
class AreaValues:
    """What is measured of an area; without a voxel inside there are no values."""

    area: float
    """Of the shape [mm²]."""
    count: int
    """Number of voxels with a value, or of samples in an oblique plane."""
    mean: float | None
    """Of the values [unit of the scan]."""
    standard_deviation: float | None
    """Root of the mean squared distance to the mean: of these voxels, not of a sample (IBSI)."""
    minimum: float | None
    maximum: float | None
    cut: bool
    """Whether a part of the shape lies outside of the scan."""


def values_in_area(
    volume: Volume, area: Area, *, stored: NDArray[np.int16] | None = None
) -> AreaValues:
    """Measures the values of a scan in an area.

    Args:
        volume: The scan.
        area: Where.
        stored: Its stored values as edits have left them; the default is as they were read.

    Raises:
        OptionError: The area is none, or takes too many samples.
    """
    u, v = area.half_axes
    axis = axis_along(volume, np.cross(u, v))
    values = (
        _samples(volume, area, stored) if axis is None else _voxels(volume, area, stored, axis=axis)
    )
    values = values[~np.isnan(values)]
    known = len(values) > 0
    return AreaValues(
        area=area.size,
        count=len(values),
        mean=float(values.mean()) if known else None,
        standard_deviation=float(values.std()) if known else None,
        minimum=float(values.min()) if known else None,
        maximum=float(values.max()) if known else None,
        cut=_is_cut(volume, area),
    )


def _voxels(
    volume: Volume, area: Area, stored: NDArray[np.int16] | None, *, axis: int
) -> NDArray[np.float64]:
    """Returns the values of the slice's voxels whose centres lie inside."""
    # the voxels that the plane goes through; a normal that is a little off stays in this slice
    number = int(np.floor(index_of(volume, [area.middle])[0, axis] + 0.5))
    if not 0 <= number < volume.dimensions[axis]:
        return np.empty(0)
    where = ScanSlice(volume, axis, number)
    low, high = (bound[where.along] for bound in _bounds(volume, area))
    ends = np.array(volume.dimensions)[where.along]
    first = np.clip(np.ceil(low), 0, ends).astype(int)
    past = np.clip(np.floor(high) + 1, 0, ends).astype(int)
    spans = [np.arange(*span) for span in zip(first, past, strict=True)]
    places = np.stack(np.meshgrid(*spans, indexing="ij"), axis=-1).reshape(-1, 2)
    inside = places[area.holds(where.points(places))]
    return _values(volume, where.index(inside).astype(int), stored)


def _samples(volume: Volume, area: Area, stored: NDArray[np.int16] | None) -> NDArray[np.float64]:
    """Returns values at even steps in the plane, interpolated linearly."""
    axes = area.half_axes
    step = min(volume.spacing)
    rows, columns = (max(1, round(2 * float(np.linalg.norm(axis)) / step)) for axis in axes)
    count = rows * columns
    if count > MOST_SAMPLES:
        raise OptionError(f"an area of {area.size:.0f} mm² given; allowed: a smaller one")

    def block(first: int) -> NDArray[np.float64]:
        places = np.divmod(np.arange(first, min(first + BLOCK, count)), columns)
        shares = [
            (2 * at + 1) / number - 1 for at, number in zip(places, (rows, columns), strict=True)
        ]
        points = np.asarray(area.middle, np.float64) + np.stack(shares, axis=-1) @ np.stack(axes)
        return _between_voxels(volume, points[area.holds(points)], stored)

    return np.concatenate([block(first) for first in range(0, count, BLOCK)])


def _between_voxels(
    volume: Volume, points: Vectors, stored: NDArray[np.int16] | None
) -> NDArray[np.float64]:
    """Returns the values at those points that lie in the scan, interpolated linearly."""
    index = index_of(volume, points)
    most = np.array(volume.dimensions) - 1
    # up to the outer faces of the scan, as slices are drawn
    index = np.clip(index[np.all((index >= -0.5) & (index <= most + 0.5), axis=1)], 0, most)
    base = np.minimum(np.floor(index).astype(int), np.maximum(most - 1, 0))
    share = index - base
    total = np.zeros(len(index))
    for corner in np.ndindex(2, 2, 2):
        weight = np.where(np.array(corner) == 1, share, 1 - share).prod(axis=1)
        # what has no weight has no say, also where it has no value
        found = _values(volume, np.minimum(base + corner, most), stored)
        total += np.where(weight > 0, weight * found, 0.0)
    return total


def _values(
    volume: Volume, index: NDArray[np.int_], stored: NDArray[np.int16] | None
) -> NDArray[np.float64]:
    """Returns the values of voxels [unit of the scan], as edits have left them, shape [count]."""
    x, y, z = index.T
    region: Any = (z, y, x)
    values = volume.values(region).astype(np.float64)
    if stored is not None:
        now = stored[region]
        changed = now != volume.array[region]
        values[changed] = now[changed] * volume.slope + volume.intercept
    return np.asarray(values)


def _bounds(volume: Volume, area: Area) -> tuple[Vectors, Vectors]:
    """Returns the lowest and highest index of the shape along each axis of the grid."""
    matrix = np.linalg.inv(volume.patient_from_grid)[:3, :3]
    ends = np.abs(np.stack([matrix @ axis for axis in area.half_axes]))
    reach = np.hypot(*ends) if area.kind == "ellipse" else ends.sum(axis=0)
    middle = index_of(volume, [area.middle])[0]
    return middle - reach, middle + reach


def _is_cut(volume: Volume, area: Area) -> bool:
    low, high = _bounds(volume, area)
    slack = 1e-6
    return bool(
        np.any(low < -0.5 - slack) or np.any(high > np.array(volume.dimensions) - 0.5 + slack)
    )
