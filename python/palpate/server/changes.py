"""Changes of voxels and surfaces as messages of a size that a page takes without a hitch."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec

from palpate import protocol
from palpate.session.picture_change import PictureChange

__all__ = ["messages_of"]

MOST_BYTES = 4 << 20
"""Of the patches in one message; a single larger patch still goes out whole."""


def messages_of(change: PictureChange) -> Iterator[protocol.Changed]:
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
