"""Recordings as tables for other programs: CSV, and NumPy archives with an array for each column.

Numbers are written so that reading them gives the same bits, with "." in every locale. Lengths mm,
forces N, times s, points in the scene (LPS); the orientation is a quaternion x, y, z, w from the
frame of the device's handle to that of the device.
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.whole_file import whole_file
from palpate.session.recording_columns import TickColumns, by_name

__all__ = ["write_csv", "write_npz"]

EXPORTED: dict[str, tuple[str, ...]] = {
    "tick": ("tick",),
    "time": ("time_s",),
    "device": ("device_x_mm", "device_y_mm", "device_z_mm"),
    "proxy": ("proxy_x_mm", "proxy_y_mm", "proxy_z_mm"),
    "orientation": ("orientation_x", "orientation_y", "orientation_z", "orientation_w"),
    "buttons": ("buttons",),
    "force": ("force_x_N", "force_y_N", "force_z_N"),
    "sent_force": ("sent_x_N", "sent_y_N", "sent_z_N"),
    "contact": ("contact",),
    "touched": ("touched_segment",),
    "tool_volume": ("tool_volume_mm3",),
    "tool_time": ("tool_time_s",),
    "tool_load": ("tool_load_mW",),
}
"""Columns of a recording and their names in a table; ``event`` comes last."""

ROWS_AT_ONCE = 10_000


def write_csv(path: Path, ticks: TickColumns, events: Sequence[str]) -> None:
    """Writes a header and a row for each tick; contact is 0 or 1."""
    with (
        whole_file(path) as unfinished,
        unfinished.open("w", encoding="utf-8", newline="") as file,
    ):
        writer = csv.writer(file)
        writer.writerow([name for names in EXPORTED.values() for name in names] + ["event"])
        for first in range(0, len(events), ROWS_AT_ONCE):
            rows = slice(first, first + ROWS_AT_ONCE)
            columns = [_numbers(by_name(ticks)[name][rows]) for name in EXPORTED]
            parts = zip(*columns, events[rows], strict=True)
            writer.writerows([*_flat(part[:-1]), part[-1]] for part in parts)


def write_npz(path: Path, ticks: TickColumns, events: Sequence[str]) -> None:
    """Writes arrays under the names of a recording's columns, and ``event``."""
    columns = {name: by_name(ticks)[name] for name in EXPORTED}
    with whole_file(path) as unfinished, unfinished.open("wb") as file:
        np.savez_compressed(
            file, allow_pickle=False, event=np.asarray(list(events), dtype=np.str_), **columns
        )


def _numbers(column: NDArray[Any]) -> list[Any]:
    """Returns numbers of Python, whose text gives the same bits again."""
    numbers: list[Any] = (column.astype(np.uint8) if column.dtype == bool else column).tolist()
    return numbers


def _flat(parts: Sequence[Any]) -> list[Any]:
    return [number for part in parts for number in (part if isinstance(part, list) else (part,))]
