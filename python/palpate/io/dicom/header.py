"""What the headers of DICOM files say: frames, grouped into series.

Read with pydicom, without pixels, since GDCM's own scan of a folder stops at the first file
it dislikes.

Frame: positions and orientations in LPS [mm], as DICOM gives them.
Source: DICOM PS3.3, C.7.6.2 (image plane), C.7.6.16 (functional groups of multi-frame images).
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from palpate.base.damaged_file import damage_as
from palpate.base.errors import VolumeFormatError
from palpate.base.progress import Progress
from palpate.base.reader_process import looking_at
from palpate.io.dicom.dates import written_date
from palpate.io.dicom.detector import detector_place
from palpate.io.dicom.dose import RTDOSE, DoseTags, dose_tags_of
from palpate.io.dicom.enhanced_pet import ENHANCED_PET, enhanced_pet_tags_of, pet_mapping
from palpate.io.dicom.mark import has_mark, read_dataset
from palpate.io.dicom.mixtures import scans_of
from palpate.io.dicom.pet_tags import PetTags, pet_tags_of
from palpate.io.dicom.phases import phase_of, phases_of
from palpate.io.dicom.promises import check_deflated, frame_count
from palpate.io.dicom.rescale import (
    ModalityTable,
    real_world_scale,
    scale_of,
    scale_trouble,
    table_of,
)
from palpate.io.dicom.stacks import stacks_of

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

__all__ = [
    "PARALLEL",
    "Concatenation",
    "Frame",
    "Header",
    "Series",
    "damage_told",
    "find_series",
    "frame_of",
    "read_header",
    "volumes_in",
]

DERIVED_OBJECTS = ("SEG", "RTSTRUCT", "RTPLAN", "RTIMAGE", "SR", "PR", "REG", "KO")
"""Modalities of objects that refer to a scan and are none."""
PARAMETRIC_MAP = "1.2.840.10008.5.1.4.1.1.30"
PARALLEL = 2e-3
"""By how much the cosines of parallel slices differ at most: writers leave three digits."""
PLAIN = {
    "1.2.840.10008.1.2": ("<", b"\xe0\x7f\x10\x00", 8),
    "1.2.840.10008.1.2.1": ("<", b"\xe0\x7f\x10\x00", 12),
}
"""Transfer syntaxes without compression, little endian: order of bytes, the tag of pixels, and the
bytes before them (PS3.5, 7.1)."""
AT_DETECTOR = (
    "pixel spacing is that of the detector (ImagerPixelSpacing): in the patient it is smaller"
)
STUDY = ("StudyInstanceUID", "FrameOfReferenceUID")
PADDING = ("PixelPaddingValue", "PixelPaddingRangeLimit")


@dataclass(frozen=True)
class Frame:
    """Where one slice lies; None where the file does not tell."""

    position: tuple[float, ...] | None
    orientation: tuple[float, ...] | None
    pixel_spacing: tuple[float, ...] | None
    """Between rows, between columns [mm], in DICOM's order."""
    scale: tuple[float, float] | None
    """Rescale slope and intercept; None where numbers are values as they are stored."""
    stack: str = ""
    """Stack ID."""
    phase: tuple[str, ...] = ()
    """What may tell it from slices at the same place, as ``phases`` has it."""


@dataclass(frozen=True)
class Header:
    """What one file says about its slices."""

    path: Path
    series: str
    description: str
    modality: str
    unit: str
    rows: int
    columns: int
    samples: int
    frames: tuple[Frame, ...]
    truncated: bool
    """Whether uncompressed pixels are fewer than announced; compressed ones are not counted."""
    plain: tuple[int, str] | None
    """Byte at which uncompressed pixels begin, and their type; None where a decoder is needed."""
    instance: str
    """SOPInstanceUID: two files with the same one are copies."""
    patient: str
    """Name and number, as the file has them."""
    study_told: str
    """Date and description."""
    study: tuple[str, ...]
    """UIDs of study and frame of reference: what is left to tell scans apart without a series."""
    frame: str
    """UID of the frame of reference."""
    inverted: bool
    """Whether low numbers are meant to be bright (MONOCHROME1)."""
    bits: int
    """Of a stored number, those in use."""
    padding: tuple[int, int] | None
    """Lowest and highest stored number that stand for no value."""
    subject: tuple[str, str, str] = ("", "", "")
    """StudyInstanceUID, PatientID and PatientName."""
    number: int | None = None
    """Instance Number."""
    step: float | None = None
    """SpacingBetweenSlices [mm]; below 0 where they run the other way."""
    thickness: float | None = None
    """Of a slice [mm]."""
    table: ModalityTable | None = None
    """Which values stored numbers have, in the place of slopes and intercepts."""
    told: tuple[str, ...] = ()
    """What is wrong with the header and matters to whoever looks at the scan."""
    concatenation: Concatenation | None = None
    """Which part of several files of many frames it is."""
    taken: tuple[int, ...] | None = None
    """Which of the file's frames ``frames`` are; None for all of them."""
    pet: PetTags | None = None
    """What a file of PET says about its values."""
    dose: DoseTags | None = None
    """What a dose says of itself."""


@dataclass(frozen=True)
class Concatenation:
    """Which part a file is of an image of many frames (PS3.3, C.7.6.16.2.2.4)."""

    uid: str
    number: int
    """From 1."""
    total: int | None


@dataclass(frozen=True)
class Series:
    """Files of one SeriesInstanceUID with one size and orientation."""

    uid: str
    description: str
    modality: str
    headers: tuple[Header, ...]
    part: str = ""
    """What tells it from other volumes of its series, and ends its description; "" if alone."""

    @property
    def whole(self) -> str:
        """What the series is called that it is a volume of."""
        return self.description.removesuffix(self.part).removesuffix(", ")

    @property
    def volume_of(self) -> tuple[str, str] | None:
        """Returns what is the same for all volumes of its series; None where it is alone."""
        return (self.uid, self.whole) if self.part else None

    @property
    def slices(self) -> int:
        """How many slices its files hold."""
        return sum(len(header.frames) for header in self.headers)

    def __str__(self) -> str:
        name = self.uid or "(empty UID)"
        said = f" {self.description!r}" if self.description else ""
        first = self.headers[0]
        return f"{name}{said} {self.modality}, {self.slices} of {first.columns} x {first.rows}"


def find_series(paths: Iterable[Path], progress: Progress) -> tuple[list[Series], list[Path]]:
    """Groups the images among these files into series, the longest first; lists damaged ones."""
    files = sorted(paths)
    groups: dict[tuple[Any, ...], list[list[Header]]] = {}
    damaged: list[Path] = []
    for done, path in enumerate(files):
        progress(f"looking at {len(files)} files", done / len(files))
        try:
            header = read_header(path)
        except VolumeFormatError:
            damaged.append(path)
            continue
        if header is None:
            continue
        alike = groups.setdefault(_group(header), [])
        group = next((group for group in alike if _parallel(group[0], header)), None)
        if group is None:
            alike.append([header])
        else:
            group.append(header)
    whole = [
        Series(headers[0].series, headers[0].description, headers[0].modality, tuple(headers))
        for alike in groups.values()
        for headers in (sorted(group, key=_part_number) for group in alike)
    ]
    found = [part for series in whole for part in volumes_in(series)]
    # phases of one series keep their order; doses come after the scans that they belong to
    found.sort(key=lambda series: (series.modality == RTDOSE, -series.slices, series.uid))
    return found, damaged


def volumes_in(series: Series) -> list[Series]:
    """Returns the volumes of a series: scans, their stacks, and of each the times, echoes, …."""
    stacks = [stack for scan in scans_of(series) for stack in stacks_of(scan)]
    return [part for stack in stacks for part in phases_of(stack)]


def _part_number(header: Header) -> int:
    return header.concatenation.number if header.concatenation else 0


def _group(header: Header) -> tuple[Any, ...]:
    """Returns what the files of one volume have in common, beside their orientation."""
    own_volume: Path | str | None = header.path if len(header.frames) > 1 else None
    if header.concatenation is not None:
        own_volume = header.concatenation.uid
    # without a UID, what lies on one grid in one frame of reference belongs together
    told = header.series or (header.study, header.modality, header.frames[0].pixel_spacing)
    return (told, header.patient, header.rows, header.columns, own_volume)


def _parallel(one: Header, other: Header) -> bool:
    first, second = one.frames[0].orientation, other.frames[0].orientation
    if first is None or second is None:
        return first is second
    return all(abs(a - b) <= PARALLEL for a, b in zip(first, second, strict=True))


@contextmanager
def damage_told(path: Path, *, allowed: str = "complete, undamaged files") -> Iterator[None]:
    """Tells what pydicom and its decoders raise at damaged files as one kind of error.

    Raises:
        VolumeFormatError: The file is damaged.
    """
    from pydicom.errors import BytesLengthException

    what = f"{path} is damaged, or DICOM of an unknown kind"
    also = (OSError, BytesLengthException)
    with (
        damage_as(VolumeFormatError, what, allowed=allowed, also=also),
        looking_at(path, "DICOM"),
        warnings.catch_warnings(),
    ):
        # sloppy values are common and judged where they matter
        warnings.simplefilter("ignore")
        yield


def read_header(path: Path) -> Header | None:
    """Reads a file's header; None where it is no DICOM image of a scan.

    Raises:
        VolumeFormatError: It is DICOM, and damaged.
    """
    with damage_told(path):
        check_deflated(path)
        with path.open("rb") as file:
            if not has_mark(file):
                return None
            dataset = read_dataset(file, stop_before_pixels=True)
            plain = _plain(file, dataset)
            left = path.stat().st_size - file.tell()
        return _header(path, dataset, left=left, plain=plain)


def _plain(file: BinaryIO, dataset: Dataset) -> tuple[int, str] | None:
    """Finds uncompressed pixels in a file that was read up to them."""
    syntax = getattr(dataset.file_meta, "TransferSyntaxUID", None)
    bits = dataset.get("BitsAllocated")
    if syntax is None or syntax not in PLAIN or bits not in (8, 16):
        return None
    order, tag, length = PLAIN[syntax]
    sign = "i" if dataset.get("PixelRepresentation") else "u"
    begins = file.tell()
    found = file.read(length).startswith(tag)
    return (begins + length, f"{order}{sign}{bits // 8}") if found else None


def _header(
    path: Path, dataset: Dataset, *, left: int, plain: tuple[int, str] | None
) -> Header | None:
    modality = str(dataset.get("Modality") or "")
    rows, columns = dataset.get("Rows"), dataset.get("Columns")
    if not rows or not columns or modality in DERIVED_OBJECTS:
        return None
    samples = int(dataset.get("SamplesPerPixel") or 1)
    count = frame_count(dataset, left=left)
    told = int(dataset.get("NumberOfFrames") or 1)
    stored = int(dataset.get("BitsAllocated") or 16) * rows * columns * samples * told // 8
    syntax = getattr(dataset.file_meta, "TransferSyntaxUID", None)
    packed = bool(syntax is not None and (syntax.is_compressed or syntax.is_deflated))
    frames = tuple(frame_of(dataset, index) for index in range(count))
    dose = dose_tags_of(dataset, frames) if modality == RTDOSE else None
    return Header(
        path=path,
        series=str(dataset.get("SeriesInstanceUID") or ""),
        description=str(dataset.get("SeriesDescription") or ""),
        modality=modality,
        unit=_unit(dataset, modality) if dose is None else dose.unit,
        rows=int(rows),
        columns=int(columns),
        # numbers that a table turns into colours are no intensities either
        samples=3 if dataset.get("PhotometricInterpretation") == "PALETTE COLOR" else samples,
        frames=frames if dose is None else dose.frames,
        truncated=not packed and left < stored,
        plain=plain,
        instance=str(dataset.get("SOPInstanceUID") or ""),
        patient=_joined(dataset, "PatientName", "PatientID"),
        study_told=_study_told(dataset),
        study=tuple(str(dataset.get(name) or "") for name in STUDY),
        frame=str(dataset.get("FrameOfReferenceUID") or ""),
        inverted=dataset.get("PhotometricInterpretation") == "MONOCHROME1",
        bits=int(dataset.get("BitsStored") or dataset.get("BitsAllocated") or 16),
        padding=_padding(dataset),
        subject=(
            str(dataset.get("StudyInstanceUID") or ""),
            str(dataset.get("PatientID") or ""),
            str(dataset.get("PatientName") or ""),
        ),
        concatenation=_concatenation(dataset),
        number=_number(dataset),
        step=_length(dataset, "SpacingBetweenSlices"),
        thickness=_length(dataset, "SliceThickness"),
        table=table_of(dataset),
        told=_told(dataset, count),
        pet=_pet_tags(dataset, modality, count),
        dose=dose,
    )


def _pet_tags(dataset: Dataset, modality: str, count: int) -> PetTags | None:
    """Returns what a file of PET says about its values; None where it is none."""
    if dataset.get("SOPClassUID") == ENHANCED_PET:
        mappings = [pet_mapping(_holders(dataset, index)) for index in range(count)]
        return enhanced_pet_tags_of(dataset, mappings)
    return pet_tags_of(dataset) if modality == "PT" and dataset.get("Units") else None


def frame_of(dataset: Dataset, index: int) -> Frame:
    """Returns where a frame lies, by its own functional groups, the shared ones or the file."""
    plane = _holder(dataset, index, "PlanePositionSequence")
    orientation = _holder(dataset, index, "PlaneOrientationSequence")
    measures = _holder(dataset, index, "PixelMeasuresSequence")
    content = _holder(dataset, index, "FrameContentSequence")
    place = (
        _numbers(plane, "ImagePositionPatient", 3),
        _numbers(orientation, "ImageOrientationPatient", 6),
    )
    if None in place:
        place = detector_place(dataset, index) or place
    return Frame(
        position=place[0],
        orientation=place[1],
        pixel_spacing=_numbers(measures, "PixelSpacing", 2)
        or _numbers(dataset, "ImagerPixelSpacing", 2),
        scale=_scale(dataset, index),
        stack=str(content.get("StackID") or ""),
        phase=phase_of(dataset, _groups(dataset, index), index),
    )


def _numbers(holder: Dataset, name: str, count: int) -> tuple[float, ...] | None:
    try:
        numbers = tuple(float(number) for number in holder.get(name) or ())
    except (TypeError, ValueError):
        return None
    return numbers if len(numbers) == count else None


def _concatenation(dataset: Dataset) -> Concatenation | None:
    uid = dataset.get("SOPInstanceUIDOfConcatenationSource") or dataset.get("ConcatenationUID")
    number = dataset.get("InConcatenationNumber")
    if not uid or not number:
        return None
    total = dataset.get("InConcatenationTotalNumber")
    return Concatenation(str(uid), int(number), int(total) if total else None)


def _number(dataset: Dataset) -> int | None:
    try:
        return int(dataset.InstanceNumber)
    except (AttributeError, TypeError, ValueError):
        return None


def _length(dataset: Dataset, name: str) -> float | None:
    """Returns a length of slices [mm]; None where it is missing, 0 or no number."""
    try:
        length = float(_holder(dataset, 0, "PixelMeasuresSequence").get(name) or 0.0)
    except (TypeError, ValueError):
        return None
    return length if length and math.isfinite(length) else None


def _holder(dataset: Dataset, index: int, group: str) -> Dataset:
    """Returns what holds a frame's values: its own functional group, the shared one, the file."""
    for groups in _groups(dataset, index):
        if groups.get(group):
            held: Dataset = groups[group][0]
            return held
    return dataset


def _groups(dataset: Dataset, index: int) -> list[Dataset]:
    """Returns a frame's own functional groups and the shared ones, where there are any."""
    per_frame = dataset.get("PerFrameFunctionalGroupsSequence") or []
    shared = dataset.get("SharedFunctionalGroupsSequence") or []
    return [*per_frame[index : index + 1], *shared[:1]]


def _holders(dataset: Dataset, index: int) -> list[Dataset]:
    """Returns a frame's own functional groups, the shared ones and the file."""
    return [*_groups(dataset, index), dataset]


def _scale(dataset: Dataset, index: int) -> tuple[float, float] | None:
    own = scale_of(_holder(dataset, index, "PixelValueTransformationSequence"))
    mapping = _mapping(dataset, index, own)
    return own if mapping is None else real_world_scale(mapping) or own


def _mapping(dataset: Dataset, index: int, own: tuple[float, float] | None) -> Dataset | None:
    """Returns what maps stored numbers to real world values, where that gives a frame its values.

    That is in parametric maps and enhanced PET, and where the frame has no slope and intercept of
    its own.
    """
    kind = dataset.get("SOPClassUID")
    if kind == ENHANCED_PET:
        return pet_mapping(_holders(dataset, index))
    if own is not None and kind != PARAMETRIC_MAP:
        return None
    for holder in _holders(dataset, index):
        if holder.get("RealWorldValueMappingSequence"):
            mapping: Dataset = holder.RealWorldValueMappingSequence[0]
            return mapping
    return None


def _told(dataset: Dataset, count: int) -> tuple[str, ...]:
    holders = (
        _holder(dataset, index, "PixelValueTransformationSequence") for index in range(count)
    )
    trouble = dict.fromkeys(filter(None, map(scale_trouble, holders)))
    own = scale_of(_holder(dataset, 0, "PixelValueTransformationSequence"))
    mapping = _mapping(dataset, 0, own)
    is_pet = dataset.get("SOPClassUID") == ENHANCED_PET
    measures = _holder(dataset, 0, "PixelMeasuresSequence")
    at_detector = not measures.get("PixelSpacing") and bool(dataset.get("ImagerPixelSpacing"))
    return (
        *trouble,
        # of PET the unit is told with what is made of it
        *([] if mapping is None or is_pet else [_mapped(mapping)]),
        *([AT_DETECTOR] if at_detector else []),
    )


def _mapped(mapping: Dataset) -> str:
    """Says what real world values are, or that they are not to be had."""
    if real_world_scale(mapping) is None:
        return "real world values are told by a table, which is not read: values are as stored"
    unit = mapping.get("MeasurementUnitsCodeSequence") or []
    code = str(unit[0].get("CodeValue") or "") if unit else ""
    return f"values are real world values, in {code or 'an unknown unit'}"


def _joined(dataset: Dataset, *names: str) -> str:
    """Returns what of several elements is there, as one text."""
    return " ".join(filter(None, (str(dataset.get(name) or "").strip() for name in names)))


def _study_told(dataset: Dataset) -> str:
    """Returns when a study was made, and what it is called."""
    told = (written_date(_joined(dataset, "StudyDate")), _joined(dataset, "StudyDescription"))
    return " ".join(filter(None, told))


def _padding(dataset: Dataset) -> tuple[int, int] | None:
    """Returns the range of PS3.3, C.7.5.1.1.2: one number, or two in either order."""
    try:
        ends = [int(dataset[name].value) for name in PADDING if dataset.get(name) is not None]
    except (TypeError, ValueError):
        return None
    return (min(ends), max(ends)) if ends else None


def _unit(dataset: Dataset, modality: str) -> str:
    """Returns "HU" where a CT is rescaled and its rescale type does not say otherwise."""
    table = dataset.get("ModalityLUTSequence")
    if table:
        return "HU" if modality == "CT" and table[0].get("ModalityLUTType") == "HU" else ""
    holder = _holder(dataset, 0, "PixelValueTransformationSequence")
    kind = str(holder.get("RescaleType") or "HU")
    rescaled = holder.get("RescaleIntercept") is not None and scale_of(holder) is not None
    return "HU" if modality == "CT" and rescaled and kind == "HU" else ""
