"""Places on segments, told by a landmark, an end of a principal axis, or a point.

Frame: patient, LPS [mm]. A place is where a line that comes from outside first meets the segment.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.base.typed_numbers import parse_point
from palpate.segmentation.measures.landmarks import SIDES, points_of
from palpate.volumes.segment import Segment

__all__ = ["PLACES", "SurfacePlace", "check_place", "direction_of", "surface_places"]

PLACES = (
    f"{', '.join(SIDES)}; axis 1+, axis 1-, … axis 3- (ends of principal axes); or a point X,Y,Z "
    "in mm"
)
"""How a place may be told."""

AXIS = re.compile(r"axis ?([123])([+-])")
FINE = 0.25
"""Steps along a line, in edges of voxels."""
CLOSE = 1e-3
"""How exactly the surface is found on it [mm]."""

Point = NDArray[np.float64]


@dataclass(frozen=True)
class SurfacePlace:
    """A point on the surface of a segment, and the way into it."""

    point: Point
    """Where the line meets the segment, shape [3]."""
    inward: Point
    """Unit vector, shape [3]."""


def surface_places(
    segment: Segment,
    at: str,
    *,
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0),
    steps: NDArray[np.float64] | None = None,
) -> list[SurfacePlace]:
    """Finds a place on a segment, or places in a row.

    Args:
        segment: The segment.
        at: A side of the patient, an end of a principal axis, or a point; the way in is from that
            side, along that axis, or from the point toward the centroid.
        offset: From there on, LPS [mm].
        steps: From there on, shape [count, 3] [mm]; by default a single one of no length.

    Raises:
        OptionError: The segment is empty, there is no such place, or a line misses the segment.
    """
    start, inward = _line(segment, at)
    moved = (np.zeros((1, 3)) if steps is None else steps) + np.asarray(offset, np.float64)
    return [SurfacePlace(_first_met(segment, start + each, inward), inward) for each in moved]


def direction_of(segment: Segment, named: str) -> Point:
    """Returns the direction of a side of the patient, or of an end of a principal axis.

    Raises:
        OptionError: It is neither.
    """
    if named in SIDES:
        return np.array(SIDES[named])
    way = AXIS.fullmatch(named)
    if way is None:
        raise OptionError(f"direction {named!r} given; allowed: {', '.join(SIDES)}, axis 1+, …")
    axis: Point = _principal_axes(segment)[int(way[1]) - 1]
    return axis if way[2] == "+" else -axis


def check_place(at: str) -> None:
    """Refuses what tells no place, whatever the segment is.

    Raises:
        OptionError: It tells none.
    """
    if at not in SIDES and AXIS.fullmatch(at) is None:
        if any(letter.isalpha() for letter in at):
            raise OptionError(f"place {at!r} given; allowed: {PLACES}")
        parse_point(at)


def _line(segment: Segment, at: str) -> tuple[Point, Point]:
    """Returns a point near the surface, and the way in."""
    check_place(at)
    known = points_of(segment, ("centroid", at) if at in SIDES else ("centroid",))
    if not known:
        raise OptionError(f"{segment.name!r} is empty; allowed: a segment with a surface")
    middle = np.array(known["centroid"])
    if at in SIDES:
        return np.array(known[at]), -np.array(SIDES[at])
    if AXIS.fullmatch(at) is not None:
        way = direction_of(segment, at)
        return middle, -way
    point = np.array(parse_point(at))
    off = float(np.linalg.norm(middle - point))
    if off == 0.0:
        raise OptionError(f"place {at} given, the centroid; allowed: another point")
    return point, (middle - point) / off


def _first_met(segment: Segment, through: Point, inward: Point) -> Point:
    """Returns where a line from outside first meets a segment."""
    grid = segment.volume
    edges = np.array(grid.spacing) * np.array(grid.dimensions)
    middle = (grid.patient_from_grid @ [*(np.array(grid.dimensions) / 2.0), 1.0])[:3]
    reach = float(np.linalg.norm(edges)) / 2.0 + float(np.linalg.norm(through - middle))
    along = np.arange(-reach, reach, FINE * min(grid.spacing))
    inside = segment.contains(through + along[:, None] * inward)
    if not inside.any():
        raise OptionError(
            f"the line through {', '.join(f'{n:.1f}' for n in through)} misses {segment.name!r}; "
            "allowed: a place over the segment, such as a smaller offset or length"
        )
    after = int(inside.argmax())
    low, high = along[max(after - 1, 0)], along[after]
    while high - low > CLOSE:
        between = (low + high) / 2.0
        if segment.contains(through + between * inward)[0]:
            high = between
        else:
            low = between
    return np.asarray(through + high * inward)


def _principal_axes(segment: Segment) -> NDArray[np.float64]:
    """Returns the principal axes of the centres of voxels, the longest first, shape [3, 3].

    Each points to where its largest coordinate is positive: left, posterior or superior.
    """
    matrix = segment.volume.patient_from_grid[:3, :3]
    _, axes = np.linalg.eigh(matrix @ _covariance(segment.mask()) @ matrix.T)
    rows = axes.T[::-1]
    signs = [np.sign(row[np.abs(row).argmax()]) for row in rows]
    return np.asarray(rows * np.array(signs)[:, None])


def _covariance(mask: NDArray[np.uint8]) -> NDArray[np.float64]:
    """Returns the covariance of the indices x, y, z of voxels, layer by layer [voxels²]."""
    count, sums, products = 0, np.zeros(3), np.zeros((3, 3))
    for z, layer in enumerate(mask):
        y, x = np.nonzero(layer)
        points = np.column_stack((x, y, np.full(len(x), z))).astype(np.float64)
        count += len(points)
        sums += points.sum(axis=0)
        products += points.T @ points
    mean = sums / count
    return products / count - np.outer(mean, mean)
