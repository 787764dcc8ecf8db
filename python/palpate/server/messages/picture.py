"""Messages on the picture: changes of voxels and surfaces, and those that a page has missed.

Arrays are [z, y, x], boxes count voxels along x, y, z.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from palpate import protocol
from palpate.server.messages.outbox import Box, Outbox
from palpate.server.messages.table import MessageTable, Runs
from palpate.session.edited_values import EditedValues
from palpate.session.picture_change import PictureChange, SurfaceChange
from palpate.session.session import Session

__all__ = ["EditPace", "PublishedPicture", "change_messages", "label_messages", "voxel_slabs"]

MOST_BYTES = 4 << 20
"""Bytes of the patches in one message; a single larger patch still goes out whole."""

MOST_VOXELS = 1 << 21
"""Voxels in one message; a single slice of more still goes out whole."""


class PublishedPicture:
    """The scan's values with all edits that were published, and which surfaces pages know."""

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
        """Follows a change that is published."""
        self.edit = max(self.edit, changed.edit)
        self._surfaces.update(surface.id for surface in changed.surfaces)
        self._displaced |= changed.displaced is not None
        for box in changed.voxels:
            if box.stored is not None:
                self._edited.write(box.low, box.high, box.stored)

    def surface_messages(self, whole: PictureChange, *, edit: int) -> Iterator[protocol.Changed]:
        """Yields all of ``Session.whole_surfaces``: surfaces, and displacements of soft tissue.

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
            yield from change_messages({**whole, "edit": edit, "surfaces": surfaces})

    def value_messages(self, box: Box, *, edit: int) -> Iterator[protocol.Changed]:
        """Yields the values of a box."""
        for low, high, packed in voxel_slabs(box, self.values.astype("<i2", copy=False)):
            slab = protocol.ChangedVoxels(low, high, stored=packed, labels=None)
            yield protocol.Changed(edit=edit, applied=None, voxels=[slab], surfaces=[])


class EditPace:
    """How often surfaces follow edits: as often as the slowest page can show it."""

    def __init__(self, session: Session) -> None:
        """Begins with the pace of the engine."""
        self._session = session
        self._paces: dict[Outbox, int] = {}

    def add_to(self, table: MessageTable) -> None:
        """Adds the row of the pace."""
        table.add(protocol.FollowEdits, self._follow, runs=Runs.ON_LOOP)

    def leave(self, page: Outbox) -> None:
        """Forgets the pace of a page that has gone."""
        self._paces.pop(page, None)
        self._apply()

    def _follow(self, message: protocol.FollowEdits, page: Outbox) -> None:
        self._paces[page] = message.every
        self._apply()

    def _apply(self) -> None:
        self._session.follow_edits(max(self._paces.values(), default=1))


def label_messages(box: Box, labels: NDArray[np.uint8], *, edit: int) -> Iterator[protocol.Changed]:
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


def change_messages(change: PictureChange) -> Iterator[protocol.Changed]:
    """Yields a change of ``Session.picture_changes`` as one message, or as many if it is large.

    What an edit does stays in one message up to 4 MiB of patches, so that a page shows it in one
    frame; the first extraction of a surface is larger, and there it does not matter.
    """
    changed = msgspec.convert(change, protocol.Changed)
    first, *others = _parts(changed.surfaces)
    yield msgspec.structs.replace(changed, surfaces=first)
    for surfaces in others:
        yield protocol.Changed(
            edit=changed.edit, applied=changed.applied, voxels=[], surfaces=surfaces
        )


def _parts(surfaces: list[protocol.SegmentSurface]) -> list[list[protocol.SegmentSurface]]:
    """Deals the patches of surfaces out to messages."""
    parts: list[list[protocol.SegmentSurface]] = [[]]
    room = MOST_BYTES
    for surface in surfaces:
        patches: list[protocol.SurfacePatch] = []
        piece = msgspec.structs.replace(surface, patches=patches)
        parts[-1].append(piece)
        for patch in surface.patches:
            size = len(patch.vertices) + len(patch.normals) + len(patch.triangles)
            if patches and size > room:
                patches = []
                room = MOST_BYTES
                parts.append(
                    [protocol.SegmentSurface(surface.id, whole=False, dropped=[], patches=patches)]
                )
            patches.append(patch)
            room -= size
    return parts
