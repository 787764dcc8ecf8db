"""Stored values of a scan with the edits that a session reports.

Arrays are [z, y, x], boxes count voxels along x, y, z.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["EditedValues"]

Corner = tuple[int, int, int]


class EditedValues:
    """Stored values of a scan, updated with each box of ``Session.picture_changes``."""

    def __init__(self, values: NDArray[np.int16]) -> None:
        """Starts with the values of the scan, which are not changed."""
        self.values = values
        """Shape [z, y, x]; a copy as soon as an edit has changed some."""
        self._copied = False

    def write(self, low: Corner, high: Corner, stored: bytes) -> None:
        """Writes a box from ``low`` up to, but without, ``high``: int16, x fastest."""
        if not self._copied:
            self.values, self._copied = self.values.copy(), True
        (x, y, z), (to_x, to_y, to_z) = low, high
        shape = (to_z - z, to_y - y, to_x - x)
        self.values[z:to_z, y:to_y, x:to_x] = np.frombuffer(stored, "<i2").reshape(shape)
