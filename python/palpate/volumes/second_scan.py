"""A second scan that is shown with the first one, and the transform between both.

Transforms are read as SimpleITK and ITK write them (``.tfm``, ``.h5``): they map points of the
first (fixed) scan to those of the second. Frames: patient of each scan, LPS [mm].
"""

from __future__ import annotations

from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError, VolumeFormatError
from palpate.base.given import path_of
from palpate.base.reader_process import apart
from palpate.base.simpleitk import Transform, reason_of, simpleitk
from palpate.volumes.resampled import resampled
from palpate.volumes.volume import Volume, VolumeTraits

__all__ = ["SecondScan", "doubts_of", "placed", "read_transform"]

LEAST_DETERMINANT = 1e-6
"""Least determinant of a transform: one that flattens more cannot be inverted."""


@dataclass(frozen=True)
class SecondScan:
    """A scan beside the first one, on its own grid; ``second_from_first`` has shape [4, 4]."""

    volume: Volume
    second_from_first: NDArray[np.float64] = field(default_factory=lambda: np.eye(4))
    before_resampling: Volume | None = None
    """The scan before it was resampled by a deformable transform; None where it was not."""
    deformable: Transform | None = field(default=None, repr=False, compare=False)
    """That transform, from points of the first scan to those of the second as it was read."""

    @property
    def transform(self) -> Transform:
        """From points of the first scan to those of the second as it was read, SimpleITK's."""
        if self.deformable is not None:
            return self.deformable
        affine: Transform = simpleitk().AffineTransform(
            self.second_from_first[:3, :3].ravel().tolist(),
            self.second_from_first[:3, 3].tolist(),
        )
        return affine

    @property
    def as_read(self) -> Volume:
        """The scan before any transform."""
        return self.volume if self.before_resampling is None else self.before_resampling

    @property
    def is_moved(self) -> bool:
        """Whether a transform places it elsewhere than its own geometry does."""
        return self.before_resampling is not None or not np.array_equal(
            self.second_from_first, np.eye(4)
        )


def placed(first: Volume, second: Volume, transform: Transform | None = None) -> SecondScan:
    """Returns a scan placed relative to the first one.

    For a rigid or affine transform, or none, the values stay as they are and a matrix places them;
    for a deformable one they are resampled on the first scan's grid, linear between voxels, and by
    the nearest voxel where they are labels.

    Args:
        first: The fixed scan.
        second: The scan to show with it.
        transform: A ``SimpleITK.Transform`` from points of the first scan to those of the second.

    Raises:
        OptionError: The transform is not three-dimensional, or has no inverse.
    """
    if transform is None:
        return SecondScan(second)
    if transform.GetDimension() != 3:
        dimension = transform.GetDimension()
        raise OptionError(f"a transform of {dimension} dimensions given; allowed: of 3")
    if transform.IsLinear():
        return SecondScan(second, _matrix_of(transform))
    there = resampled(second, first, transform)
    return SecondScan(there, before_resampling=second, deformable=transform)


def doubts_of(first: Volume, second: SecondScan) -> tuple[str, ...]:
    """Returns sentences on why a scan may not belong to the first one, or lie elsewhere in it."""
    one, other = first.traits, second.as_read.traits
    found = []
    if _patients_differ(one, other):
        found.append("its patient is not that of the first scan")
    if second.is_moved:
        return tuple(found)
    if one.frame and other.frame and one.frame != other.frame:
        found.append(
            "its frame of reference is not that of the first scan, so it may lie elsewhere until "
            "it is registered"
        )
    elif other.modality == "RTDOSE" and not (one.frame and other.frame):
        found.append("no frame of reference tells that this dose lies right in the first scan")
    return tuple(found)


def _patients_differ(one: VolumeTraits, other: VolumeTraits) -> bool:
    """Says whether two patients differ: by numbers where both have one, else by names."""
    pair = (one.patient_id, other.patient_id)
    if not all(pair):
        pair = (one.patient_name, other.patient_name)
    first, second = (told.strip(" ^").casefold() for told in pair)
    return bool(first and second) and first != second


def read_transform(path: str | PathLike[str], *, called: str | None = None) -> Transform:
    """Returns the ``SimpleITK.Transform`` in a file; errors name the file as it was ``called``.

    Raises:
        FileNotFoundError: There is no such file.
        VolumeFormatError: It is not a transform.
    """
    file = path_of(path)
    if not file.is_file():
        raise FileNotFoundError(f"no transform at {file}")
    return apart(_read_here, file, called or str(file), path=file)


def _read_here(file: Path, called: str) -> Transform:
    try:
        read: Transform = simpleitk().ReadTransform(str(file))
    except RuntimeError as error:
        raise VolumeFormatError(
            f"{called} cannot be read as a transform ({reason_of(error)}); allowed: .tfm "
            "or .h5 as SimpleITK writes it"
        ) from None
    return read


def _matrix_of(transform: Transform) -> NDArray[np.float64]:
    """Returns the matrix of a linear transform of points, shape [4, 4]."""
    origin = np.array(transform.TransformPoint((0.0, 0.0, 0.0)))
    ends = np.array([transform.TransformPoint(tuple(axis)) for axis in np.eye(3)])
    matrix = np.eye(4)
    matrix[:3, :3] = (ends - origin).T
    matrix[:3, 3] = origin
    if not np.isfinite(matrix).all() or abs(np.linalg.det(matrix)) < LEAST_DETERMINANT:
        raise OptionError("a transform that flattens the scan given; allowed: one with an inverse")
    return matrix
