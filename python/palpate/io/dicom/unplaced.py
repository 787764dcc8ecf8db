"""Slices whose files tell no positions: their order and spacing as far as anything tells them.

Source: DICOM PS3.3, C.7.6.1.1.1 (Instance Number), C.7.6.2 (spacing), C.8.4.8 (NM).
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

import numpy as np

from palpate.io.dicom.geometry import Grid
from palpate.io.dicom.header import Header

__all__ = ["grid_unplaced", "in_told_order"]


def in_told_order(headers: Sequence[Header]) -> tuple[tuple[Header, ...], str]:
    """Returns files in the order of their Instance Numbers, or of their names, and which it is."""
    if len(headers) == 1 or all(header.concatenation for header in headers):
        return tuple(headers), "frames are in the order of their file"
    numbers = {header.number for header in headers}
    if None not in numbers and len(numbers) == len(headers):
        ordered = sorted(headers, key=lambda header: header.number or 0)
        return tuple(ordered), "slices are in the order of their Instance Numbers"
    ordered = sorted(headers, key=lambda header: _natural(header.path.name))
    return tuple(ordered), "slices are in the order of their files' names"


def _natural(name: str) -> list[tuple[int, str]]:
    """Returns a key that sorts IM2 before IM10."""
    parts: list[str] = re.findall(r"\d+|\D+", name)
    return [(int(part), "") if part.isdecimal() else (-1, part) for part in parts]


def grid_unplaced(headers: Sequence[Header], order: str) -> Grid:
    """Returns a grid at the origin for slices in order, with what spacing they tell."""
    first = headers[0]
    pixel = _same(frame.pixel_spacing for header in headers for frame in header.frames)
    step = _same(None if header.step is None else (abs(header.step),) for header in headers)
    thickness = _same(
        None if header.thickness is None else (header.thickness,) for header in headers
    )
    assumed = []
    if pixel is None:
        assumed.append("pixels of 1 mm")
    if step is None:
        step = thickness or (1.0,)
        assumed.append(f"slices {step[0]:g} mm apart")
    told = f"the files tell no positions: {order}"
    if assumed:
        told += f"; {' and '.join(assumed)} are assumed"
    rows, columns = pixel or (1.0, 1.0)
    return Grid(
        size=(first.columns, first.rows, sum(len(header.frames) for header in headers)),
        spacing=(columns, rows, step[0]),
        origin=(0.0, 0.0, 0.0),
        direction=np.eye(3),
        resampled=False,
        told=(told,),
    )


def _same(told: Iterable[tuple[float, ...] | None]) -> tuple[float, ...] | None:
    """Returns the lengths that all tell; None where one tells none, another, or none above 0."""
    found = list(told)
    first = found[0]
    if first is None or None in found or min(first) <= 0.0:
        return None
    # 1e-3: writers round the same spacing in different ways
    return first if np.allclose(np.array(found, float), first, rtol=1e-3) else None
