"""DICOM objects of segments, read in a worker: all of one, or its numbers of pixels."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from palpate.base.reader_process import apart
from palpate.io.dicom.header import damage_told
from palpate.io.dicom.mark import read_dataset
from palpate.io.dicom.pixels import stored_pixels
from palpate.io.dicom.promises import check_deflated

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

__all__ = ["dataset_of", "pixels_of"]


def dataset_of(path: Path) -> Dataset:
    """Returns what a DICOM file says, without its pixels.

    Raises:
        VolumeFormatError: It is damaged.
    """
    return apart(_dataset_of, path, path=path)


def pixels_of(path: Path, *, shape: tuple[int, ...]) -> NDArray[Any]:
    """Returns the numbers of a DICOM file as they are stored.

    Raises:
        VolumeFormatError: They cannot be decoded, or are not as many as announced.
    """
    return apart(stored_pixels, path, shape=shape, path=path)


def _dataset_of(path: Path) -> Dataset:
    with damage_told(path):
        check_deflated(path)
        return read_dataset(path, stop_before_pixels=True)
