"""Segments of a scene as arrays that files can hold: one map of labels, or layers of them.

Arrays are [z, y, x]; 0 is no segment.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.export.numbering import kind_for
from palpate.volumes.scene import Scene, SceneSegment

__all__ = ["Layered", "label_map", "layered", "overlap_of", "written_segments"]


def written_segments(
    scene: Scene, only: Sequence[str] | None = None
) -> tuple[list[SceneSegment], list[str]]:
    """Chooses segments whose voxels lie on the scan's grid, and says which are left out.

    Args:
        scene: The scan and its segments.
        only: Names of those wanted; all where None.

    Raises:
        OptionError: There is no such segment, or none at all.
    """
    names = [one.name for one in scene]
    for name in only or ():
        if name not in names:
            listed = ", ".join(names) or "none in this scan"
            raise OptionError(f"segment {name!r} given; allowed: {listed}")
    wanted = [one for one in scene if only is None or one.name in only]
    told = [
        f"{one.name} has a grid of its own and is left out: write its surface instead"
        for one in wanted
        if one.segment.has_own_grid
    ]
    there = [one for one in wanted if not one.segment.has_own_grid]
    empty = [one.name for one in there if one.segment.voxel_count == 0]
    told += [f"{name} is empty and is left out" for name in empty]
    kept = [one for one in there if one.segment.voxel_count > 0]
    if not kept:
        raise OptionError(
            "no segments to write (" + ("; ".join(told) or "the scan has none") + "); allowed: "
            "a scan with segments"
        )
    return kept, told


def label_map(segments: Sequence[SceneSegment], numbers: Sequence[int]) -> tuple[NDArray[Any], int]:
    """Numbers voxels by their segment; the last of several holds.

    Returns the map, and how many voxels belong to more than one segment.
    """
    labels = np.zeros(segments[0].segment.volume.shape, kind_for(numbers))
    shared = 0
    for number, one in zip(numbers, segments, strict=True):
        box, inside = _part(one)
        shared += int(np.count_nonzero(labels[box][inside]))
        labels[box][inside] = number
    return labels, shared


@dataclass(frozen=True)
class Layered:
    """Maps of labels that together hold segments which overlap."""

    layers: tuple[NDArray[Any], ...]
    places: tuple[tuple[int, int], ...]
    """Layer and value of each segment."""


def layered(segments: Sequence[SceneSegment], numbers: Sequence[int]) -> Layered:
    """Lays each segment under its number into the first layer where it overlaps no other."""
    layers: list[NDArray[Any]] = []
    places: list[tuple[int, int]] = []
    for one, number in zip(segments, numbers, strict=True):
        box, inside = _part(one)
        free = (index for index, layer in enumerate(layers) if not layer[box][inside].any())
        index = next(free, len(layers))
        if index == len(layers):
            layers.append(np.zeros(one.segment.volume.shape, kind_for(numbers)))
        layers[index][box][inside] = number
        places.append((index, number))
    return Layered(tuple(layers), tuple(places))


def overlap_of(segments: Sequence[SceneSegment]) -> tuple[str, str] | None:
    """Returns the names of the first two segments that share voxels; None where none do."""
    taken = np.zeros(segments[0].segment.volume.shape, np.uint8)
    for number, one in enumerate(segments, 1):
        box, inside = _part(one)
        if below := int(taken[box][inside].max(initial=0)):
            return segments[below - 1].name, one.name
        taken[box][inside] = number
    return None


def _part(one: SceneSegment) -> tuple[tuple[slice, ...], NDArray[np.bool_]]:
    """Returns the box of a segment that is not empty, and which of its voxels belong to it."""
    bounds = one.segment.bounding_box
    assert bounds is not None  # noqa: S101  # empty ones are left out
    box = tuple(slice(low, past) for low, past in zip(*bounds, strict=True))[::-1]
    return box, one.segment.mask()[box] != 0
