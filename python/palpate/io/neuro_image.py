"""FreeSurfer MGH, MINC 1, Philips PAR/REC and AFNI BRIK/HEAD by nibabel.

Frame: nibabel gives RAS; here it becomes LPS [mm].
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import VolumeFormatError
from palpate.base.nibabel import nibabel
from palpate.base.progress import Progress
from palpate.io.nifti_file import LPS_FROM_RAS, checked
from palpate.io.packed_file import unpacked_file
from palpate.io.raw_scan import RawScan, kind_of
from palpate.io.stored_image import Place, StoredImage

__all__ = ["NeuroImage", "open_mgh"]

MGH_START = 284
"""Bytes before the voxels."""
CLASSES = {"minc": "Minc1Image", "parrec": "PARRECImage", "afni": "AFNIImage"}


def open_mgh(path: Path) -> StoredImage:
    """Reads the header of a FreeSurfer file.

    Raises:
        VolumeFormatError: It is none, or tells a size, numbers or a place that cannot be.
    """
    kind = nibabel().MGHImage.header_class
    with unpacked_file(path) as file:
        block = file.read(MGH_START)
    try:
        # nibabel lays an image without a place of its own as FreeSurfer does
        header = kind(block[: kind.template_dtype.itemsize], check=True)
        size = tuple(int(length) for length in header.get_data_shape())
        number = np.dtype(header.get_data_dtype())
        affine = LPS_FROM_RAS @ header.get_affine()
    except Exception as error:  # noqa: BLE001  # a header of any bytes
        raise _unreadable(path, "FreeSurfer", error) from None
    if min(size) < 1:
        raise VolumeFormatError(f"{path} has the size {size}; allowed: 1 or more along each axis")
    known = bool(np.frombuffer(block[28:30], ">i2")[0])
    checked(path, affine)
    return StoredImage(
        path=path,
        voxels=path,
        size=size,
        number=number,
        start=MGH_START,
        scale=None,
        place=Place(affine=affine, known=known),
    )


class NeuroImage:
    """An image file as nibabel reads it; see ``palpate.io.open_image.OpenImage``."""

    def __init__(self, path: Path, format_name: str) -> None:
        """Reads the header.

        Raises:
            VolumeFormatError: It is none, or tells a place that cannot be.
        """
        self.path = path
        try:
            self.image = getattr(nibabel(), CLASSES[format_name]).from_filename(str(path))
            self.size = tuple(int(length) for length in self.image.shape)
            affine = LPS_FROM_RAS @ self.image.affine
        except Exception as error:  # noqa: BLE001  # nibabel raises whatever a header leads to
            raise _unreadable(path, format_name, error) from None
        checked(path, affine)
        self.place = Place(affine=affine)
        self.spacing: tuple[float, ...] = self.place.spacing
        self.kind = kind_of(np.dtype(self.image.get_data_dtype()))

    def check(self) -> None:
        """Every number of these formats is an intensity."""

    def scan(self, frame: int, progress: Progress) -> RawScan:
        """Reads one of its volumes, counted from 0."""
        volume = math.prod(self.size[:3]) * 2 / 2**20
        progress(f"reading {self.path.name}, {volume:.0f} MiB", None)
        values = np.ascontiguousarray(self._part(frame, slice(None)).T)
        return self.place.scan(values, self.path)

    def middle(self, frame: int) -> NDArray[Any]:
        """Returns the values of a volume's middle slice along z, shape [y, x]."""
        return self._part(frame, self.size[2] // 2).T

    def _part(self, frame: int, depth: slice | int) -> NDArray[Any]:
        beyond = np.unravel_index(frame, self.size[3:], order="F")
        try:
            values: NDArray[Any] = np.asanyarray(
                self.image.dataobj[(slice(None), slice(None), depth, *map(int, beyond))]
            )
        except FileNotFoundError as error:
            name = Path(str(error.filename)).name
            raise VolumeFormatError(
                f"{self.path} names {name} as the file of its voxels, which does not exist; "
                "allowed: both files in one folder"
            ) from None
        except Exception as error:  # noqa: BLE001  # nibabel raises whatever voxels lead to
            raise VolumeFormatError(
                f"{self.path} cannot be read ({_line(error)}); allowed: complete, undamaged files"
            ) from None
        return values


def _unreadable(path: Path, format_name: str, error: Exception) -> VolumeFormatError:
    return VolumeFormatError(
        f"{path} is no readable {format_name} file ({_line(error)}); allowed: complete, undamaged "
        "files"
    )


def _line(error: Exception) -> str:
    return " ".join(str(error).split())[:200] or type(error).__name__
