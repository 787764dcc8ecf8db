"""FreeSurfer MGH, MINC 1, Philips PAR/REC and AFNI BRIK/HEAD by nibabel.

Frame: nibabel gives RAS; here it becomes LPS [mm].
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
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
CLASSES = {
    "minc": ("minc1", "Minc1Image"), "parrec": ("parrec", "PARRECImage"),
    "afni": ("brikhead", "AFNIImage"),
}  # fmt: skip
"""Each format's module and class in nibabel."""


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
        self.format_name = format_name
        with self._image() as image:
            self.axes = _axes(image, format_name)
            self.size = tuple(int(image.shape[axis]) for axis in self.axes)
            self.kind = kind_of(np.dtype(image.get_data_dtype()))
            affine = LPS_FROM_RAS @ image.affine
        checked(path, affine)
        self.place = Place(affine=affine)
        self.spacing: tuple[float, ...] = self.place.spacing

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
        # time may stand before the axes of space
        beyond = (int(one) for one in np.unravel_index(frame, self.size[3:], order="F"))
        wanted = dict(zip(self.axes, (slice(None), slice(None), depth, *beyond), strict=True))
        with self._image() as image:
            values: NDArray[Any] = np.asanyarray(
                image.dataobj[tuple(wanted[axis] for axis in range(len(wanted)))]
            )
        return values

    @contextmanager
    def _image(self) -> Iterator[Any]:
        """Opens the file with nibabel, which raises whatever its bytes lead to."""
        module, kind = CLASSES[self.format_name]
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                image = getattr(getattr(nibabel(), module), kind).from_filename(str(self.path))
                try:
                    yield image
                finally:
                    # Philips' voxels are left open
                    if self.format_name == "parrec":
                        image.dataobj.file_like.close()
        except Exception as error:  # noqa: BLE001
            raise _unreadable(self.path, self.format_name, error) from None


def _axes(image: Any, format_name: str) -> tuple[int, ...]:  # noqa: ANN401  # nibabel's
    """Returns which axes of a file's array are those of space, and then all others."""
    names = image.dataobj.minc_file._dim_names if format_name == "minc" else ()  # noqa: SLF001
    space = [axis for axis, name in enumerate(names) if name.endswith("space")] or [0, 1, 2]
    return (*space, *(axis for axis in range(len(image.shape)) if axis not in space))


def _unreadable(path: Path, format_name: str, error: Exception) -> VolumeFormatError:
    if isinstance(error, FileNotFoundError):
        return VolumeFormatError(
            f"{path} names {Path(str(error.filename)).name} as the file of its voxels, which does "
            "not exist; allowed: both files in one folder"
        )
    reason = " ".join(str(error).split())[:200] or type(error).__name__
    return VolumeFormatError(
        f"{path} is no readable {format_name} file ({reason}); allowed: complete, undamaged files"
    )
