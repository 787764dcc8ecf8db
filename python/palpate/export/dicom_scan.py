"""A scan with its edits as a new DICOM series, derived from the one that was read.

Each slice takes the headers of the file that shows its place, or of the nearest one, with new
UIDs, its own place and values, and a reference to what it was made from.

Frame: LPS [mm]. Source: DICOM PS3.3, C.7.6.1 (image type, derivation), C.7.6.2 (image plane).
"""

from __future__ import annotations

import copy
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from palpate.base.errors import OptionError
from palpate.base.package_version import package_version
from palpate.export.dicom_object import (
    MAKER,
    coded,
    header_told,
    new_object,
    now,
    reference_to,
    series_number,
)
from palpate.export.dicom_source import IMAGE_CLASSES, SECONDARY, DicomSource
from palpate.io.dicom.dose import RTDOSE
from palpate.io.dicom.suv import unit_tags
from palpate.volumes.terminology import Code
from palpate.volumes.volume import Volume

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

__all__ = ["make_series"]

SOURCE_PURPOSE = Code("121322", "DCM", "Source image for image processing operation")
MODIFIER_PURPOSE = Code("109103", "DCM", "Modifying Equipment")

OUTDATED = (
    "PixelPaddingValue", "PixelPaddingRangeLimit", "SmallestImagePixelValue", "SliceLocation",
    "LargestImagePixelValue", "SmallestPixelValueInSeries", "LargestPixelValueInSeries",
    "SmallestValidPixelValue", "LargestValidPixelValue", "ModalityLUTSequence", "IconImageSequence",
    "FloatPixelPaddingValue", "RedPaletteColorLookupTableDescriptor", "OriginalAttributesSequence",
    "ReferencedImageSequence", "DigitalSignaturesSequence", "GantryDetectorTilt",
    "DerivationCodeSequence",
)  # fmt: skip
"""What the source's files say of their own pixels and places."""
OF_IMAGES = ("KVP", "WindowCenter", "WindowWidth", "BodyPartExamined", "PatientPosition")
"""What slices keep of a file with several."""


def make_series(volume: Volume, source: DicomSource) -> Iterator[Dataset]:
    """Yields the slices of a scan as objects of one new series.

    Args:
        volume: The scan with its edits.
        source: The files that it was read from.

    Raises:
        OptionError: The headers of the scan's files do not allow it.
    """
    from pydicom.uid import generate_uid

    if volume.modality == RTDOSE:
        raise OptionError(
            "a changed dose is none of a plan, and DICOM has no other kind for it; allowed: NIfTI, "
            "NRRD or MetaImage"
        )
    series, moment = generate_uid(), now()
    for number in range(volume.shape[0]):
        with header_told("a derived series"):
            shown_by, image = _nearest(source, number)
            made = _headers_of(image, source)
            made.SOPInstanceUID, made.SeriesInstanceUID = generate_uid(), series
            made.SeriesNumber, made.InstanceNumber = series_number(source, 4), number + 1
            made.InstanceCreationDate, made.InstanceCreationTime = moment
            _tell_origin(made, image, shown_by)
            _lay(made, volume, number)
            _fill(made, volume, number)
            yield made


def _nearest(source: DicomSource, number: int) -> tuple[int | None, Dataset]:
    """Returns the frame and image that show a slice, or else the nearest slice that has one."""
    there = [index for index, shown_by in enumerate(source.slices) if shown_by is not None]
    if not there:
        return None, source.first
    nearest = min(there, key=lambda index: abs(index - number))
    found = source.slices[nearest]
    assert found is not None  # noqa: S101  # only those are listed
    return found.frame, found.image


def _headers_of(image: Dataset, source: DicomSource) -> Dataset:
    """Returns the headers of one slice, from a file with one or several."""
    if int(image.get("NumberOfFrames") or 1) == 1 and "SharedFunctionalGroupsSequence" not in image:
        made = copy.deepcopy(image)
        made.remove_private_tags()
        for name in OUTDATED:
            if name in made:
                del made[name]
        return made
    modality = str(image.get("Modality") or "OT")
    made = new_object(source, IMAGE_CLASSES.get(modality, SECONDARY), modality=modality, series=4)
    for name in OF_IMAGES:
        if name in image:
            made.add(copy.deepcopy(image[name]))
    return made


def _tell_origin(made: Dataset, image: Dataset, frame: int | None) -> None:
    from pydicom.dataset import Dataset

    kind = list(image.get("ImageType") or [])[2:3]
    made.ImageType = ["DERIVED", "SECONDARY", *kind]
    made.DerivationDescription = f"Changed by {MAKER}: matter taken away or moved"
    reference = reference_to(image, frame)
    reference.PurposeOfReferenceCodeSequence = [coded(SOURCE_PURPOSE)]
    made.SourceImageSequence = [reference]
    made.SeriesDescription = f"{str(image.get('SeriesDescription') or '')[:54]} edited".strip()
    equipment = Dataset()
    equipment.PurposeOfReferenceCodeSequence = [coded(MODIFIER_PURPOSE)]
    equipment.Manufacturer = equipment.ManufacturerModelName = MAKER
    equipment.SoftwareVersions = package_version()
    made.ContributingEquipmentSequence = [
        *(made.get("ContributingEquipmentSequence") or []),
        equipment,
    ]


def _lay(made: Dataset, volume: Volume, number: int) -> None:
    """Tells where a slice lies."""
    x, y, z = volume.spacing
    place = np.asarray(volume.origin) + volume.direction[:, 2] * z * number
    made.ImagePositionPatient = [_decimal(part) for part in place]
    made.ImageOrientationPatient = [_decimal(part) for part in volume.direction[:, :2].T.ravel()]
    made.PixelSpacing = [_decimal(y), _decimal(x)]
    made.SpacingBetweenSlices = _decimal(z)
    made.SliceThickness = made.get("SliceThickness") or _decimal(z)


def _fill(made: Dataset, volume: Volume, number: int) -> None:
    """Tells the values of a slice."""
    from pydicom.dataset import FileMetaDataset
    from pydicom.uid import ExplicitVRLittleEndian

    made.file_meta = FileMetaDataset()
    made.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
    depth, made.Rows, made.Columns = volume.shape
    assert 0 <= number < depth  # noqa: S101
    made.SamplesPerPixel, made.PhotometricInterpretation = 1, "MONOCHROME2"
    made.BitsAllocated, made.BitsStored, made.HighBit = 16, 16, 15
    made.PixelRepresentation = 1
    made.RescaleSlope, made.RescaleIntercept = _decimal(volume.slope), _decimal(volume.intercept)
    made.RescaleType = volume.unit or "US"
    _tell_unit(made, volume.unit)
    made.PixelData = volume.array[number].astype("<i2", copy=False).tobytes()
    made["PixelData"].VR = "OW"


def _tell_unit(made: Dataset, unit: str) -> None:
    """Tells the unit of PET, whose values may be SUV by now."""
    found = unit_tags(unit)
    if made.get("Modality") != "PT" or found is None:
        return
    made.Units = found[0]
    if found[1]:
        made.SUVType = found[1]


def _decimal(number: float) -> str:
    """Returns a number in the 16 characters that DICOM allows."""
    digits = (f"{number:.{count}g}" for count in range(16, 0, -1))
    return next(text for text in digits if len(text) <= 16)
