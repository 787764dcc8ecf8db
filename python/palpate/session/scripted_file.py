"""Files with a path for the scripted device: CSV or JSON.

CSV: rows ``time, x, y, z``, with or without a header. JSON: a list of such rows, or an object with
that list under ``path``. Times in s from 0, points in the scene, LPS [mm].
"""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Annotated

import msgspec
import numpy as np

from palpate.base.errors import OptionError
from palpate.session.scripted_path import ScriptedPath

__all__ = ["read_path"]

MOST_BYTES = 1 << 28

Row = tuple[float, float, float, float]


class _PathFile(msgspec.Struct, forbid_unknown_fields=True):
    """The JSON form with a name."""

    path: Annotated[list[Row], msgspec.Meta(min_length=1)]


def read_path(path: Path) -> ScriptedPath:
    """Reads a path in the format of the file name's extension.

    Raises:
        OptionError: The file is not a valid path.
        OSError: The file cannot be read.
    """
    ending = path.suffix.lower()
    if ending not in {".csv", ".json"}:
        raise OptionError(f"script {path} given; allowed: a .csv or .json file")
    if path.stat().st_size > MOST_BYTES:
        raise OptionError(f"script {path} is too large; allowed: at most {MOST_BYTES} bytes")
    try:
        rows = _rows_of_json(path) if ending == ".json" else _rows_of_csv(path)
    except (msgspec.MsgspecError, ValueError) as error:
        raise OptionError(
            f"script {path} cannot be read ({error}); allowed: rows of time, x, y, z"
        ) from None
    if not rows:
        raise OptionError(f"script {path} is empty; allowed: rows of time, x, y, z")
    table = np.asarray(rows, dtype=np.float64)
    try:
        return ScriptedPath(table[:, 1:], table[:, 0])
    except OptionError as error:
        raise OptionError(f"script {path}: {error}") from None


def _rows_of_json(path: Path) -> list[Row]:
    decoded = msgspec.json.decode(path.read_bytes(), type=_PathFile | list[Row])
    return decoded.path if isinstance(decoded, _PathFile) else decoded


def _rows_of_csv(path: Path) -> list[Row]:
    with path.open(encoding="utf-8-sig", newline="") as file:
        lines = [line for line in csv.reader(file) if line]
    if lines and not _is_number(lines[0][0]):
        lines = lines[1:]
    rows: list[Row] = []
    for number, line in enumerate(lines, start=1):
        if len(line) != 4:
            raise ValueError(f"row {number} has {len(line)} numbers")
        time, x, y, z = map(float, line)
        rows.append((time, x, y, z))
    return rows


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
