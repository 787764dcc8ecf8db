"""Scans that tests write for themselves."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume, VolumeTraits
from pydicom.dataset import FileDataset, FileMetaDataset
from pydicom.uid import CTImageStorage, ExplicitVRLittleEndian, generate_uid


def series_writer(place: Path) -> Callable[..., Path]:
    """Returns what writes series into folders of a place."""

    def write(
        folder: str = "series",
        *,
        positions: list[tuple[float, float, float]] | None = None,
        orientation: tuple[float, ...] = (1, 0, 0, 0, 1, 0),
        uid: str | None = None,
        description: str = "abdomen",
        scale: tuple[float, float] = (1.0, -1024.0),
        prefix: str = "",
        each: Callable[[int, FileDataset], None] | None = None,
        **changes: Any,
    ) -> Path:
        target = place / folder
        target.mkdir(exist_ok=True)
        series = generate_uid() if uid is None else uid
        places = positions or [(-10.0, -20.0, 30.0 + 2.5 * k) for k in range(4)]
        for number, position in enumerate(places):
            dataset = _slice(number, position, orientation, series)
            dataset.SeriesDescription = description
            dataset.RescaleSlope, dataset.RescaleIntercept = scale
            for name, value in changes.items():
                setattr(dataset, name, value)
            if each is not None:
                each(number, dataset)
            # names in another order than places, and without an ending
            dataset.save_as(target / f"{prefix}{97 * number % 101:03}", enforce_file_format=True)
        return target

    return write


def _slice(
    number: int, position: tuple[float, ...], orientation: tuple[float, ...], series: str
) -> FileDataset:
    """Returns a slice of 3 rows and 4 columns whose values are 100 times its number and up."""
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = CTImageStorage
    meta.MediaStorageSOPInstanceUID = generate_uid()
    meta.TransferSyntaxUID = ExplicitVRLittleEndian
    dataset = FileDataset("", {}, file_meta=meta, preamble=b"\0" * 128)
    dataset.SOPClassUID, dataset.SOPInstanceUID = CTImageStorage, meta.MediaStorageSOPInstanceUID
    dataset.Modality, dataset.SeriesInstanceUID = "CT", series
    dataset.Rows, dataset.Columns, dataset.SamplesPerPixel = 3, 4, 1
    dataset.PhotometricInterpretation = "MONOCHROME2"
    dataset.BitsAllocated, dataset.BitsStored, dataset.HighBit = 16, 16, 15
    dataset.PixelRepresentation = 0
    dataset.PixelSpacing = [0.5, 0.75]
    dataset.ImagePositionPatient = list(position)
    dataset.ImageOrientationPatient = list(orientation)
    dataset.PixelData = (100 * number + np.arange(12, dtype="<u2")).tobytes()
    return dataset


def make_ball() -> Scene:
    z, y, x = np.mgrid[0:41, 0:41, 0:41] - 20.0
    values = np.where(x * x + y * y + z * z <= 64.0, 100, -1000).astype(np.int16)
    traits = VolumeTraits(name="ball", modality="CT", unit="HU")
    volume = Volume(values, spacing=(1.0, 1.0, 1.0), traits=traits)
    return Scene(volume, [volume.threshold(0.0, name="ball")])
