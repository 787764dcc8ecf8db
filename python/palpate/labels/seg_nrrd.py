"""Segmentations of 3D Slicer, ``.seg.nrrd``: names, colours, and segments that overlap in layers.

Source: "Segmentation file format", 3D Slicer developer guide: ``SegmentN_Name``, ``_Color``,
``_LabelValue``, ``_Layer`` and ``_Tags`` beside the voxels.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError, VolumeFormatError
from palpate.base.progress import Progress
from palpate.base.reader_process import apart, looking_at
from palpate.base.simpleitk import reason_of, simpleitk
from palpate.io.header_check import check_header
from palpate.io.itk_image import unit_of
from palpate.io.payload import check_payload, header_text, nrrd_header
from palpate.labels.grid import (
    Colour,
    Label,
    Labels,
    patient_from_grid,
    placement,
    told_of,
)
from palpate.labels.segments_told import SegmentsTold
from palpate.volumes.terminology import Terminology
from palpate.volumes.volume import Volume

__all__ = ["SegmentationGrid", "is_segmentation", "read_seg_nrrd", "segmentation_grid"]


def is_segmentation(path: Path) -> bool:
    """Says whether a NRRD file lists segments."""
    if not path.name.lower().endswith((".nrrd", ".nhdr")):
        return False
    fields, _ = nrrd_header(path)
    return any(re.fullmatch(r"segment\d+_.*", name) for name in fields)


@dataclass(frozen=True)
class _Image:
    """What a file holds."""

    layers: NDArray[Any]
    """Shape [z, y, x, layer]."""
    spacing: NDArray[np.float64]
    origin: NDArray[np.float64]
    direction: NDArray[np.float64]
    fields: dict[str, str]
    told: tuple[str, ...]
    """What is not as it should be, in words."""


def _image_at(path: Path, *, progress: Progress) -> _Image:
    """Reads a file, in a worker."""
    sitk = simpleitk()
    check_header(path)
    check_payload(path, "nrrd")
    progress(f"reading {path.name}", None)
    try:
        with looking_at(path, "NRRD"):
            image = sitk.ReadImage(str(path))
    except RuntimeError as error:
        raise VolumeFormatError(
            f"{path} cannot be read: {reason_of(error)}; allowed: complete, undamaged files"
        ) from None
    if image.GetDimension() != 3:
        raise OptionError(f"{path} has {image.GetDimension()} axes; allowed: three, and layers")
    # layers come last
    voxels = sitk.GetArrayFromImage(image)
    scale, told = unit_of(path, "nrrd")
    return _Image(
        layers=voxels[..., None] if voxels.ndim == 3 else voxels,
        spacing=np.multiply(image.GetSpacing(), scale),
        origin=np.multiply(image.GetOrigin(), scale),
        direction=np.reshape(image.GetDirection(), (3, 3)),
        # names that are no text cannot be asked for
        fields={
            key: _text(image.GetMetaData(key))
            for key in image.GetMetaDataKeys()
            if isinstance(key, str) and key.isprintable()
        },
        told=told,
    )


@dataclass(frozen=True)
class SegmentationGrid:
    """Where the voxels of a file lie, LPS [mm]."""

    shape: tuple[int, int, int]
    """[depth, height, width]."""
    spacing: tuple[float, float, float]
    origin: tuple[float, float, float]
    direction: NDArray[np.float64]


def segmentation_grid(path: Path, *, progress: Progress) -> SegmentationGrid:
    """Returns the grid of a file.

    Raises:
        VolumeFormatError: The file is damaged.
    """
    image = _image_at(path, progress=progress)
    depth, height, width = image.layers.shape[:3]
    x, y, z = image.spacing.tolist()
    left, back, up = image.origin.tolist()
    return SegmentationGrid((depth, height, width), (x, y, z), (left, back, up), image.direction)


def read_seg_nrrd(
    path: Path, volume: Volume, *, resample: bool = False, progress: Progress
) -> Labels:
    """Reads the segments of a file, each as a part of the scan.

    Raises:
        VolumeFormatError: The file is damaged.
        OptionError: It lies on another grid than the scan.
    """
    image = apart(_image_at, path, path=path, progress=progress)
    layers, fields = image.layers, image.fields
    grid = patient_from_grid(image.spacing, image.origin, image.direction)
    place = placement(
        f"segmentation {path}", grid, layers.shape[:3], volume=volume, resample=resample
    )

    stored = _stored_segments(path, fields, layers.shape[3])
    made: list[Label] = []
    told = SegmentsTold()
    for done, one in enumerate(stored):
        progress(f"making {len(stored)} segments", done / len(stored))
        layer = layers[..., one.layer]
        inside = layer != 0 if one.value is None else layer == one.value
        mask = np.zeros(volume.shape, np.uint8)
        lost = place.lay(inside.astype(np.uint8), mask)
        there = bool(mask.any())
        voxels = int(np.count_nonzero(inside))
        told.add(one.name, voxels=voxels, outside=len(lost), there=there)
        if there:
            segment = volume.segment(mask, name=one.name)
            segment.number = one.value
            segment.terminology = _terminology(fields, one.number)
            made.append(Label(segment, _colour(fields, one.number)))
    return Labels(tuple(made), (*image.told, *told.sentences(), *told_of([place])))


@dataclass(frozen=True)
class _Stored:
    """Where a segment stands in a file."""

    number: int
    """In the names of its fields."""
    name: str
    layer: int
    value: int | None
    """Of its voxels; None for all but 0."""


def _stored_segments(path: Path, fields: dict[str, str], layers: int) -> list[_Stored]:
    """Lists the segments of a file by its fields.

    Older versions and other programs give each segment a layer of its own, in the order of their
    numbers, and say neither layer nor value.

    Raises:
        VolumeFormatError: A layer is none of the file's, or which segment is where stays open.
    """
    numbers = sorted(
        {int(found[1]) for key in fields if (found := re.match(r"Segment(\d+)_", key))}
    )
    told = any(re.fullmatch(r"Segment\d+_(LabelValue|Layer)", key) for key in fields)
    if not told and layers > 1 and len(numbers) != layers:
        raise VolumeFormatError(
            f"{path} names {len(numbers)} segments for {layers} layers and does not say which is "
            "where; allowed: one layer for each segment, or LabelValue and Layer"
        )
    stored = []
    for place, number in enumerate(numbers):
        name = fields.get(f"Segment{number}_Name") or f"segment {number + 1}"
        value: int | None = int(fields.get(f"Segment{number}_LabelValue", number + 1))
        layer = int(fields.get(f"Segment{number}_Layer", 0))
        if not told and layers > 1:
            layer, value = place, None
        if not 0 <= layer < layers:
            raise VolumeFormatError(
                f"{path} names layer {layer} of {layers}; allowed: layers that it holds"
            )
        stored.append(_Stored(number, name, layer, value))
    return stored


def _text(told: str) -> str:
    """Returns text that SimpleITK took for UTF-8, read anew where it is none."""
    return header_text(told.encode("utf-8", "surrogateescape"))


def _colour(fields: dict[str, str], number: int) -> Colour | None:
    try:
        red, green, blue = (float(part) for part in fields[f"Segment{number}_Color"].split())
    except (KeyError, ValueError):
        return None
    return red, green, blue


def _terminology(fields: dict[str, str], number: int) -> Terminology | None:
    told = re.search(r"TerminologyEntry:([^|]*)", fields.get(f"Segment{number}_Tags", ""))
    return None if told is None else Terminology.of_slicer(told[1])
