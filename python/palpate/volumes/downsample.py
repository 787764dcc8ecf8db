"""Downsampling of scans and masks to larger voxels.

A voxel gets the mean of those it replaces; in a mask it is set where most of them are.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from palpate.volumes.volume import Volume, VolumeTraits

__all__ = ["merged"]

Mask = NDArray[np.bool_]


def merged(
    volume: Volume, masks: Mapping[str, Mask], *, size: float
) -> tuple[Volume, dict[str, Mask]]:
    """Merges voxels along each axis until they are about as large as requested.

    Voxels at the upper ends that do not fill a larger voxel are dropped.

    Args:
        volume: The scan.
        masks: Masks by name, of the shape of the scan.
        size: Edge of the new voxels [mm]; axes with voxels as long as that stay as they are.
    """
    count = np.maximum(1, np.floor(size / np.array(volume.spacing[::-1]) + 0.5).astype(int))
    if (count == 1).all():
        return volume, dict(masks)
    shape = np.maximum(1, np.array(volume.shape) // count)
    count = np.minimum(count, np.array(volume.shape))

    def mean(values: NDArray[np.float32]) -> NDArray[np.float32]:
        low, row, column = (slice(int(n)) for n in shape * count)
        parts = np.stack([shape, count], axis=1).ravel().tolist()
        return np.asarray(values[low, row, column].reshape(parts).mean(axis=(1, 3, 5)))

    spacing = np.array(volume.spacing)
    larger = spacing * count[::-1]
    kept = volume.exact is None
    larger_volume = Volume(
        np.rint(mean(volume.array.astype(np.float32))).astype(np.int16)
        if kept
        else mean(volume.values().astype(np.float32)),
        spacing=larger.tolist(),
        origin=(np.array(volume.origin) + volume.direction @ ((larger - spacing) / 2)).tolist(),
        direction=volume.direction,
        slope=volume.slope if kept else 1.0,
        intercept=volume.intercept if kept else 0.0,
        traits=VolumeTraits(
            name=volume.name,
            modality=volume.modality,
            unit=volume.unit,
            warnings=volume.traits.warnings,
            notes=volume.traits.notes,
            orientation_known=volume.traits.orientation_known,
        ),
    )
    return larger_volume, {
        name: mean(mask.astype(np.float32)) >= 0.5 for name, mask in masks.items()
    }
