"""A segment: the set of voxels of a scan that belong to one structure.

Frames: see ``volumes/volume.py``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate.base.volume_text import volume_text

if TYPE_CHECKING:
    from palpate import _core
    from palpate.volumes.terminology import Terminology
    from palpate.volumes.volume import Volume

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
            name: Name to display.
            volume: The scan.
            range: Threshold (low, high) that selects exactly these voxels, or None.
            made_by: Threshold that made it, where edits have changed it since.
        """
        self._internal = internal
        self.name = name
        self.volume = volume
        self.range = range
        self.made_by = made_by or range
        self.terminology: Terminology | None = None
        """What it is, in standard codes; None where no file states it."""
        self.warnings: tuple[str, ...] = ()
        """Sentences on what its grid could not express of how it was made."""
        self.number: int | None = None
        """Its label in the file that it was read from, which export keeps; None without one."""

    def __repr__(self) -> str:
        return f"<Segment {self.name!r}: {self.voxel_count} voxels, {self.volume_text}>"

    @property
    def voxel_count(self) -> int:
        """Number of voxels."""
        return self._internal.voxel_count

    @property
    def volume_ml(self) -> float:
        """Volume of its voxels [ml]."""
        return self.voxel_count * self.volume.voxel_volume / 1000.0

    @property
    def volume_text(self) -> str:
        """Volume of its voxels for people: small ones in mm³, others in ml."""
        return volume_text(self.voxel_count * self.volume.voxel_volume)

    @property
    def bounding_box(self) -> tuple[tuple[int, int, int], tuple[int, int, int]] | None:
        """Lowest voxel and one past the highest on each axis, (x, y, z); None where it is empty."""
        return self._internal.bounding_box

    @property
    def memory_bytes(self) -> int:
        """Memory that its voxels take [bytes]."""
        return self._internal.memory_bytes

    @property
    def has_own_grid(self) -> bool:
        """Whether it has a grid of its own, that of ``volume``, instead of a scan's."""
        return self._internal.own_grid is not None

    def as_object(self) -> Segment:
        """Returns the same voxels on a grid of their own, that of ``volume``.

        Such a segment fits into any scene, whatever the voxels of its scan: a plate 1 mm thick
        feels 1 mm thick also in a scan with slices of 2 mm.
        """
        volume = self.volume
        direction = tuple(float(cosine) for cosine in volume.direction.ravel())
        internal = self._internal.on_grid(volume.spacing, volume.origin, direction)
        return Segment(internal, name=self.name, volume=volume, range=None)

    def part_of(self, volume: Volume, *, name: str) -> Segment:
        """Returns the same voxels as a segment of another scan on the same grid."""
        return Segment(self._internal, name=name, volume=volume, range=None)

    def mask(self) -> NDArray[np.uint8]:
        """Returns its mask: 1 for its voxels, else 0, shape [depth, height, width]."""
        return self._internal.mask()

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Tests which points lie in its voxels.

        Args:
            points: In the patient, LPS [mm], shape [count, 3].

        Returns:
            Shape [count].
        """
        in_patient = np.atleast_2d(np.asarray(points, dtype=np.float64))
        grid_from_patient = np.linalg.inv(self.volume.patient_from_grid)
        in_grid = in_patient @ grid_from_patient[:3, :3].T + grid_from_patient[:3, 3]
        return self._internal.contains(np.ascontiguousarray(in_grid))
