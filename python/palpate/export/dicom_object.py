"""New DICOM objects of a study: what all of them say, and how they are written.

Source: DICOM PS3.3, C.7 (patient, study, series, equipment), C.12.1 (SOP common).
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from palpate.base.errors import OptionError, PalpateError
from palpate.base.package_version import package_version
from palpate.export.dicom_source import ELSEWHERE, NEEDED, DicomSource
from palpate.volumes.terminology import Code

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

__all__ = ["MAKER", "coded", "header_told", "new_object", "reference_to", "save_dicom"]

MAKER = "Palpate"
OF_STUDY = (
    *NEEDED, "StudyInstanceUID", "StudyDescription", "PatientAge", "PatientSize", "PatientWeight",
    "FrameOfReferenceUID", "PositionReferenceIndicator",
)  # fmt: skip
"""What objects of one study have in common."""
UTF_8 = "ISO_IR 192"


def new_object(source: DicomSource, sop_class: str, *, modality: str, series: int) -> Dataset:
    """Returns an object in a series of its own, in the study of the scan.

    Args:
        source: The scan's files.
        sop_class: UID of its kind.
        modality: As DICOM names it.
        series: Which of the series that are made from this scan, from 1.
    """
    from pydicom.dataset import Dataset
    from pydicom.uid import generate_uid

    made = Dataset()
    made.SpecificCharacterSet = UTF_8
    for name in OF_STUDY:
        if name in source.first:
            made.add(source.first[name])
    if "PositionReferenceIndicator" not in made:
        # there, if empty (type 2), wherever a frame of reference is
        made.PositionReferenceIndicator = ""
    made.SOPClassUID, made.SOPInstanceUID = sop_class, generate_uid()
    made.SeriesInstanceUID, made.Modality = generate_uid(), modality
    made.SeriesNumber, made.InstanceNumber = series_number(source, series), 1
    made.Manufacturer = made.ManufacturerModelName = MAKER
    made.SoftwareVersions = package_version()
    made.InstanceCreationDate, made.InstanceCreationTime = now()
    return made


def now() -> tuple[str, str]:
    """Returns date and time as DICOM writes them."""
    moment = datetime.now().astimezone()
    return moment.strftime("%Y%m%d"), moment.strftime("%H%M%S")


def series_number(source: DicomSource, series: int) -> int:
    """Returns a number for a series that is made from a scan."""
    return int(source.first.get("SeriesNumber") or 0) * 100 % 100_000 + series


def reference_to(image: Dataset, frame: int | None = None) -> Dataset:
    """Returns an item that refers to an image, or to one of its frames."""
    from pydicom.dataset import Dataset

    item = Dataset()
    item.ReferencedSOPClassUID = image.SOPClassUID
    item.ReferencedSOPInstanceUID = image.SOPInstanceUID
    if frame is not None:
        item.ReferencedFrameNumber = frame
    return item


def coded(code: Code) -> Dataset:
    """Returns a code as an item of a sequence."""
    from pydicom.dataset import Dataset

    item = Dataset()
    item.CodeValue, item.CodingSchemeDesignator = code.value, code.scheme
    item.CodeMeaning = code.meaning[:64]
    return item


@contextmanager
def header_told(what: str) -> Iterator[None]:
    """Tells what libraries dislike about a scan's headers as one kind of error.

    Raises:
        OptionError: The headers do not allow what is to be made.
    """
    try:
        with warnings.catch_warnings():
            # sloppy values are copied as they are
            warnings.simplefilter("ignore")
            yield
    except (PalpateError, OSError):
        raise
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        why = str(error).strip().splitlines()[0].rstrip(".") if str(error).strip() else "unusual"
        raise OptionError(
            f"the headers of the scan's files do not allow {what} ({why}); {ELSEWHERE}"
        ) from None


def save_dicom(dataset: Dataset, path: Path) -> None:
    """Writes an object with a file header of our own, uncompressed unless it says otherwise.

    Raises:
        OSError: The disk refuses it.
    """
    from pydicom.dataset import FileMetaDataset
    from pydicom.uid import PYDICOM_IMPLEMENTATION_UID, ExplicitVRLittleEndian

    before = getattr(dataset, "file_meta", None)
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = dataset.SOPClassUID
    meta.MediaStorageSOPInstanceUID = dataset.SOPInstanceUID
    meta.TransferSyntaxUID = getattr(before, "TransferSyntaxUID", ExplicitVRLittleEndian)
    meta.ImplementationClassUID = PYDICOM_IMPLEMENTATION_UID
    meta.ImplementationVersionName = f"PALPATE {package_version()}"[:16]
    dataset.file_meta, dataset.preamble = meta, b"\0" * 128
    with header_told("a DICOM file"):
        dataset.save_as(path, enforce_file_format=True)
