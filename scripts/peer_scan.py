"""Writes a scan as the DICOM series of a study, so that an archive takes it and lists it."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import palpate
import pydicom
import SimpleITK as sitk  # noqa: N813
from palpate.bench.opening import write_series
from pydicom.uid import generate_uid

WINDOW = {"WindowCenter": 40, "WindowWidth": 400}
"""For soft tissue, as scanners write one [HU]."""


def write_study(scan: Path, folder: Path) -> list[Path]:
    """Writes a CT scan, as many slices as it has; returns their files.

    Rows run toward the patient's left and columns to the back, as in files of scanners.
    """
    with TemporaryDirectory() as made:
        turned = Path(made) / "scan.nii.gz"
        sitk.WriteImage(sitk.DICOMOrient(sitk.ReadImage(str(scan)), "LPS"), str(turned))
        volume = palpate.read(turned)
    folder.mkdir()
    write_series(volume, folder, slices=len(volume.array))
    files = sorted(folder.iterdir())
    study = {"StudyInstanceUID": generate_uid(), "StudyDate": "20000101", "StudyTime": "120000"}
    about = {"PatientName": folder.name, "PatientID": folder.name, "SeriesDescription": "CT"}
    for file in files:
        dataset = pydicom.dcmread(file)
        for name, value in {**study, **about, **WINDOW, "StudyID": "1", "SeriesNumber": 1}.items():
            setattr(dataset, name, value)
        dataset.save_as(file, enforce_file_format=True)
    return files
