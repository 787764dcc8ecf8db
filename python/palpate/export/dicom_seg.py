"""DICOM segmentations (SEG) of a scan, binary or as label maps, made by highdicom.

Frames lie on the scan's slices; those without a segment are left out.

Source: DICOM PS3.3, A.51 (segmentation), C.8.20.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.base.package_version import package_version
from palpate.export.dicom_object import MAKER, UTF_8, header_told, series_number
from palpate.export.dicom_source import DicomSource
from palpate.export.masks import label_map, overlap_of
from palpate.export.numbering import numbers_of, unique_names
from palpate.labels.dicom_seg import lab_of_colour
from palpate.volumes.scene import SceneSegment
from palpate.volumes.terminology import Code, Terminology, terminology_of_name
from palpate.volumes.volume import Volume

if TYPE_CHECKING:
    import highdicom
    from pydicom.dataset import Dataset

__all__ = ["MOST_LABEL", "SegKind", "make_seg"]

SegKind = Literal["BINARY", "LABELMAP"]

MOST_LABEL = 2**16 - 1
"""Highest number of a label map; those of binary segmentations run from 1 without a gap."""
MOST_BYTES = 2**31
"""Of masks that overlap, which highdicom wants all at once."""


def make_seg(
    segments: Sequence[SceneSegment], volume: Volume, source: DicomSource, *, kind: SegKind
) -> Dataset:
    """Returns a SEG object that refers to the scan's files.

    Raises:
        OptionError: Segments overlap and the kind does not allow it, or need too much memory; or
            the headers of the scan's files do not allow a SEG.
    """
    names, _ = unique_names(segments)
    numbers = list(range(1, len(segments) + 1))
    if kind == "LABELMAP":
        numbers, _ = numbers_of(segments, most=MOST_LABEL)
        # highdicom wants descriptions in the order of their numbers
        order = sorted(range(len(segments)), key=numbers.__getitem__)
        segments = [segments[place] for place in order]
        names = [names[place] for place in order]
        numbers.sort()
    with header_told("a DICOM SEG"):
        import highdicom
        from pydicom.uid import generate_uid

        made: Dataset = highdicom.seg.Segmentation(
            source_images=list(source.images),
            pixel_array=_masks(segments, volume, source, numbers=numbers, kind=kind),
            segmentation_type=kind,
            segment_descriptions=[
                _description(*each) for each in zip(numbers, names, segments, strict=True)
            ],
            series_instance_uid=generate_uid(),
            series_number=series_number(source, 1 if kind == "BINARY" else 2),
            sop_instance_uid=generate_uid(),
            instance_number=1,
            manufacturer=MAKER,
            manufacturer_model_name=MAKER,
            software_versions=package_version(),
            device_serial_number="1",
            content_label="SEGMENTS",
            series_description="Segments",
            specific_character_set=UTF_8,
        )
        return made


def _masks(
    segments: Sequence[SceneSegment],
    volume: Volume,
    source: DicomSource,
    *,
    numbers: Sequence[int],
    kind: SegKind,
) -> highdicom.Volume:
    """Returns highdicom's volume: numbers of segments, or a mask of each where they overlap."""
    import highdicom

    overlap = overlap_of(segments)
    channels: dict[Any, Any] | None = None
    if overlap is None:
        array: NDArray[Any] = label_map(segments, numbers)[0]
    elif kind == "LABELMAP":
        raise OptionError(
            f"segments {overlap[0]!r} and {overlap[1]!r} share voxels, which a label map cannot "
            "tell; allowed: a binary DICOM SEG"
        )
    else:
        size = len(segments) * volume.array.size
        if size > MOST_BYTES:
            raise OptionError(
                f"{len(segments)} segments that overlap take {size / 2**30:.1f} GiB; allowed: "
                f"{MOST_BYTES / 2**30:.0f} GiB, so fewer with `only=NAME`, or .seg.nrrd"
            )
        array = np.stack([one.segment.mask() for one in segments], axis=-1)
        channels = {"SegmentNumber": list(range(1, len(segments) + 1))}
    # of indices (slice, row, column)
    patient_from_index = np.eye(4)
    patient_from_index[:3, :3] = (volume.direction * np.asarray(volume.spacing))[:, ::-1]
    patient_from_index[:3, 3] = volume.origin
    return highdicom.Volume(
        array,
        patient_from_index,
        coordinate_system="PATIENT",
        frame_of_reference_uid=str(source.first.FrameOfReferenceUID),
        channels=channels,
    )


def _description(number: int, name: str, one: SceneSegment) -> highdicom.seg.SegmentDescription:
    import highdicom
    from pydicom.sr.coding import Code as DicomCode

    def given(code: Code) -> DicomCode:
        return DicomCode(code.value, code.scheme, code.meaning[:64])

    terms: Terminology = one.segment.terminology or terminology_of_name(one.name)
    made = highdicom.seg.SegmentDescription(
        segment_number=number,
        segment_label=name,
        segmented_property_category=given(terms.category),
        segmented_property_type=given(terms.kind),
        algorithm_type="MANUAL",
        anatomic_regions=None if terms.region is None else [given(terms.region)],
    )
    # highdicom's own would be of another white point than DICOM's
    made.RecommendedDisplayCIELabValue = lab_of_colour(one.colour)
    if terms.side is not None:
        kind = made.SegmentedPropertyTypeCodeSequence[0]
        side = highdicom.sr.CodedConcept.from_code(given(terms.side))
        kind.SegmentedPropertyTypeModifierCodeSequence = [side]
    return made
