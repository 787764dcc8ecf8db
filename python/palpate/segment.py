"""A part of a scan: the set of voxels that can be shown and touched.

Frames: see ``volume.py``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from palpate import _core
    from palpate.volume import Volume

__all__ = ["Segment"]


class Segment:
    """Voxels of a scan under a name; made by ``Volume.threshold`` or ``Volume.segment``."""

    def __init__(
        self,
        internal: _core.Segment,
        *,
        name: str,
        volume: Volume,
        range: tuple[float, float] | None,  # noqa: A002  # as the protocol calls it
        made_by: tuple[float, float] | None = None,
    ) -> None:
        """Wraps the engine's segment.

        Args:
            internal: The engine's voxels.
            name: What a person calls it.
            volume: The scan it is a part of.
            range: The threshold (low, high) that it is, or None.
            made_by: The threshold that made it, where edits have changed it since.
        """
        self._internal = internal
        self.name = name
        self.volume = volume
        self.range = range
        self.made_by = made_by or range

    def __repr__(self) -> str:
        return f"<Segment {self.name!r}: {self.voxel_count} voxels, {self.volume_ml:.1f} ml>"

    @property
    def voxel_count(self) -> int:
        """How many voxels it has."""
        return self._internal.voxel_count

    @property
    def volume_ml(self) -> float:
        """How much space its voxels take [ml]."""
        return self.voxel_count * self.volume.voxel_volume / 1000.0

    @property
    def bounding_box(self) -> tuple[tuple[int, int, int], tuple[int, int, int]] | None:
        """Lowest voxel and one past the highest on each axis, (x, y, z); None if empty."""
        return self._internal.bounding_box

    @property
    def memory_bytes(self) -> int:
        """Memory that its bricks take."""
        return self._internal.memory_bytes

    def part_of(self, volume: Volume, *, name: str) -> Segment:
        """Returns the same voxels as a part of another scan on the same grid."""
        return Segment(self._internal, name=name, volume=volume, range=None)

    def mask(self) -> NDArray[np.uint8]:
        """Returns 1 where a voxel belongs to it, else 0, shape [depth, height, width]."""
        return self._internal.mask()

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Says which points lie in its voxels.

        Args:
            points: In the patient [mm], shape [count, 3].
        """
        in_patient = np.atleast_2d(np.asarray(points, dtype=np.float64))
        grid_from_patient = np.linalg.inv(self.volume.patient_from_grid)
        in_grid = in_patient @ grid_from_patient[:3, :3].T + grid_from_patient[:3, 3]
        return self._internal.contains(np.ascontiguousarray(in_grid))
