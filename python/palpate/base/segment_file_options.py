"""Options of requests that read segments of a file for a scan."""

from __future__ import annotations

from typing import Annotated

from palpate.base.request import words

__all__ = ["AnotherPatient", "Resample"]

Resample = Annotated[
    bool,
    words("Resample segments of files from another grid to that of the scan (nearest neighbour)."),
]
AnotherPatient = Annotated[
    bool,
    words("Take DICOM segments of another patient, study or frame of reference as they are."),
]
