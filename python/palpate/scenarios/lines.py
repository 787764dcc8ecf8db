"""Paths of tools in scenarios: straight lines through a scan that meet certain structures.

All paths run along the second axis of the arrays from its lower end: from the front in an axial
scan. Masks have the shape of the volume; points are in the patient, LPS [mm].
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.volumes.volume import Volume

__all__ = ["ToolPath", "before_body", "line_into", "line_through"]

Mask = NDArray[np.bool_]

ToolPath = tuple[NDArray[np.float64], NDArray[np.float64]]
"""Start and target."""

BEYOND = 25.0
"""How far past the obstacle a path ends, as a hand would push [mm]."""


def line_through(
    volume: Volume, first: Mask, then: Mask, *, margin: float = 8.0, longest: float = 300.0
) -> ToolPath:
    """Returns a path that meets one mask and then another one.

    Of the paths whose neighbours also meet both, the one with the longest part in ``first`` before
    ``then``, up to ``longest``, is taken.

    Args:
        volume: The scan.
        first: What the tool passes through.
        then: Where it ends.
        margin: Distance of the start from the first voxel of either [mm].
        longest: Longest part in ``first`` [mm].

    Raises:
        OptionError: No line meets both.
    """
    end = _first(then)
    before = np.arange(first.shape[1])[None, :, None] < end[:, None, :]
    length = (first & before).sum(axis=1)
    length[length > longest / volume.spacing[1]] = 0
    length = _inside(_least_around(length))
    if not length.any():
        raise OptionError("no line from the front meets both; allowed: segments behind one another")
    z, x = _place_of(length)
    entry = int((first | then)[z, :, x].argmax())
    spacing = volume.spacing[1]
    return _path(volume, (z, x), (entry - margin / spacing, end[z, x] + BEYOND / spacing))


def line_into(volume: Volume, mask: Mask, *, depth: float, margin: float) -> ToolPath:
    """Returns a path into the thickest and flattest part of the front of a mask.

    Args:
        volume: The scan.
        mask: What the tool enters.
        depth: Depth of the path in the mask [mm].
        margin: Distance of the start from the mask [mm].

    Raises:
        OptionError: There is no such part.
    """
    spacing = volume.spacing[1]
    entry = _first(mask)
    behind = np.arange(mask.shape[1])[None, :, None] >= entry[:, None, :]
    gone = ~mask & behind
    exit_ = np.where(gone.any(axis=1), gone.argmax(axis=1), mask.shape[1])
    thick = np.where(entry >= 0, exit_ - entry, 0) * spacing
    # what is no deeper than asked needs no more
    thick = np.minimum(_least_around(thick), depth)
    steps = [np.abs(entry - np.roll(entry, way, axis=axis)) for axis in (0, 1) for way in (-2, 2)]
    flat = np.max(steps, axis=0) * spacing
    score = _inside(np.where(thick > 0.0, thick - flat, -np.inf), outside=-np.inf)
    if not np.isfinite(score).any():
        raise OptionError("nothing to drill from the front given; allowed: bone that is met there")
    z, x = _place_of(score)
    return _path(
        volume,
        (z, x),
        (entry[z, x] - margin / spacing, entry[z, x] + depth / spacing),
    )


def before_body(
    volume: Volume, body: Mask, start: NDArray[np.float64], *, margin: float = 5.0
) -> NDArray[np.float64]:
    """Moves a start back until no voxel of the body is in front of it or within a margin [mm]."""
    grid_from_patient = np.linalg.inv(volume.patient_from_grid)
    place = grid_from_patient @ np.append(start, 1.0)
    column = body[int(place[2]), :, int(place[0])]
    first = int(np.argmax(column)) if np.any(column) else int(place[1])
    place[1] = min(place[1], first - margin / volume.spacing[1])
    return np.asarray((volume.patient_from_grid @ place)[:3])


def _first(mask: Mask) -> NDArray[np.int64]:
    """Returns the first voxel from the front, [z, x]; -1 where there is none."""
    return np.where(mask.any(axis=1), mask.argmax(axis=1), -1)


def _least_around(values: NDArray[Any]) -> NDArray[Any]:
    """Returns the least value of each place and its neighbours, so that rims are small."""
    around = values.copy()
    for axis in (0, 1):
        for step in (-2, 2):
            around = np.minimum(around, np.roll(values, step, axis=axis))
    return around


def _inside(values: NDArray[Any], outside: float = 0.0) -> NDArray[Any]:
    """Clears places at the border of the scan, where a tool could slip off."""
    values[:2], values[-2:], values[:, :2], values[:, -2:] = (outside,) * 4
    return values


def _place_of(score: NDArray[Any]) -> tuple[int, int]:
    z, x = np.unravel_index(int(score.argmax()), score.shape)
    return int(z), int(x)


def _path(volume: Volume, column: tuple[int, int], ends: tuple[float, float]) -> ToolPath:
    start, target = (_point(volume, column, y) for y in ends)
    return start, target


def _point(volume: Volume, column: tuple[int, int], y: float) -> NDArray[np.float64]:
    z, x = column
    grid = np.array([x + 0.5, y, z + 0.5, 1.0])
    return np.asarray((volume.patient_from_grid @ grid)[:3])
