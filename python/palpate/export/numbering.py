"""Numbers and names of segments in files: those that they came with, as far as a format can.

Source of the limits: DICOM PS3.3 C.8.20.2 (segment numbers) and PS3.5 6.2 (LO, 64 characters).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from palpate.base.counted import listed
from palpate.volumes.scene import SceneSegment

__all__ = ["LONGEST_NAME", "MOST_NUMBER", "kind_for", "numbers_of", "unique_names"]

MOST_NUMBER = 2**31 - 1
"""Highest label of a file that holds integers of 32 bits."""
LONGEST_NAME = 64
"""Characters of a name in DICOM."""


def numbers_of(
    segments: Sequence[SceneSegment], *, most: int = MOST_NUMBER
) -> tuple[list[int], list[str]]:
    """Returns a number for each segment, and what is to be said of numbers that changed.

    A segment keeps the number that it was read with, from 1 to ``most`` and if no other has it;
    the rest get the lowest ones that are free.
    """
    kept: dict[int, int] = {}
    for place, one in enumerate(segments):
        number = one.segment.number
        if number is not None and 1 <= number <= most:
            kept.setdefault(number, place)
    of_place = {place: number for number, place in kept.items()}
    free = (number for number in range(1, len(segments) + len(kept) + 1) if number not in kept)
    numbers = [
        of_place[place] if place in of_place else next(free) for place in range(len(segments))
    ]
    return numbers, changed_numbers(segments, numbers)


def changed_numbers(segments: Sequence[SceneSegment], numbers: Sequence[int]) -> list[str]:
    """Says which segments are written under another number than they were read with."""
    changed = [
        f"{one.name} {one.segment.number} -> {number}"
        for one, number in zip(segments, numbers, strict=True)
        if one.segment.number not in (None, number)
    ]
    return [f"label numbers change: {listed(changed)}"] if changed else []


def unique_names(segments: Sequence[SceneSegment]) -> tuple[list[str], list[str]]:
    """Returns names of at most 64 characters, no two the same, and what is to be said of them."""
    short = [one.name[:LONGEST_NAME] for one in segments]
    names: list[str] = []
    for name in short:
        unique, copy = name, 1
        while unique in names or (copy > 1 and unique in short):
            copy += 1
            ending = f" ({copy})"
            unique = name[: LONGEST_NAME - len(ending)] + ending
        names.append(unique)
    changed = [
        f"{one.name!r} as {name!r}"
        for one, name in zip(segments, names, strict=True)
        if one.name != name
    ]
    if not changed:
        return names, []
    return names, [f"names are made different within {LONGEST_NAME} characters: {listed(changed)}"]


def kind_for(numbers: Sequence[int]) -> type[np.generic[Any]]:
    """Returns the narrowest type of voxels that holds numbers of segments."""
    highest = max(numbers, default=0)
    return np.uint8 if highest < 1 << 8 else np.uint16 if highest < 1 << 16 else np.int32
