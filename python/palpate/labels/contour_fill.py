"""Contours of one plane as a mask: overlapping ones joined, one wholly inside another a hole.

DICOM has no rule for several CLOSED_PLANAR contours in a plane but that each encloses a part. What
writers mean is their union, where they overlap or come twice, and a hole where one lies wholly
inside another, as drawn by hand; a hole may also be reached by a narrow channel (keyhole), which
the even-odd rule within one contour fills rightly.

Frame: corners as (column, row) in pixels, whole at their centres.
Source: DICOM PS3.3, C.8.8.6.3 (contour geometric type).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from palpate.volumes.polygon_fill import fill_polygons

__all__ = ["fill_contours"]

SAME = 0.1
"""Contours whose corners lie nearer to one another's edges than this are the same one [pixel]."""
TOUCHING = 1e-3
"""Corners nearer to an edge than this lie on it [pixel]."""
MOST_PAIRS = 1 << 20
"""Of points and corners, that are looked at together."""

Corners = NDArray[np.float64]
"""Shape [corners, 2]."""


def fill_contours(
    polygons: Sequence[Corners], shape: tuple[int, ...], *, exclusive: bool = False
) -> NDArray[np.uint8]:
    """Returns 1 for the pixels whose centres contours enclose.

    Args:
        polygons: Corners of each contour.
        shape: Shape of the slice, [rows, columns].
        exclusive: Whether pixels in an even number of contours are outside (CLOSEDPLANAR_XOR).
    """
    if exclusive or len(polygons) == 1:
        return fill_polygons(polygons, shape)
    inside = _directly_inside(polygons)
    # from the largest to the smallest, each once what it holds is known
    filled: dict[int, NDArray[np.bool_]] = {}
    for one in sorted(range(len(polygons)), key=lambda index: _area(polygons[index])):
        if inside[one] is None:
            continue
        filled[one] = fill_polygons([polygons[one]], shape).astype(bool)
        for other, around in enumerate(inside):
            if around is not None and one in around:
                filled[one] &= ~filled[other]
    mask = np.zeros(shape, np.uint8)
    for one, around in enumerate(inside):
        if around == set():
            mask[filled[one]] = 1
    return mask


def _directly_inside(polygons: Sequence[Corners]) -> list[set[int] | None]:
    """Returns which contours each lies in, without those around them; None for repeated ones."""
    areas = [_area(corners) for corners in polygons]
    boxes = [(corners.min(axis=0), corners.max(axis=0)) for corners in polygons]
    order = sorted(range(len(polygons)), key=lambda index: -areas[index])
    around: list[set[int] | None] = [set() for _ in polygons]
    for place, inner in enumerate(order):
        found: set[int] = set()
        for outer in order[:place]:
            if around[outer] is None or not _box_inside(boxes[inner], boxes[outer]):
                continue
            if _box_inside(boxes[outer], boxes[inner]) and _is_same(
                polygons[inner], polygons[outer]
            ):
                around[inner] = None
                break
            if _is_inside(polygons[inner], polygons[outer]):
                found.add(outer)
        else:
            far = {one for outer in found for one in around[outer] or ()}
            around[inner] = found - far
    return around


def _area(corners: Corners) -> float:
    x, y = corners.T
    return 0.5 * abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))))


def _box_inside(inner: tuple[Corners, Corners], outer: tuple[Corners, Corners]) -> bool:
    return bool((inner[0] >= outer[0] - SAME).all() and (inner[1] <= outer[1] + SAME).all())


def _is_same(one: Corners, other: Corners) -> bool:
    return bool(_distances(one, other).max() <= SAME and _distances(other, one).max() <= SAME)


def _is_inside(inner: Corners, outer: Corners) -> bool:
    """Says whether one contour lies wholly inside another, and does not only reach into it."""
    within = _enclosed(inner, outer)
    if not within.all() and _distances(inner[~within], outer).max() > TOUCHING:
        return False
    reaching = _enclosed(outer, inner)
    return not reaching.any() or bool(_distances(outer[reaching], inner).max() <= TOUCHING)


def _enclosed(points: Corners, polygon: Corners) -> NDArray[np.bool_]:
    """Says which points a polygon encloses, by the even-odd rule."""
    some = [_enclosed_some(part, polygon) for part in _split(points, polygon)]
    return np.concatenate(some)


def _split(points: Corners, polygon: Corners) -> list[Corners]:
    """Returns points in parts, so that pairs of them with corners fit into memory."""
    parts = -(-len(points) * len(polygon) // MOST_PAIRS)
    return np.array_split(points, max(1, parts))


def _enclosed_some(points: Corners, polygon: Corners) -> NDArray[np.bool_]:
    start, end = polygon, np.roll(polygon, -1, axis=0)
    x, y = points[:, :1], points[:, 1:]
    crosses = (start[:, 1] <= y) != (end[:, 1] <= y)
    rise = np.where(start[:, 1] == end[:, 1], 1.0, end[:, 1] - start[:, 1])
    at = start[:, 0] + (y - start[:, 1]) / rise * (end[:, 0] - start[:, 0])
    enclosed: NDArray[np.bool_] = np.count_nonzero(crosses & (at > x), axis=1) % 2 == 1
    return enclosed


def _distances(points: Corners, polygon: Corners) -> NDArray[np.float64]:
    """Returns how far points are from the nearest edge of a polygon [pixel]."""
    some = [_distances_some(part, polygon) for part in _split(points, polygon)]
    return np.concatenate(some)


def _distances_some(points: Corners, polygon: Corners) -> NDArray[np.float64]:
    edge = np.roll(polygon, -1, axis=0) - polygon
    away = points[:, None] - polygon
    length = np.maximum((edge * edge).sum(axis=1), 1e-12)
    share = np.clip((away * edge).sum(axis=2) / length, 0.0, 1.0)
    nearest: NDArray[np.float64] = np.linalg.norm(away - share[:, :, None] * edge, axis=2)
    least: NDArray[np.float64] = nearest.min(axis=1)
    return least
