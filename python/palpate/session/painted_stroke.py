"""A stroke of the brush in slices, or what an outline encloses: one step of undo when it is done.

Each piece of its way becomes edits of boxes of voxels, so that picture, surfaces and touch follow
as they follow the tools in the hand, by the same admission.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from palpate.base.errors import OptionError
from palpate.segmentation.brush import Box, Brush, Point, boxes_of, covered
from palpate.segmentation.mask_shape import Mask
from palpate.session.session import Session
from palpate.volumes.polygon_fill import fill_polygons
from palpate.volumes.scan_slice import ScanSlice

__all__ = ["PaintedStroke"]


class PaintedStroke:
    """Paints voxels of a segment, or takes them away, until it is finished or cancelled."""

    def __init__(self, session: Session, segment_id: int, *, erases: bool = False) -> None:
        """Begins a stroke.

        Raises:
            OptionError: There is no such segment, or it does not stand where the scan has it.
        """
        segment = session.segment(segment_id)
        pose = {state["id"]: state["pose"] for state in session.segments()}.get(segment_id)
        moved = pose is not None and not np.array_equal(np.reshape(pose, (4, 4)), np.eye(4))
        if segment.has_own_grid or moved:
            raise OptionError(
                f"segment {segment_id} does not stand where the scan has it; allowed: segments of "
                "the scan that were not moved"
            )
        self._session = session
        self._volume = session.scene.volume
        self.segment_id = segment_id
        self.erases = erases
        self._mask: Mask = segment.mask().astype(bool)
        self._counts = [segment.voxel_count]

    @property
    def changed(self) -> int:
        """How many voxels it has changed."""
        return abs(self._counts[-1] - self._counts[0])

    def along(self, brush: Brush, points: Sequence[Point]) -> None:
        """Goes from the first point over the others [scene].

        Raises:
            OptionError: A number of the brush is out of range, or the segment is gone.
        """
        brush.check()
        ways = pairwise(points) if len(points) > 1 else [(points[0], points[0])] if points else []
        for ends in ways:
            self._cover(brush, ends)

    def inside(
        self,
        outline: Sequence[Point],
        *,
        normal: Sequence[float],
        values: tuple[float, float] | None = None,
    ) -> None:
        """Covers the voxels of a slice whose middles an outline encloses.

        Args:
            outline: Corners [scene]; the first one says which slice. The last is joined to it.
            normal: Of the slice, along an axis of the scan.
            values: Only voxels with such values are changed [unit of the scan]; None is all.

        Raises:
            OptionError: There are fewer than three corners, or the slice lies along no axis.
        """
        if len(outline) < 3:
            raise OptionError(f"{len(outline)} corners given; allowed: three or more")
        where = ScanSlice.through(self._volume, outline[0], normal=normal)
        filled = fill_polygons([where.places(outline)], where.shape).astype(bool)
        if values is not None:
            filled &= (where.values >= values[0]) & (where.values <= values[1])
        self._take(where.box, np.expand_dims(filled, 2 - where.axis))

    def finish(self) -> None:
        """Makes one step of undo of what was changed."""
        self._session.group_steps(self.segment_id, self._counts)
        self._counts = self._counts[-1:]

    def cancel(self) -> None:
        """Takes back what was changed."""
        if len(self._counts) > 1:
            self.finish()
            self._session.undo()

    def _cover(self, brush: Brush, ends: tuple[Point, Point]) -> None:
        self._take(*covered(self._volume, brush, ends))

    def _take(self, box: Box, mask: Mask) -> None:
        """Changes those voxels of a part of the scan that are not as they shall be."""
        part = self._mask[box]
        new = mask & (part if self.erases else ~part)
        corner = np.array([side.start for side in reversed(box)])
        for low, high in boxes_of(new):
            first, last = ((int(x), int(y), int(z)) for x, y, z in (corner + low, corner + high))
            self._session.fill_box(self.segment_id, low=first, high=last, solid=not self.erases)
            voxels = int(np.prod(np.subtract(high, low)))
            self._counts.append(self._counts[-1] + (-voxels if self.erases else voxels))
        part[new] = not self.erases
