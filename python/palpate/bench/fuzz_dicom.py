"""Small DICOM files for ``palpate bench fuzz-import``: of each kind that is read in its own way.

All have fixed UIDs and times, so that they are the same to the bit on every run, and lie on one
grid: 6 columns and 5 rows of 2 mm, 3 slices of 3 mm, LPS.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pydicom.dataset import Dataset, FileDataset

__all__ = ["dicom_folders", "segments_of_ct"]

COLUMNS, ROWS, SLICES = 6, 5, 3
SPACING = [2.0, 2.0]
THICKNESS = 3.0
ORIENTATION = [1, 0, 0, 0, 1, 0]
ROOT = "1.2.826.0.1.3680043.8.498."
"""Of pydicom's examples, with a number behind it."""
STUDY, FRAME = ROOT + "1", ROOT + "2"
STORAGE = "1.2.840.10008.5.1.4.1.1."
CT, MULTIFRAME_MR, PET, ENHANCED_PET, DOSE, SEG, STRUCTURES = (
    STORAGE + kind for kind in ("2", "4.1", "128", "130", "481.2", "66.4", "481.3")
)
DAY = "20140618"


def dicom_folders(made: Path) -> dict[str, list[Path]]:
    """Writes scans that are more than a file per slice of CT or MR; returns the files of each."""
    return {
        "pet": _pet(made / "pet"),
        "enhanced-pet": [_enhanced_pet(made / "enhanced-pet")],
        "dose": [_dose(made / "dose")],
        "concatenation": _concatenation(made / "concatenation"),
    }


def segments_of_ct(made: Path) -> tuple[Path, list[Path]]:
    """Writes a CT; returns its folder, and files with segments of it (SEG, RTSTRUCT)."""
    return _ct(made / "of-ct"), [_seg(made), _structures(made)]


# --- scans --------------------------------------------------------------------------------


def _ct(folder: Path) -> Path:
    for number in range(SLICES):
        dataset = _image(CT, "CT", 100 + number)
        _place(dataset, number)
        dataset.RescaleSlope, dataset.RescaleIntercept, dataset.RescaleType = 1, -1024, "HU"
        _save(dataset, folder / f"{number}.dcm")
    return folder


def _pet(folder: Path) -> list[Path]:
    files = []
    for number in range(SLICES):
        dataset = _image(PET, "PT", 200 + number)
        _place(dataset, number)
        dataset.RescaleSlope, dataset.RescaleIntercept = 2.5 + number, 0
        dataset.Units, dataset.DecayCorrection = "BQML", "START"
        dataset.CorrectedImage = ["ATTN", "DECY"]
        dataset.FrameReferenceTime, dataset.ActualFrameDuration = "89858", "180000"
        dataset.SeriesDate = dataset.AcquisitionDate = DAY
        dataset.SeriesTime = dataset.AcquisitionTime = "102031"
        dataset.PatientWeight = "74"
        dataset.RadiopharmaceuticalInformationSequence = [_pharmaceutical()]
        files.append(_save(dataset, folder / f"{number}.dcm"))
    return files


def _enhanced_pet(folder: Path) -> Path:
    dataset = _image(ENHANCED_PET, "PT", 300, frames=range(SLICES))
    _group_frames(dataset, range(SLICES))
    shared = dataset.SharedFunctionalGroupsSequence[0]
    transformation = _item(RescaleSlope=2.5, RescaleIntercept=0, RescaleType="US")
    shared.PixelValueTransformationSequence = [transformation]
    dataset.AcquisitionDateTime = DAY + "102031"
    dataset.DecayCorrected = dataset.AttenuationCorrected = "YES"
    dataset.DecayCorrectionDateTime = DAY + "102031"
    dataset.PatientWeight = "74"
    dataset.RadiopharmaceuticalInformationSequence = [_pharmaceutical()]
    unit = _item(CodeValue="Bq/ml", CodingSchemeDesignator="UCUM", CodeMeaning="Bq/ml")
    mapping = _item(
        RealWorldValueFirstValueMapped=0, RealWorldValueLastValueMapped=65535,
        RealWorldValueSlope=2.5, RealWorldValueIntercept=0.0,
        MeasurementUnitsCodeSequence=[unit],
    )  # fmt: skip
    shared.RealWorldValueMappingSequence = [mapping]
    return _save(dataset, folder / "0.dcm")


def _dose(folder: Path) -> Path:
    dataset = _image(DOSE, "RTDOSE", 400, frames=range(SLICES))
    _place(dataset, 0)
    dataset.GridFrameOffsetVector = [THICKNESS * number for number in range(SLICES)]
    dataset.DoseUnits, dataset.DoseType, dataset.DoseSummationType = "GY", "PHYSICAL", "PLAN"
    dataset.DoseGridScaling = 0.001
    return _save(dataset, folder / "0.dcm")


def _concatenation(folder: Path) -> list[Path]:
    files = []
    for number, frames in enumerate((range(2), range(2, SLICES)), 1):
        dataset = _image(MULTIFRAME_MR, "MR", 500 + number, frames=frames)
        _group_frames(dataset, frames)
        dataset.ConcatenationUID = ROOT + "51"
        dataset.SOPInstanceUIDOfConcatenationSource = ROOT + "52"
        dataset.InConcatenationNumber, dataset.InConcatenationTotalNumber = number, 2
        dataset.ConcatenationFrameOffsetNumber = frames.start
        files.append(_save(dataset, folder / f"{number}.dcm"))
    return files


# --- segments -----------------------------------------------------------------------------


def _seg(folder: Path) -> Path:
    dataset = _image(SEG, "SEG", 600, frames=range(2 * SLICES))
    dataset.SegmentationType, dataset.BitsAllocated, dataset.BitsStored = "BINARY", 1, 1
    dataset.HighBit = 0
    code = _item(CodeValue="T-D0050", CodingSchemeDesignator="SRT", CodeMeaning="Tissue")
    dataset.SegmentSequence = [
        _item(
            SegmentNumber=number, SegmentLabel=name, SegmentAlgorithmType="MANUAL",
            RecommendedDisplayCIELabValue=[30000, 40000, 20000],
            SegmentedPropertyCategoryCodeSequence=[code], SegmentedPropertyTypeCodeSequence=[code],
        )
        for number, name in ((1, "left"), (2, "right"))
    ]  # fmt: skip
    _group_frames(dataset, [*range(SLICES), *range(SLICES)])
    for index, group in enumerate(dataset.PerFrameFunctionalGroupsSequence):
        named = _item(ReferencedSegmentNumber=1 + index // SLICES)
        group.SegmentIdentificationSequence = [named]
    masks = np.zeros((2, SLICES, ROWS, COLUMNS), np.uint8)
    masks[0, :, 1:4, :3], masks[1, :, 1:4, 3:] = 1, 1
    packed = np.packbits(masks.ravel(), bitorder="little").tobytes()
    dataset.PixelData = packed + b"\0" * (len(packed) % 2)
    return _save(dataset, folder / "seg.dcm")


def _structures(folder: Path) -> Path:
    dataset = _dataset(STRUCTURES, "RTSTRUCT", 700)
    dataset.StructureSetLabel = "made"
    dataset.StructureSetROISequence = [
        _item(ROINumber=number, ROIName=name, ReferencedFrameOfReferenceUID=FRAME)
        for number, name in ((1, "left"), (2, "right"))
    ]
    dataset.ROIContourSequence = [
        _item(
            ReferencedROINumber=number,
            ROIDisplayColor=[255, 0, 10 * number],
            ContourSequence=[_square(left, k) for k in range(SLICES)],
        )
        for number, left in ((1, -1.0), (2, 5.0))
    ]
    return _save(dataset, folder / "structures.dcm")


def _square(left: float, number: int) -> Dataset:
    corners = [(left, 1.0), (left + 6.0, 1.0), (left + 6.0, 7.0), (left, 7.0)]
    points = [value for x, y in corners for value in (x, y, THICKNESS * number)]
    return _item(ContourGeometricType="CLOSED_PLANAR", NumberOfContourPoints=4, ContourData=points)


# --- parts of them ------------------------------------------------------------------------


def _dataset(kind: str, modality: str, number: int) -> FileDataset:
    """Returns an object; those with the same hundreds of their number are one series."""
    from pydicom.dataset import FileDataset, FileMetaDataset
    from pydicom.uid import UID, ExplicitVRLittleEndian

    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = UID(kind)
    meta.MediaStorageSOPInstanceUID = UID(f"{ROOT}{number}")
    meta.TransferSyntaxUID = ExplicitVRLittleEndian
    dataset = FileDataset("", {}, file_meta=meta, preamble=b"\0" * 128)
    dataset.SOPClassUID, dataset.SOPInstanceUID = kind, meta.MediaStorageSOPInstanceUID
    dataset.Modality, dataset.SeriesInstanceUID = modality, f"{ROOT}9{number // 100}"
    dataset.StudyInstanceUID, dataset.FrameOfReferenceUID = STUDY, FRAME
    dataset.PatientID, dataset.InstanceNumber = "made", number % 100 + 1
    return dataset


def _image(
    kind: str, modality: str, number: int, *, frames: Sequence[int] | None = None
) -> FileDataset:
    """Returns an image of 16 bits, of some frames or of one slice."""
    dataset = _dataset(kind, modality, number)
    dataset.Rows, dataset.Columns, dataset.SamplesPerPixel = ROWS, COLUMNS, 1
    dataset.PhotometricInterpretation, dataset.PixelRepresentation = "MONOCHROME2", 0
    dataset.BitsAllocated, dataset.BitsStored, dataset.HighBit = 16, 16, 15
    if frames is not None:
        dataset.NumberOfFrames = len(frames)
    count = 1 if frames is None else len(frames)
    values = number + np.arange(count * ROWS * COLUMNS, dtype="<u2")
    dataset.PixelData = values.tobytes()
    return dataset


def _place(dataset: Dataset, number: int) -> None:
    dataset.ImagePositionPatient = [0.0, 0.0, THICKNESS * number]
    dataset.ImageOrientationPatient, dataset.PixelSpacing = ORIENTATION, SPACING
    dataset.SliceThickness = THICKNESS


def _group_frames(dataset: Dataset, slices: Sequence[int]) -> None:
    """Adds functional groups that say where frames lie (PS3.3, C.7.6.16)."""
    shared = _item(
        PixelMeasuresSequence=[_item(PixelSpacing=SPACING, SliceThickness=THICKNESS)],
        PlaneOrientationSequence=[_item(ImageOrientationPatient=ORIENTATION)],
    )
    dataset.SharedFunctionalGroupsSequence = [shared]
    dataset.PerFrameFunctionalGroupsSequence = [
        _item(
            FrameContentSequence=[_item(StackID="1", InStackPositionNumber=number + 1)],
            PlanePositionSequence=[_item(ImagePositionPatient=[0.0, 0.0, THICKNESS * number])],
        )
        for number in slices
    ]


def _pharmaceutical() -> Dataset:
    return _item(
        RadionuclideTotalDose="370000000", RadionuclideHalfLife="6586.2",
        RadiopharmaceuticalStartTime="083045", RadiopharmaceuticalStartDateTime=DAY + "083045",
    )  # fmt: skip


def _item(**elements: object) -> Dataset:
    from pydicom.dataset import Dataset

    made = Dataset()
    for name, value in elements.items():
        setattr(made, name, value)
    return made


def _save(dataset: FileDataset, path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    dataset.save_as(path, enforce_file_format=True)
    return path
