"""Parsing of numbers that users type: thresholds, points, sizes of voxels."""

from __future__ import annotations

import math

from palpate.base.errors import OptionError

__all__ = ["Bounds", "parse_point", "parse_threshold", "parse_voxel_size"]

Bounds = tuple[float, float | None]
"""Lowest and highest value; None for no upper bound."""


def parse_threshold(given: str | None) -> Bounds | None:
    """Parses a threshold, LOW or LOW,HIGH; None where none is given.

    Raises:
        OptionError: It has another form.
    """
    if given is None:
        return None
    try:
        numbers = [float(part) for part in given.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in (1, 2) or not all(map(math.isfinite, numbers)):
        raise OptionError(
            f"threshold {given!r} given; allowed: LOW or LOW,HIGH, such as 250 or 250,1500"
        )
    return numbers[0], numbers[1] if len(numbers) == 2 else None


def parse_point(given: str) -> tuple[float, float, float]:
    """Parses a point, X,Y,Z [mm].

    Raises:
        OptionError: It has another form.
    """
    try:
        x, y, z = (float(part) for part in given.split(","))
    except ValueError:
        x = y = z = math.nan
    if not all(map(math.isfinite, (x, y, z))):
        raise OptionError(f"point {given!r} given; allowed: X,Y,Z [mm], such as 12.5,-40,310")
    return x, y, z


def parse_voxel_size(given: str | None) -> tuple[float, float, float] | None:
    """Parses a voxel size, X,Y,Z [mm]; None where none is given.

    Raises:
        OptionError: It has another form.
    """
    if given is None:
        return None
    try:
        x, y, z = (float(part) for part in given.split(","))
    except ValueError:
        raise OptionError(
            f"voxel size {given!r} given; allowed: X,Y,Z [mm], such as 0.5,0.5,1.25"
        ) from None
    return x, y, z
