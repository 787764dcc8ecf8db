"""What of structures of radiotherapy is not as it was drawn: cut off, bridged, or lost.

Frame: indices of the scan, whole at the middles of voxels.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from palpate.base.counted import listed, percent
from palpate.labels.filled import Filled
from palpate.volumes.volume import Volume

__all__ = ["StructuresTold", "cut_share"]

LEAST_CUT = 0.001
"""Share outside the scan that is told: less is how contours are rounded."""

Polygon = NDArray[np.float64]
"""Corners, shape [corners, 3]."""


@dataclass
class StructuresTold:
    """Gathers what to say of the structures of a file."""

    empty: list[str] = field(default_factory=list)
    """Without closed contours."""
    outside: list[str] = field(default_factory=list)
    small: list[str] = field(default_factory=list)
    cut: list[str] = field(default_factory=list)
    bridged: list[str] = field(default_factory=list)
    left: list[str] = field(default_factory=list)

    def add(self, name: str, found: Filled | None) -> None:
        """Takes a structure; None where it has no closed contours."""
        if found is None:
            self.empty.append(name)
        elif not found.mask.any():
            (self.outside if found.cut > LEAST_CUT else self.small).append(name)
        else:
            if found.cut > LEAST_CUT:
                self.cut.append(f"{name} ({percent(found.cut)})")
            if found.bridged:
                self.bridged.append(f"{name} ({found.bridged})")
            if found.left:
                self.left.append(f"{name} ({found.left})")

    def sentences(self) -> list[str]:
        """Returns what to say, one sentence for each kind."""
        kinds = (
            ("no closed contours", self.empty),
            ("outside the scan", self.outside),
            ("smaller than a voxel, so not on the scan", self.small),
            ("partly outside the scan, and cut off there", self.cut),
            ("planes without a contour are interpolated between their neighbours", self.bridged),
            ("planes without a contour are left empty", self.left),
        )
        return [f"{what}: {listed(names)}" for what, names in kinds if names]


def cut_share(placed: list[Polygon], volume: Volume) -> float:
    """Returns the share of contours' area that lies outside the scan, 0..1.

    Contours count by what they enclose, one by one, so that holes count as if they were filled.
    They lie in parallel planes, so that the share is the same in indices as in mm.

    Args:
        placed: Corners in indices of the scan.
        volume: The scan.
    """
    high = np.array(volume.dimensions) - 0.5
    whole = sum(_area(corners) for corners in placed)
    inside = sum(_area(_clipped(corners, high)) for corners in placed)
    return 1.0 - inside / whole if whole > 0.0 else 0.0


def _area(corners: Polygon) -> float:
    """Returns the area of a flat polygon (Newell)."""
    if len(corners) == 0:
        return 0.0
    away = corners - corners[0]
    return 0.5 * float(np.linalg.norm(np.cross(away, np.roll(away, -1, axis=0)).sum(axis=0)))


def _clipped(corners: Polygon, high: NDArray[np.float64]) -> Polygon:
    """Returns the part of a polygon from -0.5 to ``high`` on each axis.

    Source: Sutherland and Hodgman, "Reentrant polygon clipping", Communications of the ACM 17
    (1974).
    """
    for axis in (0, 1, 2):
        for sign, end in ((1.0, -0.5), (-1.0, float(high[axis]))):
            corners = _beyond(corners, sign * (corners[:, axis] - end))
    return corners


def _beyond(corners: Polygon, depth: NDArray[np.float64]) -> Polygon:
    """Returns the part of a polygon whose corners are not below 0 in depth."""
    if (depth >= 0.0).all():
        return corners
    kept = []
    for here, there, near, far in zip(
        corners, np.roll(corners, -1, axis=0), depth, np.roll(depth, -1), strict=True
    ):
        if near >= 0.0:
            kept.append(here)
        if (near >= 0.0) != (far >= 0.0):
            kept.append(here + near / (near - far) * (there - here))
    return np.array(kept).reshape(-1, 3)
