"""Named points of segments: where they begin and end in the patient, and their middle.

Frame: patient, LPS [mm]; points are centres of voxels, but for the centroid.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.base.nearest import perhaps
from palpate.segmentation.measures.centroid import centroid_of
from palpate.segmentation.measures.surface_distances import border_voxels
from palpate.volumes.scene import Scene, choose_segment, require_scene
from palpate.volumes.segment import Segment

__all__ = ["POINTS", "SIDES", "Landmark", "check_points", "landmarks"]

SIDES: dict[str, tuple[float, float, float]] = {
    "left": (1.0, 0.0, 0.0),
    "right": (-1.0, 0.0, 0.0),
    "posterior": (0.0, 1.0, 0.0),
    "anterior": (0.0, -1.0, 0.0),
    "superior": (0.0, 0.0, 1.0),
    "inferior": (0.0, 0.0, -1.0),
}
"""Sides of the patient, as directions."""

POINTS = ("centroid", *SIDES)
"""Landmarks that every segment has."""

LEVEL = 1e-6
"""Voxels that are less apart along a direction lie equally far [mm]."""


@dataclass(frozen=True)
class Landmark:
    """A named point of a segment."""

    segment: str
    name: str
    """One of ``POINTS``."""
    point: tuple[float, float, float]
    """In the patient, LPS [mm]."""


def landmarks(
    scene: Scene, *, segment: str | None = None, points: Sequence[str] = POINTS
) -> list[Landmark]:
    """Returns named points of segments; an empty segment has none.

    ``centroid`` is the mean of the centres of voxels, which may lie outside of the segment. The
    others are the centres of the voxels that lie farthest to a side of the patient; of several,
    that nearest to their mean.

    Args:
        scene: The scan and its segments.
        segment: Name or number of the one segment that is meant; by default all.
        points: Which landmarks.

    Raises:
        OptionError: There is no such segment or landmark.
    """
    require_scene(scene)
    check_points(points)
    chosen = None if segment is None else choose_segment(scene, segment)
    return [
        Landmark(one.name, name, point)
        for one in scene
        if chosen is None or one.segment is chosen
        for name, point in points_of(one.segment, points).items()
    ]


def check_points(points: Sequence[str]) -> None:
    """Refuses names that no landmark has.

    Raises:
        OptionError: One is none.
    """
    for name in points:
        if name not in POINTS:
            near = perhaps(name, POINTS)
            raise OptionError(f"landmark {name!r} given{near}; allowed: {', '.join(POINTS)}")


def points_of(
    segment: Segment, points: Sequence[str] = POINTS
) -> dict[str, tuple[float, float, float]]:
    """Returns landmarks of a segment by name; none of an empty one."""
    mask = segment.mask().view(np.bool_)
    border = border_voxels(mask)
    if not len(border):
        return {}
    in_patient = _in_patient(border.astype(np.float64) + 0.5, segment)
    found: dict[str, tuple[float, float, float]] = {}
    for name in points:
        if name in SIDES:
            x, y, z = _farthest(in_patient, np.array(SIDES[name])).tolist()
            found[name] = (x, y, z)
        else:
            found[name] = centroid_of(mask, segment.volume)
    return found


def _farthest(points: NDArray[np.float64], way: NDArray[np.float64]) -> NDArray[np.float64]:
    along = points @ way
    last = points[along >= along.max() - LEVEL]
    # rounding must not choose between points that are equally near
    off = np.round(np.linalg.norm(last - last.mean(axis=0), axis=1), 6)
    nearest: NDArray[np.float64] = last[int(off.argmin())]
    return nearest


def _in_patient(in_grid: NDArray[np.float64], segment: Segment) -> NDArray[np.float64]:
    matrix = segment.volume.patient_from_grid
    return np.asarray(in_grid @ matrix[:3, :3].T + matrix[:3, 3])
