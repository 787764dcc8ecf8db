"""What a tool leaves in bone: the depth of its hole, the height of its rim, and a section."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["BONE", "COME", "EMPTY", "GONE", "Hole", "hole_of", "hole_told"]

Mask = NDArray[np.bool_]

AROUND = 12.0
"""Bone shown on either side of the path and below the hole [mm]."""

EMPTY, BONE, GONE, COME = " ", "#", "-", "+"
"""Signs of a section."""


@dataclass(frozen=True, kw_only=True)
class Hole:
    """Hole in bone along the second axis of the scan, as voxels show it after the tool is out."""

    depth: float
    """Deepest place of bone that is empty now, below the first bone on its line [mm]."""
    rim: float
    """Highest bone that has come, above the first bone on its line before [mm]."""
    section: tuple[str, ...]
    """Rows along the path, columns along the first axis: ``#`` bone, ``-`` bone that is gone, ``+``
    bone that has come, a space where there is none."""
    spacing: tuple[float, float]
    """Between columns and between rows [mm]."""


def hole_of(
    before: Mask, after: Mask, *, column: tuple[int, int], spacing: tuple[float, float, float]
) -> Hole:
    """Compares bone before and after a tool.

    Args:
        before: Bone, shape [z, y, x].
        after: Bone afterwards, same shape.
        column: Voxel (x, z) of the path.
        spacing: Spacing along x, y, z [mm].
    """
    gone, come = before & ~after, after & ~before
    first = np.where(before.any(axis=1), before.argmax(axis=1), before.shape[1])
    rows = np.arange(before.shape[1])[None, :, None]
    below = (rows + 1 - first[:, None, :])[gone]
    above = (first[:, None, :] - rows)[come]
    x, z = column
    top = int(first[z, x])
    deepest = int(below.max(initial=0))
    side, up = round(AROUND / spacing[0]), round(AROUND / spacing[1])
    left = max(x - side, 0)
    part = np.s_[z, max(top - up, 0) : top + deepest + up, left : x + side + 1]
    signs = np.full(before[part].shape, EMPTY)
    signs[before[part] & after[part]] = BONE
    signs[gone[part]] = GONE
    signs[come[part]] = COME
    return Hole(
        depth=deepest * spacing[1],
        # beside the path the first bone of a line may be another one, far above or below
        rim=max(int(above[above < before.shape[1] // 2].max(initial=0)), 0) * spacing[1],
        section=tuple("".join(row) for row in signs),
        spacing=(spacing[0], spacing[1]),
    )


def hole_told(told: Mapping[str, Any] | None) -> Hole | None:
    """Returns a hole as a file tells it."""
    if told is None:
        return None
    x, y = told["spacing"]
    return Hole(
        depth=told["depth"], rim=told["rim"], section=tuple(told["section"]), spacing=(x, y)
    )
