"""Several stacks in one file of many frames: each becomes a series of its own.

Frames that are turned against each other, or have other pixels, are other stacks; so are parallel
ones that the file calls so, where together they are no stack.

Source: DICOM PS3.3, C.7.6.16.2.2 (Stack ID).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from palpate.io.dicom.phases import parted

if TYPE_CHECKING:
    from palpate.io.dicom.header import Frame, Header, Series

__all__ = ["stacks_of"]

ALIKE = 2e-3, 1e-3
"""By how much cosines of parallel frames and pixel spacings [mm] differ at most."""
FARTHEST = 3.0
"""Parallel stacks farther apart than so many of their steps are no stack together."""
SAME_PLACE = 1e-3
"""Slices nearer than this lie at one height [mm]."""

Slice = tuple["Header", int]


def stacks_of(series: Series) -> list[Series]:
    """Returns the stacks that a series of files of many frames holds: itself, where it is one."""
    if all(len(header.frames) == 1 for header in series.headers):
        return [series]
    slices = [(header, index) for header in series.headers for index in range(len(header.frames))]
    groups: list[list[Slice]] = []
    for one in slices:
        group = next((group for group in groups if _alike(_frame(group[0]), _frame(one))), None)
        if group is None:
            groups.append([one])
        else:
            group.append(one)
    parts = [part for group in groups for part in _by_name(group)]
    if len(parts) == 1:
        return [series]
    names = [_frame(part[0]).stack for part in parts]
    told = len(set(names)) == len(names) and "" not in names
    return [
        parted(series, f"stack {name if told else number}", part)
        for number, (name, part) in enumerate(zip(names, parts, strict=True), 1)
    ]


def _frame(one: Slice) -> Frame:
    header, index = one
    return header.frames[index]


def _alike(one: Frame, other: Frame) -> bool:
    told = (
        (one.orientation, other.orientation, ALIKE[0]),
        (one.pixel_spacing, other.pixel_spacing, ALIKE[1]),
    )
    return all(
        first is second
        or (first is not None and second is not None and np.allclose(first, second, 0.0, off))
        for first, second, off in told
    )


def _by_name(group: list[Slice]) -> list[list[Slice]]:
    """Returns parallel frames by the names of their stacks, where they are no stack together."""
    named: dict[str, list[Slice]] = {}
    for one in group:
        named.setdefault(_frame(one).stack, []).append(one)
    if len(named) == 1 or any(_frame(one).position is None for one in group):
        return [group]
    heights = {name: _heights(part) for name, part in named.items()}
    return list(named.values()) if _are_apart(list(heights.values())) else [group]


def _heights(part: Sequence[Slice]) -> list[float]:
    orientation = np.reshape(_frame(part[0]).orientation or (1, 0, 0, 0, 1, 0), (2, 3))
    normal = np.cross(orientation[0], orientation[1])
    return sorted({round(float(np.dot(normal, _frame(one).position or 0)), 3) for one in part})


def _are_apart(stacks: list[list[float]]) -> bool:
    """Says whether stacks overlap or leave wide gaps, by the heights of their slices."""
    together = np.sort(np.concatenate(stacks))
    steps = np.diff(together)
    own = [step for heights in stacks for step in np.diff(heights)]
    usual = float(np.median(own)) if own else float(steps.max(initial=0.0))
    return bool((steps < SAME_PLACE).any() or (steps > FARTHEST * usual).any())
