"""Filled contours of parallel planes, and what lies between and beyond them.

Between two planes the shape is interpolated by its signed distances, cut where the area is what
lies between the areas of both, so that the volume is right however the shape changes. Beyond the
first and last plane of a structure, and at gaps wider than usual, it goes on for half a thickness.

Frame: heights along the planes' normal in any unit; sheets are [row, column].
Source: Raya and Udupa, "Shape-based interpolation of multidimensional objects", IEEE Transactions
on Medical Imaging 9 (1990).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["MOST_SLICES", "ContourStack", "planes_of"]

WIDEST_STEP = 1.5
"""Steps wider than this are gaps between parts of a structure [usual step]."""
MOST_SLICES = 2.1
"""Planes up to this far apart belong together [slices]; wider ones, where they are regular."""
LEAST_REGULAR = 3
"""Steps of one height that show how far apart a structure was drawn, if most steps are such."""
MOST_MISSING = 2
"""Planes in a row that may be missing: more are parts of a structure that lie apart."""
MISSING_OFF = 0.2
"""By how much the planes around them are off their places [step]."""
SAME_STEP = 0.1
"""By how much such steps differ [step]."""


def planes_of(
    heights: NDArray[np.float64], *, least: float
) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Returns the heights of planes, rising, and which of them each contour lies in.

    Args:
        heights: Of each contour.
        least: Contours nearer than this lie in one plane.
    """
    order = np.argsort(heights, kind="stable")
    starts = np.diff(heights[order], prepend=-np.inf) > least
    number = np.empty(len(heights), np.intp)
    number[order] = np.cumsum(starts) - 1
    return heights[order][starts], number


@dataclass
class ContourStack:
    """Masks of what contours enclose, plane by plane."""

    planes: NDArray[np.float64]
    """Heights, rising."""
    sheets: NDArray[np.uint8]
    """Shape [planes, rows, columns]."""
    pixel: tuple[float, float]
    """Between rows and between columns, in one unit."""
    thickness: float
    """Of a structure that lies in one plane."""
    widest: float
    """Planes further apart than this belong together only where a structure is drawn regularly."""

    def __post_init__(self) -> None:
        steps = np.diff(self.planes)
        self._usual = self._usual_step(steps)
        self._joined = steps <= WIDEST_STEP * self._usual
        half = 0.5 * np.where(self._joined, steps, self._usual)
        # how far each plane's shape goes on below and above it, where it has no neighbour
        self._below = np.concatenate([half[:1] if len(half) else [0.5 * self._usual], half])
        self._above = np.concatenate([half, half[-1:] if len(half) else [0.5 * self._usual]])
        self._distances: dict[int, NDArray[np.float64]] = {}

    def _usual_step(self, steps: NDArray[np.float64]) -> float:
        """Returns the distance of planes that belong together.

        Lesions of one slice each, far apart, are no tube: few wide steps show nothing.
        """
        usual = float(np.median(steps)) if len(steps) else 0.0
        regular = np.count_nonzero(np.abs(steps - usual) <= SAME_STEP * usual)
        if regular >= max(LEAST_REGULAR, 0.5 * len(steps)):
            return usual
        near = steps[steps <= self.widest]
        return float(np.median(near)) if len(near) else self.thickness

    def missing(self) -> tuple[int, int]:
        """Returns how many planes without a contour are bridged, and how many are left empty.

        They lie within the structure: contours above and below overlap.
        """
        steps = np.diff(self.planes)
        base = float(min(steps.min(initial=np.inf), self._usual))
        bridged = left = 0
        for lower, step in enumerate(steps):
            count = round(step / base) - 1
            off = abs(step - (count + 1) * base)
            if not 1 <= count <= MOST_MISSING or off > MISSING_OFF * base:
                continue
            if not (self.sheets[lower] & self.sheets[lower + 1]).any():
                continue
            bridged += count if self._joined[lower] else 0
            left += 0 if self._joined[lower] else count
        return bridged, left

    @property
    def ends(self) -> tuple[float, float]:
        """Lowest and highest height that it reaches."""
        return self.planes[0] - self._below[0], self.planes[-1] + self._above[-1]

    def at(self, height: float) -> NDArray[np.uint8] | None:
        """Returns the mask at a height; None where there is none of it."""
        lower = int(np.searchsorted(self.planes, height, "right")) - 1
        rounding = 1e-6 * self._usual
        for near in (lower, lower + 1):
            if 0 <= near < len(self.planes) and abs(self.planes[near] - height) <= rounding:
                return self._sheet(near)
        if 0 <= lower < len(self._joined) and self._joined[lower]:
            step = self.planes[lower + 1] - self.planes[lower]
            return self._between(lower, float((height - self.planes[lower]) / step))
        # a lower end counts, an upper one does not
        if lower >= 0 and height < self.planes[lower] + self._above[lower] - rounding:
            return self._sheet(lower)
        upper = lower + 1
        if (
            upper < len(self.planes)
            and height >= self.planes[upper] - self._below[upper] - rounding
        ):
            return self._sheet(upper)
        return None

    def _sheet(self, plane: int) -> NDArray[np.uint8]:
        sheet: NDArray[np.uint8] = self.sheets[plane]
        return sheet

    def _between(self, lower: int, share: float) -> NDArray[np.uint8]:
        areas = self.sheets[lower : lower + 2].sum(axis=(1, 2), dtype=float)
        if not areas.all():
            return self._sheet(lower if share <= 0.5 else lower + 1)
        depth = (1.0 - share) * self._depth(lower) + share * self._depth(lower + 1)
        wanted = max(1, round((1.0 - share) * areas[0] + share * areas[1]))
        level = np.partition(depth.ravel(), -wanted)[-wanted]
        # pixels of one depth are all in or all out, whichever is nearer
        within, beyond = depth >= level, depth > level
        more, fewer = np.count_nonzero(within), np.count_nonzero(beyond)
        nearer: NDArray[np.bool_] = (
            within if fewer == 0 or more - wanted <= wanted - fewer else beyond
        )
        return nearer.astype(np.uint8)

    def _depth(self, plane: int) -> NDArray[np.float64]:
        """Returns how deep pixels lie inside a plane's contours; below 0 outside."""
        from scipy.ndimage import distance_transform_edt

        if plane not in self._distances:
            # slices come in order: the two planes around one are enough
            self._distances = {
                one: depth for one, depth in self._distances.items() if abs(one - plane) <= 1
            }
            # air around it, so that there always is an outside
            inside = np.pad(self.sheets[plane], 1).astype(bool)
            depth = distance_transform_edt(inside, sampling=self.pixel)
            depth -= distance_transform_edt(~inside, sampling=self.pixel)
            self._distances[plane] = depth[1:-1, 1:-1]
        return self._distances[plane]
