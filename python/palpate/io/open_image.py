"""What an image file tells before its voxels are read, whichever library reads it."""

from __future__ import annotations

from typing import Any, Protocol

from numpy.typing import NDArray

from palpate.base.progress import Progress
from palpate.io.raw_scan import RawScan

__all__ = ["OpenImage"]


class OpenImage(Protocol):
    """A file whose header was read."""

    @property
    def size(self) -> tuple[int, ...]:
        """Voxels along x, y, z and the axes beyond, such as time."""

    @property
    def spacing(self) -> tuple[float, ...]:
        """Along x, y, z [mm]."""

    @property
    def kind(self) -> str:
        """Of its numbers, such as "8-bit unsigned integer"."""

    def check(self) -> None:
        """Refuses numbers that are no intensities.

        Raises:
            VolumeFormatError: There are several in each voxel, or they are complex.
        """

    def scan(self, frame: int, progress: Progress) -> RawScan:
        """Reads one of its volumes, counted from 0; its axes may be sheared.

        Raises:
            VolumeFormatError: It is incomplete or damaged, or tells no place that can be.
        """

    def middle(self, frame: int) -> NDArray[Any]:
        """Returns the values of a volume's middle slice along z, shape [y, x].

        Raises:
            VolumeFormatError: It is incomplete or damaged.
        """
