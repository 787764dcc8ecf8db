"""Where a scenario drives its tool: ways into a scan that meet what they are to meet.

All ways go along the second axis of the arrays from its lower end: in an axial scan from the front.
Masks have the shape of the volume; points are in the patient [mm].
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.volumes.volume import Volume

__all__ = ["Way", "before_body", "line_into", "line_through"]

Mask = NDArray[np.bool_]

Way = tuple[NDArray[np.float64], NDArray[np.float64]]
"""Start and target."""

BEYOND = 25.0
"""How far past what stops it a way aims, as a hand would push [mm]."""


def line_through(
    volume: Volume, first: Mask, then: Mask, *, margin: float = 8.0, longest: float = 300.0
) -> Way:
    """Returns a way that meets one mask and then another one.

    The one with the longest way in ``first`` before ``then`` is taken, up to ``longest``, of those
    whose neighbours have one too.

    Args:
        volume: The scan.
        first: What the tool goes through.
        then: Where it ends.
        margin: How far before the first voxel of either it begins [mm].
        longest: Way in ``first`` [mm].

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
    return _way(volume, (z, x), (entry - margin / spacing, end[z, x] + BEYOND / spacing))


def line_into(volume: Volume, mask: Mask, *, depth: float, margin: float) -> Way:
    """Returns a way straight into the thickest, flattest part of what is first met of a mask.

    Args:
        volume: The scan.
        mask: What the tool goes into.
        depth: How deep [mm].
        margin: How far before it the way begins [mm].

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
    return _way(
        volume,
        (z, x),
        (entry[z, x] - margin / spacing, entry[z, x] + depth / spacing),
    )


def before_body(
    volume: Volume, body: Mask, start: NDArray[np.float64], *, margin: float = 5.0
) -> NDArray[np.float64]:
    """Draws a start back until nothing of the body is before it, nor within a margin [mm]."""
    grid_from_patient = np.linalg.inv(volume.patient_from_grid)
    place = grid_from_patient @ np.append(start, 1.0)
    column = body[int(place[2]), :, int(place[0])]
    first = int(np.argmax(column)) if np.any(column) else int(place[1])
    place[1] = min(place[1], first - margin / volume.spacing[1])
    return np.asarray((volume.patient_from_grid @ place)[:3])


def _first(mask: Mask) -> NDArray[np.int64]:
    """The first voxel from the front, [z, x]; -1 where there is none."""
    return np.where(mask.any(axis=1), mask.argmax(axis=1), -1)


def _least_around(values: NDArray[Any]) -> NDArray[Any]:
    """The least of a place and of those two beside it: what is large is no rim."""
    around = values.copy()
    for axis in (0, 1):
        for step in (-2, 2):
            around = np.minimum(around, np.roll(values, step, axis=axis))
    return around


def _inside(values: NDArray[Any], outside: float = 0.0) -> NDArray[Any]:
    """Nothing beside the border of the scan, where a tool could slip off."""
    values[:2], values[-2:], values[:, :2], values[:, -2:] = (outside,) * 4
    return values


def _place_of(score: NDArray[Any]) -> tuple[int, int]:
    z, x = np.unravel_index(int(score.argmax()), score.shape)
    return int(z), int(x)


def _way(volume: Volume, column: tuple[int, int], ends: tuple[float, float]) -> Way:
    start, target = (_point(volume, column, y) for y in ends)
    return start, target


def _point(volume: Volume, column: tuple[int, int], y: float) -> NDArray[np.float64]:
    z, x = column
    grid = np.array([x + 0.5, y, z + 0.5, 1.0])
    return np.asarray((volume.patient_from_grid @ grid)[:3])
