"""What scissors are to cut out of the scan or of a segment: it is shown before it goes."""

from __future__ import annotations

import numpy as np

from palpate import protocol
from palpate.base.errors import OptionError
from palpate.base.progress import Progress
from palpate.segmentation.mask_shape import Mask
from palpate.segmentation.scissors import Loop, in_loop, near_surface
from palpate.segmentation.segment_steps import ShapeStep
from palpate.segmentation.table import skin_value
from palpate.segmentation.voxel_set import VoxelSet
from palpate.server.messages.going_part import GoingPart
from palpate.server.messages.segment_list import SegmentList
from palpate.session.appearance import UNMOVED
from palpate.session.session import Session
from palpate.volumes.volume import Volume

__all__ = ["show_scissors"]


def show_scissors(
    wanted: protocol.ShowScissors, going: GoingPart, progress: Progress
) -> protocol.Scissors:
    """Shows what would be cut out, in the place of what was shown before.

    Raises:
        OptionError: The loop is not valid, or the segment is locked or was moved.
    """
    going.hide()
    session, segments = going.session, going.segments
    loop = Loop(line=np.array(wanted.line), eye=wanted.eye, view=wanted.view)
    if wanted.id is None:
        volume = session.scene.volume
        matter = session.threshold(skin_value(volume), volume.range[1]).mask() != 0
        surface = matter if wanted.depth is None else _shown_surface(session, segments, matter)
        taken = _taken(wanted, volume, loop, surface=surface)
        part = volume.segment(taken, name="Cut out of the scan")
        goes = taken & matter

        def remove() -> None:
            session.remove_from_scan(part)

    else:
        before = session.segment(wanted.id, name=segments.name_of(wanted.id))
        _check(session, wanted.id, before.name)
        volume = before.volume
        matter = before.mask() != 0
        goes = matter & _taken(wanted, volume, loop, surface=matter)
        step = ShapeStep(kind="subtract", other=VoxelSet.of(goes), other_name="what was cut out")
        segment_id = wanted.id

        def remove() -> None:
            going.change_shape(segment_id, step, before=before)

    progress("showing what is cut out", None)
    if not goes.any():
        return protocol.Scissors(preview=None, goes_ml=0.0)
    shown = volume.segment(goes, name="Cut out")
    if wanted.id is not None and before.has_own_grid:
        shown = shown.as_object()
    ml = float(np.count_nonzero(goes)) * volume.voxel_volume / 1000.0
    return protocol.Scissors(preview=going.show(shown, remove), goes_ml=ml)


def _taken(wanted: protocol.ShowScissors, volume: Volume, loop: Loop, *, surface: Mask) -> Mask:
    inside = in_loop(volume, loop)
    taken = ~inside if wanted.outside else inside
    if wanted.depth is None:
        return taken
    return taken & near_surface(volume, loop, surface, depth=wanted.depth)


def _shown_surface(session: Session, segments: SegmentList, matter: Mask) -> Mask:
    """Returns all shown segments that stand as in the scan; without any, all that is no air."""
    shown = [
        session.segment(state["id"]).mask() != 0
        for state in session.segments()
        if segments.is_shown(state["id"])
        and state["grid"] is None
        and state["voxels"] > 0
        and (state["pose"] is None or state["pose"] == UNMOVED)
    ]
    return np.any(shown, axis=0) if shown else matter


def _check(session: Session, segment_id: int, name: str) -> None:
    state = next(each for each in session.segments() if each["id"] == segment_id)
    if state["locked"]:
        raise OptionError(f"{name} is locked; allowed: to unlock it")
    if state["pose"] is not None and state["pose"] != UNMOVED:
        raise OptionError(f"{name} was moved; allowed: one that stands as in the scan")
