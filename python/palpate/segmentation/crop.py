"""What lies outside of a box along the axes of a scan."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from palpate.base.errors import OptionError
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume

__all__ = ["outside"]


def outside(volume: Volume, low: Sequence[float], high: Sequence[float]) -> Segment:
    """Returns the voxels whose centre lies outside of a box.

    Args:
        volume: The scan.
        low: How far the box begins from the low faces of the scan, along its x, y, z [mm].
        high: How far it ends from the high ones.

    Raises:
        OptionError: All of the scan lies in the box, or nothing of it does.
    """
    inside = np.ones(volume.shape, bool)
    axes = zip(volume.dimensions, volume.spacing, low, high, strict=True)
    for axis, (count, side, from_low, from_high) in enumerate(axes):
        centres = (np.arange(count) + 0.5) * side
        kept = (centres >= from_low) & (centres <= count * side - from_high)
        inside &= kept.reshape([-1 if 2 - each == axis else 1 for each in range(3)])
    if inside.all():
        raise OptionError("the box holds all of the scan; allowed: a box that leaves something out")
    if not inside.any():
        raise OptionError("the box holds no voxel of the scan; allowed: a larger box")
    return volume.segment(~inside, name="outside of the box")
