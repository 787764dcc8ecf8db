"""Files of landmarks: pairs of points, of the fixed scan and of the moving one."""

from __future__ import annotations

import csv
from pathlib import Path

from palpate.base.errors import OptionError
from palpate.registration.options import Pairs

__all__ = ["read_landmarks"]


def read_landmarks(path: Path) -> Pairs:
    """Reads pairs of points: six numbers a line, with commas; empty and other lines are left out.

    Raises:
        OptionError: A line that begins with a number has not six of them, or there is none.
    """
    fixed, moving = [], []
    for number, row in enumerate(csv.reader(path.read_text(encoding="utf-8").splitlines()), 1):
        if not row or not _is_number(row[0]):
            continue
        if len(row) != 6 or not all(map(_is_number, row)):
            raise OptionError(
                f"{path}, line {number}: {','.join(row)!r} given; allowed: X,Y,Z,X,Y,Z [mm], a "
                "point of the fixed scan and the same place in the moving one"
            )
        values = [float(word) for word in row]
        fixed.append(values[:3])
        moving.append(values[3:])
    if not fixed:
        raise OptionError(f"no pairs of points in {path}; allowed: lines of X,Y,Z,X,Y,Z [mm]")
    return fixed, moving


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True
