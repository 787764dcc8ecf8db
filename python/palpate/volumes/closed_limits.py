"""Limits of values, closed in what the file holds.

A person types 0.3 and means the voxels whose value is read as 0.3: 3 steps of 0.1, which are a
little more as binary numbers, or what is nearest to 0.3 in single precision. So limits are compared
as stored numbers where these hold all values, and in the type of the values where they do not.

Touch, surfaces and the picture know stored numbers only. Where these are rounded, a limit among the
values that share a number cannot part them; all others part the same voxels.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from palpate.volumes.stored_values import I16

if TYPE_CHECKING:
    from palpate.volumes.volume import Region, Volume

__all__ = ["as_stored", "between", "limits_on_stored"]


def between(volume: Volume, low: float, high: float, *, region: Region = ...) -> NDArray[np.bool_]:
    """Returns which voxels have low <= value <= high; see ``Volume.between``."""
    inside: NDArray[np.bool_]
    if volume.exact is not None:
        values = volume.exact[region]
        first, last = _in_type_of(volume, low, high)
        # limits in the type of the values, as far as it goes
        with np.errstate(over="ignore"):
            inside = (values >= first) & (values <= last)
        return inside
    numbers = np.arange(I16.min, I16.max + 1, dtype=np.int16)
    values = numbers * volume.slope + volume.intercept
    first, last = as_stored(volume, low), as_stored(volume, high)
    (within,) = np.nonzero((values >= first) & (values <= last))
    stored = volume.array[region]
    if within.size == 0:
        return np.zeros(stored.shape, bool)
    inside = (stored >= numbers[within[0]]) & (stored <= numbers[within[-1]])
    return inside


def _in_type_of(volume: Volume, low: float, high: float) -> tuple[float, float]:
    """Returns limits as the exact values are compared with them.

    Python and NumPy compare integers exactly, and floats beyond 2^53 not.
    """
    assert volume.exact is not None  # noqa: S101  # or stored numbers are compared
    if volume.exact.dtype.kind not in "iu":
        return float(low), float(high)
    # the highest value may be rounded down in the range, which is in floats
    whole_range = high == volume.range[1]
    return (
        math.ceil(low) if math.isfinite(low) else low,
        np.inf if whole_range or not math.isfinite(high) else math.floor(high),
    )


def as_stored(volume: Volume, limit: float) -> float:
    """Returns the value of a stored number where a limit is that but for rounding."""
    number = _number_of(volume, limit)
    if number is None:
        return limit
    value = volume.value_of(number)
    return value if abs(value - limit) <= volume.scale.rounding(limit) else limit


def limits_on_stored(volume: Volume, low: float, high: float) -> tuple[float, float]:
    """Returns limits that part the same voxels by stored numbers too, where they can.

    Ends that no value is beyond are beyond all stored ones.
    """
    if volume.exact is None:
        return as_stored(volume, low), as_stored(volume, high)
    stored = map(int, (volume.array.min(), volume.array.max()))
    first, last = sorted(map(volume.value_of, stored))
    lowest, highest = volume.range
    return (
        min(low, first) if low <= lowest else _apart(volume, low, inward=1),
        max(high, last) if high >= highest else _apart(volume, high, inward=-1),
    )


def _apart(volume: Volume, limit: float, *, inward: int) -> float:
    """Returns a limit that has all that is rounded to its number on the side where it is.

    Args:
        volume: A scan with exact values.
        limit: A lowest value, or a highest one.
        inward: 1 for a lowest one, -1 for a highest one.
    """
    number = _number_of(volume, limit)
    if number is None:
        return limit
    ends = (limit, np.inf) if inward > 0 else (-np.inf, limit)
    inside = between(volume, *ends, region=volume.array == number)
    value = volume.value_of(number)
    if inside.all():
        return inward * min(inward * limit, inward * value)
    if not inside.any():
        half = value + 0.5 * inward * abs(volume.slope)
        return inward * max(inward * limit, inward * half)
    return limit


def _number_of(volume: Volume, value: float) -> int | None:
    """Returns the stored number that is nearest to a value; None where there is none."""
    steps = (value - volume.intercept) / volume.slope
    # the value of the last number, as it is rounded, may be a little beyond it
    if not I16.min - 0.5 <= steps <= I16.max + 0.5:
        return None
    return min(max(round(steps), I16.min), I16.max)
