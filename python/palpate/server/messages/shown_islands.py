"""Islands of a segment of which some are to go: they are counted, and shown before they do.

An island is a part that hangs together over faces of voxels.
"""

from __future__ import annotations

import numpy as np

from palpate import protocol
from palpate.base.errors import OptionError
from palpate.base.progress import Progress
from palpate.segmentation.lengths_in_voxels import least_voxels
from palpate.segmentation.mask_shape import island_numbers
from palpate.segmentation.segment_steps import ShapeStep
from palpate.server.messages.going_part import GoingPart

__all__ = ["show_islands"]

MOST_TOLD = 20
"""Volumes that are told."""


def show_islands(
    wanted: protocol.ShowIslands, going: GoingPart, progress: Progress
) -> protocol.Islands:
    """Shows which islands would go, in the place of what was shown before.

    Raises:
        OptionError: All of them would go, or the segment is locked.
    """
    going.hide()
    session, segments = going.session, going.segments
    before = session.segment(wanted.id, name=segments.name_of(wanted.id))
    state = next(each for each in session.segments() if each["id"] == wanted.id)
    if state["locked"]:
        raise OptionError(f"{before.name} is locked; allowed: to unlock it")
    volume = before.volume
    numbers, sizes = island_numbers(before.mask() != 0)
    progress(f"parting {before.name}", None)
    least = least_voxels(wanted.least_ml, volume.voxel_volume)
    stays = min(wanted.most, int(np.count_nonzero(sizes >= least)))
    if stays == 0:
        raise OptionError(
            f"nothing would be left of {before.name}; allowed: a smaller volume than that of its "
            "largest island"
        )
    preview = None
    if stays < len(sizes):
        goes = volume.segment(numbers > stays, name=f"Goes of {before.name}")
        if before.has_own_grid:
            goes = goes.as_object()
        preview = going.show(
            goes,
            lambda: going.change_shape(wanted.id, _step(wanted, stays), before=before),
            pose=state["pose"],
        )
    volumes = sizes * volume.voxel_volume / 1000.0
    return protocol.Islands(
        id=wanted.id,
        preview=preview,
        count=len(sizes),
        stays=stays,
        goes_ml=float(volumes[stays:].sum()),
        largest_ml=[float(each) for each in volumes[:MOST_TOLD]],
    )


def _step(wanted: protocol.ShowIslands, stays: int) -> ShapeStep:
    """Returns the change of shape that leaves as many islands as are to stay."""
    if stays == wanted.most:
        return ShapeStep(kind="keep-largest", amount=stays)
    return ShapeStep(kind="drop-small", amount=wanted.least_ml)
