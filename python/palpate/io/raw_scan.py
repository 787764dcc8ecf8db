"""A scan as a reader finds it, before its values become int16.

Frame: LPS [mm], as ITK gives it; ``origin`` is the centre of the first voxel, the columns of
``direction`` are the file's axes. Arrays are [z, y, x].
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import VolumeFormatError
from palpate.volumes.stored_values import Scale

__all__ = ["RawScan", "check_shape", "orthonormal"]


@dataclass(kw_only=True)
class RawScan:
    """Values of any real type, shape [depth, height, width], and what the file says of them."""

    values: NDArray[Any]
    spacing: tuple[float, float, float]
    origin: tuple[float, float, float]
    direction: NDArray[np.float64]
    name: str
    description: str = ""
    """What the file calls it; "" where it does not."""
    modality: str = ""
    unit: str = ""
    series: str = ""
    frame: str = ""
    """FrameOfReferenceUID, for DICOM."""
    subject: tuple[str, str, str] = ("", "", "")
    """StudyInstanceUID, PatientID and PatientName, for DICOM."""
    orientation_known: bool = True
    file_scale: Scale | None = None
    warnings: list[str] = field(default_factory=list)


def check_shape(what: str, size: tuple[int, ...], max_voxels: int) -> None:
    """Refuses what is no volume, or too big a one, by its voxels along x, y, z.

    Raises:
        VolumeFormatError: The size is not that of a three-dimensional scan.
    """
    named = " x ".join(map(str, size))
    if len([length for length in size if length > 1]) < 3:
        kind = "a 2-D image" if len(size) <= 3 else "no volume"
        raise VolumeFormatError(
            f"{what} is {kind} of {named} voxels; allowed: volumes with 2 or more voxels on each "
            "of three axes, such as a folder with all slices of a DICOM series"
        )
    if len(size) > 3 and any(length > 1 for length in size[3:]):
        raise VolumeFormatError(
            f"{what} is a {len(size)}-D image of {named} voxels; allowed: one volume, "
            "so split it by time first"
        )
    if math.prod(size) > max_voxels:
        raise VolumeFormatError(
            f"{what} has {named} = {math.prod(size)} voxels; allowed: at most {max_voxels}, "
            "or more with --max-voxels"
        )


def orthonormal(what: str, direction: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the rotation nearest to a direction; refuses axes that are not perpendicular.

    Raises:
        VolumeFormatError: The axes are sheared.
    """
    # 1e-3: header numbers written with four digits, 0.06 degrees
    off = np.abs(direction.T @ direction - np.eye(3)).max()
    if not off <= 1e-3:
        raise VolumeFormatError(
            f"{what} has axes that are not perpendicular unit vectors (they differ by {off:.2g}); "
            "allowed: scans without shear, so resample it first"
        )
    left, _, right = np.linalg.svd(direction)
    nearest: NDArray[np.float64] = left @ right
    return nearest
