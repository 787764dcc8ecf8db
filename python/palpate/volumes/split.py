"""A part of a scan in finer voxels: each is split into equal ones of its own value."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from palpate.volumes.volume import Volume

__all__ = ["split_around"]

Mask = NDArray[np.bool_]


def split_around(
    volume: Volume, mask: Mask, point: NDArray[np.float64], *, reach: float, size: float
) -> tuple[Volume, Mask]:
    """Returns a box around a point, and a mask in it, whose voxels are no longer than a size.

    Args:
        volume: The scan.
        mask: A mask of its shape.
        point: The middle of the box in the patient [mm].
        reach: From there to each side, as far as the scan goes [mm].
        size: Longest edge of a voxel [mm]; axes with shorter ones stay as they are.
    """
    spacing = np.array(volume.spacing)
    grid = (np.linalg.inv(volume.patient_from_grid) @ np.append(point, 1.0))[:3]
    low = np.maximum(np.floor(grid - reach / spacing), 0.0).astype(int)
    high = np.minimum(np.ceil(grid + reach / spacing).astype(int), volume.shape[::-1])
    count = np.maximum(1, np.ceil(spacing / size - 1e-6).astype(int))
    part = tuple(slice(first, last) for first, last in zip(low[::-1], high[::-1], strict=True))

    def split(values: NDArray[np.generic]) -> NDArray[np.generic]:
        for axis, times in enumerate(count[::-1]):
            values = values.repeat(int(times), axis=axis)
        return values

    finer = spacing / count
    # the corner of the box, and from there half a finer voxel
    first = volume.direction @ (low * spacing - 0.5 * spacing + 0.5 * finer)
    small = Volume(
        split(volume.array[part]),
        spacing=finer.tolist(),
        origin=(np.array(volume.origin) + first).tolist(),
        direction=volume.direction,
        slope=volume.slope,
        intercept=volume.intercept,
        traits=volume.traits,
    )
    return small, np.asarray(split(mask[part]), dtype=bool)
