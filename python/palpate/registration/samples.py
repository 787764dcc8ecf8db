"""How alike two images are by a few points, and how that changes with each value.

Metrics are made small. ``fixed`` and ``moving`` are values at the same points, shape [points];
slopes are derivatives by the moving values.

Sources: mutual information: Mattes et al., IEEE TMI 22(1), 2003; Thévenaz and Unser, IEEE TIP
9(12), 2000.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.simpleitk import simpleitk
from palpate.registration.options import Metric

__all__ = ["Alike", "Sampled"]

Array = NDArray[np.float64]

REACH = 2
"""Bins that are left free at both ends of the moving values: a cubic window reaches that far."""
LEAST_RANGE = 1e-6
"""Smallest range of the values of an image; a narrower one counts as this."""


class Sampled:
    """An image whose values are read between its voxels."""

    def __init__(self, image: Any) -> None:  # noqa: ANN401  # SimpleITK has no types
        """Takes SimpleITK's image."""
        self._image = image  # which holds the values
        self.values = simpleitk().GetArrayViewFromImage(image)
        """Shape [z, y, x]."""
        self.size = np.array(image.GetSize())
        axes = np.reshape(image.GetDirection(), (3, 3)) * image.GetSpacing()
        self.patient_from_index = axes
        self.index_from_patient = np.linalg.inv(axes)
        self.origin = np.array(image.GetOrigin())

    @property
    def values_range(self) -> tuple[float, float]:
        """The lowest and the highest value; never the same."""
        low, high = float(self.values.min()), float(self.values.max())
        return low, max(high, low + LEAST_RANGE)

    def index(self, points: Array) -> Array:
        """Returns points [mm] as indices of voxels, x, y, z."""
        index: Array = (points - self.origin) @ self.index_from_patient.T
        return index

    def points(self, index: Array) -> Array:
        """Returns indices of voxels as points [mm]."""
        points: Array = index @ self.patient_from_index.T + self.origin
        return points

    def inside(self, index: Array) -> NDArray[np.bool_]:
        """Says which indices lie between voxels."""
        there: NDArray[np.bool_] = np.all((index >= 0.0) & (index <= self.size - 1), axis=1)
        return there

    def read(self, index: Array) -> tuple[Array, Array]:
        """Returns values at indices that lie inside, and their slopes [per mm], [points, 3]."""
        low = np.clip(np.floor(index).astype(np.intp), 0, np.maximum(self.size - 2, 0))
        share = (index - low).T
        corners = self._corners(low)
        x, y, z = share
        along_x = corners[1] - corners[0]
        rows = corners[0] + x * along_x
        along_y = rows[1] - rows[0]
        planes = rows[0] + y * along_y
        slope_x = along_x[0] + y * (along_x[1] - along_x[0])
        values = planes[0] + z * (planes[1] - planes[0])
        slopes = np.stack(
            [
                slope_x[0] + z * (slope_x[1] - slope_x[0]),
                along_y[0] + z * (along_y[1] - along_y[0]),
                planes[1] - planes[0],
            ],
            axis=1,
        )
        return values, slopes @ self.index_from_patient

    def _corners(self, low: NDArray[np.intp]) -> Array:
        """Returns the voxels around points, [x, y, z, points], each axis of length 2."""
        high = np.minimum(low + 1, self.size - 1)
        x, y, z = (np.stack([low[:, axis], high[:, axis]]) for axis in range(3))
        found = self.values[z[None, None, :], y[None, :, None], x[:, None, None]]
        corners: Array = found.astype(np.float64)
        return corners


@dataclass(frozen=True)
class Alike:
    """A metric of two images on one level."""

    metric: Metric
    bins: int
    fixed_range: tuple[float, float]
    moving_range: tuple[float, float]

    def at(self, fixed: Array, moving: Array) -> tuple[float, Array]:
        """Returns the metric and its slopes."""
        if self.metric == "mean-squares":
            apart = moving - fixed
            return float(np.square(apart).mean()), 2.0 * apart / len(apart)
        if self.metric == "correlation":
            return _correlation(fixed, moving)
        return self._mutual_information(fixed, moving)

    def _mutual_information(self, fixed: Array, moving: Array) -> tuple[float, Array]:
        count, bins = len(fixed), self.bins
        low, high = self.fixed_range
        rows = np.clip(((fixed - low) / (high - low) * bins).astype(np.intp), 0, bins - 1)
        low, high = self.moving_range
        per_value = (bins - 2 * REACH - 1) / (high - low)
        places = np.clip((moving - low) * per_value, 0.0, bins - 2 * REACH - 1) + REACH
        first = np.floor(places).astype(np.intp) - 1
        cells = (rows * bins + first)[:, None] + np.arange(4)
        weights, slopes = _window(places - first - 1)
        joint = np.bincount(cells.ravel(), weights.ravel(), bins * bins) / count
        table = joint.reshape(bins, bins)
        of_fixed, of_moving = table.sum(axis=1, keepdims=True), table.sum(axis=0)
        there = table > 0.0
        by_moving = np.zeros_like(table)
        np.divide(table, of_moving, out=by_moving, where=there)
        np.log(by_moving, out=by_moving, where=there)
        rest = np.zeros_like(of_fixed)
        np.log(of_fixed, out=rest, where=of_fixed > 0.0)
        value = float((table * by_moving).sum() - (of_fixed * rest).sum())
        gathered = (slopes * by_moving.ravel()[cells]).sum(axis=1)
        return -value, -gathered * per_value / count


def _correlation(fixed: Array, moving: Array) -> tuple[float, Array]:
    """Returns minus the squared correlation, and its slopes."""
    still, other = fixed - fixed.mean(), moving - moving.mean()
    of_still, of_other = float(still @ still), float(other @ other)
    if of_still <= 0.0 or of_other <= 0.0:
        return 0.0, np.zeros_like(moving)
    both = float(still @ other)
    slopes = -2.0 * both / (of_still * of_other) * (still - both / of_other * other)
    return -both * both / (of_still * of_other), slopes


def _window(t: Array) -> tuple[Array, Array]:
    """Returns the weights of four bins at shares 0..1 between them, and their slopes."""
    rest = 1.0 - t
    weights = np.stack(
        [rest**3, 3 * t**3 - 6 * t**2 + 4, 3 * rest**3 - 6 * rest**2 + 4, t**3], axis=1
    )
    slopes = np.stack([-(rest**2), 3 * t**2 - 4 * t, 4 * rest - 3 * rest**2, t**2], axis=1)
    return weights / 6.0, slopes / 2.0
