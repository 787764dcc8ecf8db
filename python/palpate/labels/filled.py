"""What contours of a structure enclose in a scan, and what of them is not as it was drawn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Filled"]


@dataclass(frozen=True, kw_only=True)
class Filled:
    """A structure in the voxels of a scan."""

    mask: NDArray[np.uint8]
    """1 for the voxels of it, shape as the scan's."""
    cut: float = 0.0
    """Share of it that lies outside the scan, 0..1."""
    bridged: int = 0
    """Planes within it that have no contour, and take a shape between their neighbours'."""
    left: int = 0
    """Planes within it that have no contour, and are left empty."""
