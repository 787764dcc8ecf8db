"""The picture as pages have been told it: what a page that has missed changes is told anew.

Arrays are [z, y, x], boxes count voxels along x, y, z.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate import protocol
from palpate.server.changes import messages_of
from palpate.server.outbox import Box
from palpate.session.edited_values import EditedValues
from palpate.session.picture_change import PictureChange, SurfaceChange

__all__ = ["ToldPicture", "labels_anew", "voxel_slabs"]

MOST_VOXELS = 1 << 21
"""In one message; a single slice of more still goes out whole."""


class ToldPicture:
    """The scan's values with all edits that pages were told, and which surfaces they know."""

    def __init__(self, values: NDArray[np.int16]) -> None:
        """Begins with the values of the scan, which stay as they are."""
        self._edited = EditedValues(values)
        self._surfaces: set[int] = set()
        self._displaced = False
        self.edit = 0
        """The newest edit."""

    @property
    def values(self) -> NDArray[np.int16]:
        """Shape [z, y, x]; a copy once an edit has changed some."""
        return self._edited.values

    def take(self, changed: protocol.Changed) -> None:
        """Follows a change that pages are told."""
        self.edit = max(self.edit, changed.edit)
        self._surfaces.update(surface.id for surface in changed.surfaces)
        self._displaced |= changed.displaced is not None
        for box in changed.voxels:
            if box.stored is not None:
                self._edited.write(box.low, box.high, box.stored)

    def surfaces_anew(self, whole: PictureChange, *, edit: int) -> Iterator[protocol.Changed]:
        """Yields all surfaces of ``Session.whole_surfaces``, and where matter stands beside voxels.

        Surfaces that are gone are forgotten.
        """
        there = {surface["id"] for surface in whole["surfaces"]}
        self._surfaces |= there
        gone: list[SurfaceChange] = [
            {"id": segment_id, "whole": True, "dropped": [], "patches": []}
            for segment_id in sorted(self._surfaces - there)
        ]
        if there or gone or self._displaced:
            surfaces = [*whole["surfaces"], *gone]
            yield from messages_of({**whole, "edit": edit, "surfaces": surfaces})

    def values_anew(self, box: Box, *, edit: int) -> Iterator[protocol.Changed]:
        """Yields the values of a box."""
        for low, high, packed in voxel_slabs(box, self.values.astype("<i2", copy=False)):
            slab = protocol.ChangedVoxels(low, high, stored=packed, labels=None)
            yield protocol.Changed(edit=edit, applied=None, voxels=[slab], surfaces=[])


def labels_anew(box: Box, labels: NDArray[np.uint8], *, edit: int) -> Iterator[protocol.Changed]:
    """Yields a box of labels, shape [z, y, x]."""
    for low, high, packed in voxel_slabs(box, labels):
        slab = protocol.ChangedVoxels(low, high, stored=None, labels=packed)
        yield protocol.Changed(edit=edit, applied=None, voxels=[slab], surfaces=[])


def voxel_slabs(
    box: Box, array: NDArray[Any]
) -> Iterator[tuple[protocol.GridPlace, protocol.GridPlace, bytes]]:
    """Yields a box of an array in slabs of some slices: low, high, and the voxels, x fastest."""
    if box.is_empty:
        return
    (x, y, z), (to_x, to_y, to_z) = box.low, box.high
    slices = max(1, MOST_VOXELS // ((to_x - x) * (to_y - y)))
    for first in range(z, to_z, slices):
        last = min(first + slices, to_z)
        yield (x, y, first), (to_x, to_y, last), array[first:last, y:to_y, x:to_x].tobytes()
