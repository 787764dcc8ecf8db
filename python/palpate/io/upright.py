"""Scans whose axes are no right angles: turned a little, laid on a right grid, or refused.

Registration and a tilted gantry leave sheared axes in headers. Rounding leaves nearly right
ones, which are made right about the middle of the scan.

Frame: LPS [mm]; arrays are [z, y, x].
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import VolumeFormatError
from palpate.base.progress import Progress
from palpate.io.dicom.geometry import Stack, grid_of
from palpate.io.dicom.resample import resample
from palpate.io.raw_scan import RawScan, check_shape

__all__ = ["squared", "upright"]

EXACT = 1e-5
"""Angles off by less are right ones as single precision writes them [rad]."""
NEARLY = 1.1e-3
"""Angles off by less are right ones as headers of three digits write them [rad]."""


def upright(what: str, scan: RawScan, *, max_voxels: int, progress: Progress) -> RawScan:
    """Returns a scan with perpendicular axes.

    Raises:
        VolumeFormatError: Rows and columns are sheared, or the right grid has too many voxels.
    """
    scan = squared(scan)
    angles = _angles(scan)
    if np.abs(angles).max() <= NEARLY:
        return scan
    if abs(float(angles[0, 1])) > NEARLY:
        raise VolumeFormatError(
            f"{what} has sheared axes: the angle of its rows and columns is "
            f"{np.degrees(np.arccos(angles[0, 1])):.2f} degrees; allowed: perpendicular axes, so "
            "resample it first"
        )
    return _resampled(what, scan, max_voxels=max_voxels, progress=progress)


def _angles(scan: RawScan) -> NDArray[np.float64]:
    """Returns how far axes are from right angles, shape [3, 3] [rad]."""
    off: NDArray[np.float64] = scan.direction.T @ scan.direction - np.eye(3)
    return off


def squared(scan: RawScan) -> RawScan:
    """Makes nearly right axes right ones; the middle of the scan stays where it is."""
    off = float(np.abs(_angles(scan)).max())
    if not off <= NEARLY:
        return scan
    left, _, right = np.linalg.svd(scan.direction)
    nearest: NDArray[np.float64] = left @ right
    if off <= EXACT:
        return replace(scan, direction=nearest)
    middle = (np.array(scan.values.shape[::-1]) - 1) / 2.0 * scan.spacing
    x, y, z = np.array(scan.origin) + (scan.direction - nearest) @ middle
    return replace(
        scan,
        origin=(float(x), float(y), float(z)),
        direction=nearest,
        warnings=[*scan.warnings, _perpendicular(off)],
    )


def _perpendicular(off: float) -> str:
    return f"axes off by up to {off:.2g} rad from right angles were made perpendicular"


def _resampled(what: str, scan: RawScan, *, max_voxels: int, progress: Progress) -> RawScan:
    """Lays slices that are shifted along one another on a right grid."""
    across, down, along = scan.direction.T
    normal = np.cross(across, down)
    normal /= np.linalg.norm(normal)
    # a stack rises along the normal of its slices
    rising = float(along @ normal) > 0.0
    values = scan.values if rising else scan.values[::-1]
    steps = np.arange(len(values))[:: 1 if rising else -1]
    stack = Stack(
        order=tuple(range(len(values))),
        pixel=scan.spacing[:2],
        axes=np.stack([across, np.cross(normal, across), normal], axis=1),
        positions=np.array(scan.origin) + np.outer(steps * scan.spacing[2], along),
    )
    rows, columns = values.shape[1:]
    grid = grid_of(what, stack, columns=columns, rows=rows)
    check_shape(what, grid.size, max_voxels)
    air = float(np.nanmin(values))
    told = grid.told or (_perpendicular(float(abs(along @ across) + abs(along @ down))),)
    return replace(
        scan,
        values=resample(values, stack, grid, air=air, progress=progress),
        spacing=grid.spacing,
        origin=grid.origin,
        direction=grid.direction,
        # values between those of the file are no multiples of its steps
        file_scale=None,
        warnings=[*scan.warnings, *told],
    )
