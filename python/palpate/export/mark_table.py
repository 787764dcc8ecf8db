"""Tables of marks: points of the patient, LPS [mm], in a ``.csv``.

Read are the page's own tables ("Copy as CSV": ``L1 (mm)``, ``P1 (mm)``, ``S1 (mm)``, and so on for
up to three points a line), tables with columns ``x``, ``y``, ``z`` or ``L``, ``P``, ``S``, and
plain lines of X,Y,Z or NAME,X,Y,Z. All other cells stay as they are.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.base.whole_file import whole_file

__all__ = ["MarkTable", "read_marks"]

AXES = (("l", "p", "s"), ("x", "y", "z"))
COORDINATE = re.compile(r"([a-z])(\d*)(?: ?\(mm\))?")
FRAMES = "X,Y,Z or NAME,X,Y,Z in LPS mm, or columns x, y, z or L, P, S (LPS mm)"

Cell = tuple[int, int, int, int]
"""A line, and its columns of x, y, z."""


@dataclass(frozen=True)
class MarkTable:
    """A table, and where its points stand."""

    rows: list[list[str]]
    cells: list[Cell]

    @property
    def points(self) -> NDArray[np.float64]:
        """All points, shape [count, 3] [mm]."""
        found = [[float(self.rows[row][at]) for at in columns] for row, *columns in self.cells]
        return np.array(found, np.float64).reshape(-1, 3)

    def with_points(self, points: NDArray[np.float64]) -> MarkTable:
        """Returns the same table with other points; lengths and angles are measured anew."""
        rows = [list(row) for row in self.rows]
        of_row: dict[int, list[NDArray[np.float64]]] = {}
        for (row, *columns), point in zip(self.cells, points, strict=True):
            of_row.setdefault(row, []).append(point)
            for at, coordinate in zip(columns, point, strict=True):
                rows[row][at] = f"{coordinate:.4f}"
        head = [cell.strip().lower() for cell in rows[0]]
        if {"kind", "value"} <= set(head):
            kind, value = head.index("kind"), head.index("value")
            for row, there in of_row.items():
                if (measured := _measured(rows[row][kind], there)) is not None:
                    rows[row][value] = f"{measured:.2f}"
        return MarkTable(rows, self.cells)

    def write(self, path: Path) -> None:
        """Writes the table; whole or not.

        Raises:
            OSError: The disk refuses it.
        """
        with whole_file(path) as unfinished, unfinished.open("w", newline="") as file:
            csv.writer(file).writerows(self.rows)


def read_marks(path: Path) -> MarkTable:
    """Reads a table of points.

    Raises:
        OptionError: It holds no points, or a point has not three numbers.
    """
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            rows = [row for row in csv.reader(file) if any(cell.strip() for cell in row)]
    except (csv.Error, UnicodeDecodeError):
        raise OptionError(f"{path} is no table of points; allowed: {FRAMES}") from None
    columns, first = _columns(path, rows)
    cells: list[Cell] = []
    for number, row in enumerate(rows[first:], first):
        for x, y, z in columns:
            told = [row[at].strip() if at < len(row) else "" for at in (x, y, z)]
            if not any(told):
                continue
            if not all(map(_is_number, told)):
                raise OptionError(
                    f"{path}, line {number + 1}: {','.join(told)!r} given; allowed: {FRAMES}"
                )
            cells.append((number, x, y, z))
    if not cells:
        raise OptionError(f"no points in {path}; allowed: {FRAMES}")
    return MarkTable(rows, cells)


def _columns(path: Path, rows: Sequence[Sequence[str]]) -> tuple[list[tuple[int, int, int]], int]:
    """Returns the columns of each point of a line, and the first line that has points."""
    head = [cell.strip().lower() for cell in rows[0]] if rows else []
    places: dict[tuple[str, str], int] = {}
    for at, cell in enumerate(head):
        if named := COORDINATE.fullmatch(cell):
            places[named[1], named[2]] = at
    if {"r", "a"} <= {axis for axis, _ in places}:
        raise OptionError(f"{path} has columns R and A; allowed: {FRAMES}")
    found = [
        (places[x, number], places[y, number], places[z, number])
        for x, y, z in AXES
        for number in sorted({number for _, number in places})
        if {(x, number), (y, number), (z, number)} <= places.keys()
    ]
    if found:
        return found, 1
    numbers = [_is_number(cell) for cell in head]
    if numbers == [True] * 3:
        return [(0, 1, 2)], 0
    if numbers == [False, True, True, True]:
        return [(1, 2, 3)], 0
    raise OptionError(f"{path} is no table of points; allowed: {FRAMES}")


def _is_number(word: str) -> bool:
    try:
        return bool(np.isfinite(float(word)))
    except ValueError:
        return False


def _measured(kind: str, points: list[NDArray[np.float64]]) -> float | None:
    """Returns the length [mm] or the angle [degrees] of a mark; None where it has none."""
    if kind in ("distance", "path") and len(points) == 2:
        return float(np.linalg.norm(points[1] - points[0]))
    if kind == "angle" and len(points) == 3:
        ways = [points[0] - points[1], points[2] - points[1]]
        size = float(np.prod([np.linalg.norm(way) for way in ways]))
        return float(np.degrees(np.arccos(np.clip(ways[0] @ ways[1] / size, -1.0, 1.0))))
    return None
