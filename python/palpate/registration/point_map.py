"""Where a transform takes many points, and where they came from.

Frame: LPS [mm]. A transform of a registration takes points of the fixed scan to the moving one.
Points have shape [count, 3].
"""

from __future__ import annotations

from typing import Any

import numpy as np

from palpate.base.errors import OptionError
from palpate.base.simpleitk import simpleitk
from palpate.registration.options import Points

__all__ = ["linear_part", "matrix_of", "points_before", "points_through"]

LEAST_DETERMINANT = 1e-6
"""Of a linear transform that can be turned back."""
MOST_ROUNDS = 60
"""Of the search for the points that a transform takes somewhere."""
CLOSE_ENOUGH = 1e-4
"""How near the place that is searched for a point must come [mm]."""


def points_through(transform: Any, points: Points) -> Points:  # noqa: ANN401  # SimpleITK has no types
    """Returns where a transform takes points, shape [count, 3] [mm].

    SimpleITK takes single points only, and grids at once: so the points are written as shifts of a
    grid with one row, which is ten times as fast.
    """
    sitk = simpleitk()
    if not len(points):
        return np.empty((0, 3))
    row = np.zeros((len(points), 3))
    row[:, 0] = np.arange(len(points))
    shifts = (np.asarray(points, np.float64) - row).reshape(1, 1, -1, 3)
    to_points = sitk.DisplacementFieldTransform(sitk.GetImageFromArray(shifts, isVector=True))
    both = sitk.CompositeTransform([transform, to_points])
    size = [len(points), 1, 1]
    field = sitk.TransformToDisplacementField(both, sitk.sitkVectorFloat64, size)
    moved: Points = sitk.GetArrayFromImage(field).reshape(-1, 3) + row
    return moved


def points_before(transform: Any, places: Points) -> tuple[Points, Points]:  # noqa: ANN401
    """Returns the points that a transform takes to places, and how near it takes them [mm].

    Newton's method with the slope of the linear part alone: exact at once for linear transforms,
    and quick for those that bend less than they stretch or squeeze twofold.

    Raises:
        OptionError: The transform flattens, so that no point is the only one.
    """
    back = _inverse_matrix(linear_part(transform))
    places = np.asarray(places, np.float64).reshape(-1, 3)
    points = places @ back[:3, :3].T + back[:3, 3]
    apart = np.full(len(places), np.inf)
    open_ones = np.arange(len(places))
    for _ in range(MOST_ROUNDS):
        off = points_through(transform, points[open_ones]) - places[open_ones]
        apart[open_ones] = np.linalg.norm(off, axis=1)
        still = apart[open_ones] > CLOSE_ENOUGH
        open_ones, off = open_ones[still], off[still]
        if not len(open_ones):
            break
        points[open_ones] -= off @ back[:3, :3].T
    return points, apart


def linear_part(transform: Any) -> Any:  # noqa: ANN401
    """Returns a transform without what bends, by the linear ones that it is made of."""
    sitk = simpleitk()
    if transform.IsLinear():
        return transform
    if transform.GetName() != "CompositeTransform":
        return sitk.Transform(3, sitk.sitkIdentity)
    whole = sitk.CompositeTransform(transform)
    parts = [whole.GetNthTransform(n) for n in range(whole.GetNumberOfTransforms())]
    return sitk.CompositeTransform([linear_part(part) for part in parts])


def matrix_of(linear: Any) -> Points:  # noqa: ANN401
    """Returns what a linear transform does to points, shape [4, 4]."""
    origin, *ends = (
        linear.TransformPoint(at) for at in np.vstack([np.zeros(3), np.eye(3)]).tolist()
    )
    matrix: Points = np.eye(4)
    matrix[:3, 3] = origin
    matrix[:3, :3] = (np.array(ends) - origin).T
    return matrix


def _inverse_matrix(linear: Any) -> Points:  # noqa: ANN401
    matrix = matrix_of(linear)
    if not np.isfinite(matrix).all() or abs(np.linalg.det(matrix)) < LEAST_DETERMINANT:
        raise OptionError("a transform that flattens given; allowed: one with an inverse")
    return np.asarray(np.linalg.inv(matrix), np.float64)
