"""DICOM segmentations (SEG): binary, fractional and label maps, segments that overlap too.

Each frame is laid on the scan's slice at its own place, so that frames may be few, in any order,
and run against the scan.

Source: DICOM PS3.3, A.51 and C.8.20 (segmentation), C.10.7.1.1 (CIELab).
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError, VolumeFormatError
from palpate.base.progress import Progress
from palpate.io.dicom.header import Frame, damage_told, frame_of
from palpate.labels.belonging import check_belonging
from palpate.labels.dicom_objects import dataset_of, pixels_of
from palpate.labels.grid import (
    Colour,
    Label,
    Labels,
    Place,
    patient_from_grid,
    placement,
    told_of,
)
from palpate.labels.segments_told import SegmentsTold
from palpate.volumes.terminology import Code, Terminology
from palpate.volumes.volume import Volume

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

__all__ = ["colour_of_lab", "lab_of_colour", "read_seg"]

BACKGROUND = "125040"
"""Code of a label map's background (DCM)."""


@dataclass(frozen=True)
class _Told:
    """What a file says of one segment."""

    number: int
    name: str
    colour: Colour | None
    terminology: Terminology | None


def read_seg(
    path: Path,
    volume: Volume,
    *,
    resample: bool = False,
    another_patient: bool = False,
    progress: Progress,
) -> Labels:
    """Reads the segments of a file, each as a part of the scan.

    Raises:
        VolumeFormatError: The file is damaged, or does not say where its frames lie.
        OptionError: It is another patient's, or lies on another grid than the scan.
    """
    with damage_told(path):
        dataset = dataset_of(path)
        announced = [_told(item) for item in dataset.get("SegmentSequence") or [] if _is_part(item)]
        count = _frame_count(path, dataset)
        frames = [frame_of(dataset, index) for index in range(count)]
        of_frame = [_number(dataset, index) for index in range(count)]
    foreign = check_belonging(
        path,
        dataset,
        volume,
        frames={str(dataset.get("FrameOfReferenceUID") or "")} - {""},
        resample=resample,
        another_patient=another_patient,
    )
    progress(f"reading {count} frames", None)
    shape = (count, int(dataset.Rows), int(dataset.Columns))
    stored = pixels_of(path, shape=shape)
    places = _places(path, frames, shape, volume=volume, resample=resample)

    kind = str(dataset.get("SegmentationType") or "BINARY")
    most = int(dataset.get("MaximumFractionalValue") or 255)
    made: list[Label] = []
    told = SegmentsTold()
    for done, segment in enumerate(announced):
        progress(f"making {len(announced)} segments", done / len(announced))
        mask = np.zeros(volume.shape, np.uint8)
        voxels = outside = 0
        for place, pixels, number in zip(places, stored, of_frame, strict=True):
            if kind != "LABELMAP" and number != segment.number:
                continue
            solid = _solid(pixels, kind=kind, number=segment.number, most=most)
            voxels += int(np.count_nonzero(solid))
            outside += len(place.lay(solid[None], mask))
        there = bool(mask.any())
        told.add(segment.name, voxels=voxels, outside=outside, there=there)
        if there:
            part = volume.segment(mask, name=segment.name)
            part.number = segment.number
            part.terminology = segment.terminology
            made.append(Label(part, segment.colour))
    said = foreign
    said += ["fractions of voxels are cut at 50 %"] if kind == "FRACTIONAL" else []
    said += told.sentences()
    said += told_of(places)
    return Labels(tuple(made), tuple(said))


def _frame_count(path: Path, dataset: Dataset) -> int:
    """Returns how many frames a file announces, once each has a description of its own."""
    count = int(dataset.get("NumberOfFrames") or 1)
    described = len(dataset.get("PerFrameFunctionalGroupsSequence") or [])
    if not 1 <= count <= max(1, described):
        raise VolumeFormatError(
            f"{path} announces {count} frames and describes {described}; allowed: as many as are "
            "described"
        )
    return count


def _solid(pixels: NDArray[Any], *, kind: str, number: int, most: int) -> NDArray[np.uint8]:
    solid: NDArray[np.bool_] = pixels != 0
    if kind == "LABELMAP":
        solid = pixels == number
    elif kind == "FRACTIONAL":
        solid = 2 * pixels.astype(np.int64) >= most
    return solid.astype(np.uint8)


def _places(
    path: Path, frames: list[Frame], shape: tuple[int, ...], *, volume: Volume, resample: bool
) -> list[Place]:
    """Returns how each frame lies in the scan."""
    try:
        return [_place(path, frame, shape, volume=volume) for frame in frames]
    except OptionError:
        if not resample:
            raise
    step = _step(frames, volume)
    return [_place(path, frame, shape, volume=volume, step=step) for frame in frames]


def _step(frames: list[Frame], volume: Volume) -> float:
    """Returns how far slices are apart [mm]: the nearest two of them, or those of the scan."""
    across, down = np.reshape(frames[0].orientation or (), (2, 3))
    heights = np.array([frame.position for frame in frames]) @ np.cross(across, down)
    steps = np.diff(np.unique(heights.round(3)))
    return float(steps.min()) if steps.size else min(volume.spacing)


def _place(
    path: Path,
    frame: Frame,
    shape: tuple[int, ...],
    *,
    volume: Volume,
    step: float | None = None,
) -> Place:
    """Returns how a frame lies in the scan, as one slice as thick as the scan's.

    Where a ``step`` is given it is as thick as that, and may lie on any grid.
    """
    if frame.position is None or frame.orientation is None or frame.pixel_spacing is None:
        raise VolumeFormatError(
            f"{path} does not say where its frames lie; allowed: with position, orientation and "
            "pixel spacing of each"
        )
    across, down = np.reshape(frame.orientation, (2, 3))
    normal = np.cross(across, down)
    # the scan's axis along the normal
    along = int(np.argmax(np.abs(volume.direction.T @ normal)))
    thick = volume.spacing[along] if step is None else step
    spacing = (frame.pixel_spacing[1], frame.pixel_spacing[0], thick)
    grid = patient_from_grid(spacing, frame.position, np.column_stack([across, down, normal]))
    return placement(
        f"segmentation {path}", grid, (1, *shape[1:]), volume=volume, resample=step is not None
    )


def _number(dataset: Dataset, index: int) -> int | None:
    """Returns the segment that a frame belongs to; None in a label map."""
    groups = dataset.get("PerFrameFunctionalGroupsSequence") or []
    for group in (*groups[index : index + 1], *dataset.SharedFunctionalGroupsSequence[:1]):
        if named := group.get("SegmentIdentificationSequence"):
            return int(named[0].ReferencedSegmentNumber)
    return None


def _is_part(item: Dataset) -> bool:
    kind = item.get("SegmentedPropertyTypeCodeSequence") or [{}]
    return int(item.SegmentNumber) != 0 and kind[0].get("CodeValue") != BACKGROUND


def _told(item: Dataset) -> _Told:
    number = int(item.SegmentNumber)
    name = str(item.get("SegmentLabel") or f"segment {number}")
    lab = item.get("RecommendedDisplayCIELabValue")
    colour = colour_of_lab(lab) if lab is not None and len(lab) == 3 else None
    return _Told(number, name, colour, _terminology(item))


def _terminology(item: Dataset) -> Terminology | None:
    category = _code(item, "SegmentedPropertyCategoryCodeSequence")
    kind = _code(item, "SegmentedPropertyTypeCodeSequence")
    if category is None or kind is None:
        return None
    of_kind = item.SegmentedPropertyTypeCodeSequence[0]
    return Terminology(
        category,
        kind,
        side=_code(of_kind, "SegmentedPropertyTypeModifierCodeSequence"),
        region=_code(item, "AnatomicRegionSequence"),
    )


def _code(item: Dataset, name: str) -> Code | None:
    """Returns the first code of a sequence."""
    held = item.get(name)
    if not held or not held[0].get("CodeValue"):
        return None
    told = held[0]
    return Code(
        str(told.CodeValue),
        str(told.get("CodingSchemeDesignator") or ""),
        str(told.get("CodeMeaning") or ""),
    )


def colour_of_lab(stored: list[int]) -> Colour:
    """Returns the sRGB colour of CIELab as DICOM stores it, 16 bits each (white point D50).

    Source: IEC 61966-2-1 with the Bradford matrix from D50; CIE 15.
    """
    lightness = stored[0] / 65535.0 * 100.0
    a, b = (number / 257.0 - 128.0 for number in stored[1:3])
    y = (lightness + 16.0) / 116.0
    curve = np.array([y + a / 500.0, y, y - b / 200.0])
    linear = np.where(curve > 6 / 29, curve**3, 3 * (6 / 29) ** 2 * (curve - 4 / 29))
    xyz = linear * (0.9642, 1.0, 0.8249)
    rgb = XYZ_D50_TO_SRGB @ xyz
    shown = np.where(rgb <= 0.0031308, 12.92 * rgb, 1.055 * np.maximum(rgb, 0) ** (1 / 2.4) - 0.055)
    red, green, blue = (float(part) for part in shown.clip(0.0, 1.0))
    return red, green, blue


def lab_of_colour(colour: Colour) -> list[int]:
    """Returns the CIELab that DICOM stores for an sRGB colour: the inverse of ``colour_of_lab``."""
    shown = np.asarray(colour)
    linear = np.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)
    xyz = np.linalg.solve(XYZ_D50_TO_SRGB, linear) / (0.9642, 1.0, 0.8249)
    low = xyz <= (6 / 29) ** 3
    curve = np.where(low, xyz / (3 * (6 / 29) ** 2) + 4 / 29, np.cbrt(xyz))
    lightness, a, b = 116 * curve[1] - 16, 500 * (curve[0] - curve[1]), 200 * (curve[1] - curve[2])
    stored = np.array([lightness / 100 * 65535, (a + 128) * 257, (b + 128) * 257])
    return [int(number) for number in np.rint(stored).clip(0, 65535)]


XYZ_D50_TO_SRGB = np.array(
    [
        [3.1338561, -1.6168667, -0.4906146],
        [-0.9787684, 1.9161415, 0.0334540],
        [0.0719453, -0.2289914, 1.4052427],
    ]
)
