"""The outline of one value in a slice, through a point.

It is the line between voxels along which the linear values between their middles are that at the
point (marching squares, contourpy). Lines that the scan's border cuts are closed along it.

Frame: patient [mm].
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.volumes.scan_slice import Point, ScanSlice
from palpate.volumes.volume import Volume

__all__ = ["traced_level"]


def traced_level(volume: Volume, point: Point, *, normal: Sequence[float]) -> NDArray[np.float64]:
    """Returns the closed outline at the value of a point through it, shape [count, 3] [patient].

    Args:
        volume: The scan.
        point: On the outline; it says which slice.
        normal: Of the slice, along an axis of the scan.

    Raises:
        OptionError: The point is not in the scan, the slice lies along no axis of the scan, or
            there is no outline: all is of one value.
    """
    from contourpy import LineType, contour_generator

    where = ScanSlice.through(volume, point, normal=normal)
    values = where.values.astype(np.float64)
    place = where.places([point])[0]
    level = _value_at(values, place)
    # lower all around, so that each line closes
    padded = np.pad(values, 1, constant_values=values.min() - 1.0)
    lines = contour_generator(z=padded, line_type=LineType.Separate).lines(level)
    closed = [np.asarray(line) - 1.0 for line in lines if len(line) > 3]
    if not closed:
        raise OptionError(f"no outline at {level:g}; allowed: a point where values change")
    outline = min(closed, key=lambda line: float(np.square(line - place).sum(axis=1).min()))
    rows, columns = where.shape
    # what closes it beyond the border runs along it
    held = np.clip(outline[:-1], -0.5, (columns - 0.5, rows - 0.5))
    return where.points(held)


def _value_at(values: NDArray[np.float64], place: NDArray[np.float64]) -> float:
    """Returns the value between the middles of four voxels."""
    rows, columns = values.shape
    column, row = np.clip(place, 0.0, (columns - 1.0, rows - 1.0))
    x, y = min(int(column), max(0, columns - 2)), min(int(row), max(0, rows - 2))
    part = values[y : y + 2, x : x + 2]
    share_x, share_y = column - x, row - y
    along = part @ [1.0 - share_x, share_x] if part.shape[1] == 2 else part[:, 0]
    return float(along @ [1.0 - share_y, share_y] if len(along) == 2 else along[0])
