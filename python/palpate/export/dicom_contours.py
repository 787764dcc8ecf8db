"""Structures of radiotherapy (RTSTRUCT): outlines of segments in the scan's slices.

An outline passes half-way between voxels in and out, where marching squares has it, so that the
middles of voxels are inside just where the segment is.

Frame: contours in LPS [mm]. Source: DICOM PS3.3, A.19, C.8.8.5 and C.8.8.6.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from palpate.export.dicom_object import coded, header_told, new_object, now, reference_to
from palpate.export.dicom_source import DicomSource, SourceSlice
from palpate.export.numbering import numbers_of, unique_names
from palpate.volumes.scene import SceneSegment
from palpate.volumes.terminology import terminology_of_name
from palpate.volumes.volume import Volume

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

__all__ = ["make_rtstruct", "outlines"]

STUDY_CLASS = "1.2.840.10008.3.1.2.3.1"
"""Detached Study Management, by which a study is referred to (retired, and still asked for)."""


def make_rtstruct(segments: Sequence[SceneSegment], volume: Volume, source: DicomSource) -> Dataset:
    """Returns an RTSTRUCT object that refers to the scan's files.

    Raises:
        OptionError: The headers of the scan's files do not allow one.
    """
    from pydicom.dataset import Dataset, FileMetaDataset
    from pydicom.uid import ImplicitVRLittleEndian, RTStructureSetStorage

    with header_told("an RTSTRUCT"):
        made = new_object(source, RTStructureSetStorage, modality="RTSTRUCT", series=3)
        # lists of numbers may be longer than explicit lengths of 16 bits
        made.file_meta = FileMetaDataset()
        made.file_meta.TransferSyntaxUID = ImplicitVRLittleEndian
        made.SeriesDescription = "Structures"
        made.StructureSetLabel, made.OperatorsName = "Structures", ""
        made.StructureSetDate, made.StructureSetTime = now()
        made.ReferencedFrameOfReferenceSequence = [_frame_of_reference(source)]
        made.StructureSetROISequence = []
        made.ROIContourSequence = []
        made.RTROIObservationsSequence = []
        numbers, names = numbers_of(segments)[0], unique_names(segments)[0]
        for number, name, one in zip(numbers, names, segments, strict=True):
            roi, contours, observed = Dataset(), Dataset(), Dataset()
            roi.ROINumber, roi.ROIName = number, name
            roi.ReferencedFrameOfReferenceUID = source.first.FrameOfReferenceUID
            roi.ROIGenerationAlgorithm = "SEMIAUTOMATIC"
            contours.ReferencedROINumber = number
            contours.ROIDisplayColor = [round(255 * part) for part in one.colour]
            contours.ContourSequence = list(_contours(one, volume, source))
            observed.ObservationNumber = observed.ReferencedROINumber = number
            observed.RTROIInterpretedType = observed.ROIInterpreter = ""
            terms = one.segment.terminology or terminology_of_name(one.name)
            observed.RTROIIdentificationCodeSequence = [coded(terms.kind)]
            made.StructureSetROISequence.append(roi)
            made.ROIContourSequence.append(contours)
            made.RTROIObservationsSequence.append(observed)
        return made


def _frame_of_reference(source: DicomSource) -> Dataset:
    from pydicom.dataset import Dataset

    frame, study, series = Dataset(), Dataset(), Dataset()
    series.SeriesInstanceUID = source.first.SeriesInstanceUID
    series.ContourImageSequence = [reference_to(image) for image in source.images]
    study.ReferencedSOPClassUID = STUDY_CLASS
    study.ReferencedSOPInstanceUID = source.first.StudyInstanceUID
    study.RTReferencedSeriesSequence = [series]
    frame.FrameOfReferenceUID = source.first.FrameOfReferenceUID
    frame.RTReferencedStudySequence = [study]
    return frame


def _contours(one: SceneSegment, volume: Volume, source: DicomSource) -> Iterator[Dataset]:
    patient_from_index = volume.direction * np.asarray(volume.spacing)
    mask = one.segment.mask()
    found = {int(number): outlines(mask[number]) for number in np.flatnonzero(mask.any((1, 2)))}
    # one kind for all contours of a structure
    has_holes = any(_has_hole(loops) for loops in found.values())
    kind = "CLOSEDPLANAR_XOR" if has_holes else "CLOSED_PLANAR"
    for number, loops in found.items():
        for loop in loops:
            corners = np.column_stack([loop, np.full(len(loop), float(number))])
            points = corners @ patient_from_index.T + volume.origin
            yield _contour(points, kind, source.slices[number])


def _contour(points: NDArray[np.float64], kind: str, shown_by: SourceSlice | None) -> Dataset:
    from pydicom.dataset import Dataset

    item = Dataset()
    if shown_by is not None:
        item.ContourImageSequence = [reference_to(shown_by.image, shown_by.frame)]
    item.ContourGeometricType = kind
    item.NumberOfContourPoints = len(points)
    # 0.1 µm, in the 16 bytes of a number at most
    item.ContourData = [f"{number:.4f}" for number in points.ravel()]
    return item


def outlines(mask: NDArray[np.uint8]) -> list[NDArray[np.float64]]:
    """Returns closed outlines of a slice's mask; holes run the other way around.

    Each is an array of corners (x, y), in voxels whole at their middles, shape [corners, 2]; the
    last one is not the first again.
    """
    from contourpy import LineType, contour_generator

    # air around it, so that every outline closes
    framed = np.pad(mask, 1).astype(np.float64)
    lines = contour_generator(z=framed, line_type=LineType.Separate).lines(0.5)
    return [_corners(np.asarray(line)[:-1] - 1.0) for line in lines]


def _has_hole(loops: list[NDArray[np.float64]]) -> bool:
    areas = [_area(loop) for loop in loops]
    return min(areas) < 0.0 < max(areas)


def _corners(loop: NDArray[np.float64]) -> NDArray[np.float64]:
    """Leaves out points on straight lines between their neighbours."""
    before, after = loop - np.roll(loop, 1, axis=0), np.roll(loop, -1, axis=0) - loop
    turns = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    return loop[np.abs(turns) > 1e-9]


def _area(loop: NDArray[np.float64]) -> float:
    x, y = loop.T
    return 0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))
