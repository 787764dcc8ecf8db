"""A stroke of the brush in slices, or the inside of an outline, as one step of undo.

Each piece becomes edits of boxes of voxels, so that picture, surfaces and touch follow as they
follow a tool at the probe.
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
    """Adds voxels to a segment, or removes them, until it is finished or cancelled."""

    def __init__(self, session: Session, segment_id: int, *, erases: bool = False) -> None:
        """Begins a stroke.

        Raises:
            OptionError: There is no such segment, or it was moved or has a grid of its own.
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
        """Number of voxels that it has changed."""
        return abs(self._counts[-1] - self._counts[0])

    def along(self, brush: Brush, points: Sequence[Point]) -> None:
        """Moves the brush along points of the scene.

        Raises:
            OptionError: A setting of the brush is out of range, or the segment was removed.
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
        """Covers the voxels of a slice whose centres an outline encloses.

        Args:
            outline: Corners in the scene, LPS [mm]; the first one selects the slice. The outline is
                closed.
            normal: Normal of the slice, along an axis of the scan.
            values: Lowest and highest value of voxels to change [unit of the scan]; None for all.

        Raises:
            OptionError: There are fewer than three corners, or the normal is along none of the
                axes.
        """
        if len(outline) < 3:
            raise OptionError(f"{len(outline)} corners given; allowed: three or more")
        where = ScanSlice.through(self._volume, outline[0], normal=normal)
        filled = fill_polygons([where.places(outline)], where.shape).astype(bool)
        if values is not None:
            filled &= (where.values >= values[0]) & (where.values <= values[1])
        self._take(where.box, np.expand_dims(filled, 2 - where.axis))

    def finish(self) -> None:
        """Makes the changes one step of undo."""
        self._session.group_steps(self.segment_id, self._counts)
        self._counts = self._counts[-1:]

    def cancel(self) -> None:
        """Undoes the changes."""
        if len(self._counts) > 1:
            self.finish()
            self._session.undo()

    def _cover(self, brush: Brush, ends: tuple[Point, Point]) -> None:
        self._take(*covered(self._volume, brush, ends))

    def _take(self, box: Box, mask: Mask) -> None:
        """Changes the voxels of a box that are not as they should be."""
        part = self._mask[box]
        new = mask & (part if self.erases else ~part)
        corner = np.array([side.start for side in reversed(box)])
        for low, high in boxes_of(new):
            first, last = ((int(x), int(y), int(z)) for x, y, z in (corner + low, corner + high))
            self._session.fill_box(self.segment_id, low=first, high=last, solid=not self.erases)
            voxels = int(np.prod(np.subtract(high, low)))
            self._counts.append(self._counts[-1] + (-voxels if self.erases else voxels))
        part[new] = not self.erases
