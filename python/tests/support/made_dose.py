"""Doses (RTDOSE) that tests write for themselves."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from pydicom.dataset import FileDataset, FileMetaDataset
from pydicom.uid import ExplicitVRLittleEndian, RTDoseStorage, generate_uid


def write_dose(
    path: Path,
    gray: Any,
    *,
    position: tuple[float, float, float] = (-10.0, -20.0, 30.0),
    orientation: tuple[float, ...] = (1, 0, 0, 0, 1, 0),
    offsets: list[float] | None = None,
    scaling: float = 0.001,
    **changes: Any,
) -> Path:
    """Writes a dose of 2 mm columns and 3 mm rows; planes are 2.5 mm apart. None takes a tag out.

    Args:
        path: The new file.
        gray: Doses [Gy], shape [planes, rows, columns].
        position: Centre of the first pixel.
        orientation: Of rows and columns.
        offsets: Of the planes; the default is from 0 on.
        scaling: Gy of a stored 1.
        changes: Other tags.
    """
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID, meta.TransferSyntaxUID = RTDoseStorage, ExplicitVRLittleEndian
    meta.MediaStorageSOPInstanceUID = generate_uid()
    dataset = FileDataset("", {}, file_meta=meta, preamble=b"\0" * 128)
    dataset.SOPClassUID, dataset.SOPInstanceUID = RTDoseStorage, meta.MediaStorageSOPInstanceUID
    dataset.Modality, dataset.SeriesInstanceUID = "RTDOSE", generate_uid()
    planes, dataset.Rows, dataset.Columns = np.shape(gray)
    dataset.NumberOfFrames, dataset.SamplesPerPixel = planes, 1
    dataset.PhotometricInterpretation, dataset.PixelRepresentation = "MONOCHROME2", 0
    dataset.BitsAllocated, dataset.BitsStored, dataset.HighBit = 32, 32, 31
    dataset.PixelSpacing = [3.0, 2.0]
    dataset.ImagePositionPatient = list(position)
    dataset.ImageOrientationPatient = list(orientation)
    dataset.GridFrameOffsetVector = offsets or [2.5 * k for k in range(planes)]
    dataset.DoseUnits, dataset.DoseType, dataset.DoseSummationType = "GY", "PHYSICAL", "PLAN"
    dataset.DoseGridScaling = scaling
    dataset.PixelData = np.rint(np.asarray(gray) / scaling).astype("<u4").tobytes()
    dataset["PixelData"].VR = "OW"
    for name, value in changes.items():
        if value is None:
            delattr(dataset, name)
        else:
            setattr(dataset, name, value)
    path.parent.mkdir(parents=True, exist_ok=True)
    dataset.save_as(path, enforce_file_format=True)
    return path
