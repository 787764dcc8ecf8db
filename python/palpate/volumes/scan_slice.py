"""A slice of a scan along its own axes: its values, and the positions of its voxels.

Places in a slice are (column, row), integers at the centres of voxels. Points are in the patient,
LPS [mm].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate.base.errors import OptionError
from palpate.volumes.volume import Volume

__all__ = ["Places", "Point", "ScanSlice", "axis_along", "index_of"]

Places = NDArray[np.float64]
"""Shape [count, 2]."""

Point = Sequence[float] | NDArray[np.float64]
"""x, y, z in the patient, LPS [mm]."""

LEAST_COSINE = 0.999
"""Least cosine between the normal of a slice and an axis of the scan."""

Box = tuple[slice, slice, slice]


@dataclass(frozen=True)
class ScanSlice:
    """The voxels of a scan with one index along one axis."""

    volume: Volume
    axis: int
    """Axis of the grid: 0, 1 or 2 for x, y or z."""
    number: int

    @classmethod
    def through(cls, volume: Volume, point: Point, *, normal: Sequence[float]) -> ScanSlice:
        """Returns the slice through a point, perpendicular to a normal of any length.

        Raises:
            OptionError: The point is outside of the scan, or the normal is along none of its axes.
        """
        axis = axis_along(volume, normal)
        if axis is None:
            raise OptionError(
                f"a slice with normal {tuple(normal)} given; allowed: slices along the scan's own "
                "axes: axial, coronal, sagittal"
            )
        index = np.floor(index_of(volume, [point])[0] + 0.5)
        if not (np.all(index >= 0) and np.all(index < volume.dimensions)):
            raise OptionError(f"point {tuple(point)} given; allowed: a point in the scan")
        return cls(volume, axis, int(index[axis]))

    @cached_property
    def values(self) -> NDArray[np.float32]:
        """Values of the slice [unit of the scan], shape [rows, columns]."""
        region: list[slice | int] = [slice(None)] * 3
        region[2 - self.axis] = self.number
        return self.volume.intensities(tuple(region))

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of rows and columns."""
        rows, columns = (self.volume.dimensions[axis] for axis in reversed(self.along))
        return rows, columns

    @property
    def edges(self) -> tuple[float, float]:
        """Edges of a voxel along a column and along a row [mm], in the order of ``shape``."""
        height, width = (self.volume.spacing[axis] for axis in reversed(self.along))
        return height, width

    @property
    def box(self) -> Box:
        """Slices that select its voxels in the scan's array."""
        box = [slice(0, count) for count in self.volume.shape]
        box[2 - self.axis] = slice(self.number, self.number + 1)
        return box[0], box[1], box[2]

    def places(self, points: Sequence[Point] | NDArray[np.float64]) -> Places:
        """Returns the places of points, projected onto the slice, shape [count, 2]."""
        index: Places = index_of(self.volume, points)[:, self.along]
        return index

    def points(self, places: ArrayLike) -> NDArray[np.float64]:
        """Returns the points at places, on the middle plane of the slice, shape [count, 3]."""
        matrix = self.volume.patient_from_grid
        points: NDArray[np.float64] = (self.index(places) + 0.5) @ matrix[:3, :3].T + matrix[:3, 3]
        return points

    def index(self, places: ArrayLike) -> NDArray[np.float64]:
        """Returns the indices x, y, z of places in the scan, shape [count, 3]."""
        at = np.asarray(places, np.float64).reshape(-1, 2)
        index = np.full((len(at), 3), float(self.number))
        index[:, self.along] = at
        return index

    def key(self) -> tuple[int, int]:
        """Identifies the slice among those of its scan."""
        return self.axis, self.number

    @property
    def along(self) -> list[int]:
        """Axes of the grid along a row and along a column."""
        return [axis for axis in range(3) if axis != self.axis]


def axis_along(volume: Volume, normal: Sequence[float] | NDArray[np.float64]) -> int | None:
    """Returns the axis of the grid along which a normal of any length is; None: along none."""
    length = float(np.linalg.norm(normal))
    cosines = np.abs(volume.direction.T @ np.asarray(normal, np.float64)) / (length or np.nan)
    axis = int(np.argmax(cosines))
    return axis if cosines[axis] >= LEAST_COSINE else None


def index_of(volume: Volume, points: Sequence[Point] | NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the indices of points, integers at the centres of voxels, shape [count, 3]."""
    matrix = np.linalg.inv(volume.patient_from_grid)
    at = np.asarray(cast("ArrayLike", points), np.float64).reshape(-1, 3)
    index: NDArray[np.float64] = at @ matrix[:3, :3].T + matrix[:3, 3] - 0.5
    return index
