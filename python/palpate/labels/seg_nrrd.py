"""Segmentations of 3D Slicer, ``.seg.nrrd``: names, colours, and segments that overlap in layers.

Source: "Segmentation file format", 3D Slicer developer guide: ``SegmentN_Name``, ``_Color``,
``_LabelValue``, ``_Layer`` and ``_Tags`` beside the voxels.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from palpate.base.errors import OptionError, VolumeFormatError
from palpate.base.progress import Progress
from palpate.base.simpleitk import reason_of, simpleitk
from palpate.io.payload import check_payload, nrrd_header
from palpate.labels.grid import (
    RESAMPLED,
    Colour,
    Label,
    Labels,
    Resampling,
    patient_from_grid,
    placement,
)
from palpate.volumes.terminology import Terminology
from palpate.volumes.volume import Volume

__all__ = ["is_segmentation", "read_seg_nrrd"]


def is_segmentation(path: Path) -> bool:
    """Says whether a NRRD file lists segments."""
    if not path.name.lower().endswith((".nrrd", ".nhdr")):
        return False
    fields, _ = nrrd_header(path)
    return any(re.fullmatch(r"segment\d+_.*", name) for name in fields)


def read_seg_nrrd(
    path: Path, volume: Volume, *, resample: bool = False, progress: Progress
) -> Labels:
    """Reads the segments of a file, each as a part of the scan.

    Raises:
        VolumeFormatError: The file is damaged.
        OptionError: It lies on another grid than the scan.
    """
    sitk = simpleitk()
    check_payload(path, "nrrd")
    progress(f"reading {path.name}", None)
    try:
        image = sitk.ReadImage(str(path))
    except RuntimeError as error:
        raise VolumeFormatError(
            f"{path} cannot be read: {reason_of(error)}; allowed: complete, undamaged files"
        ) from None
    if image.GetDimension() != 3:
        raise OptionError(f"{path} has {image.GetDimension()} axes; allowed: three, and layers")

    # layers come last: [z, y, x, layer]
    voxels = sitk.GetArrayViewFromImage(image)
    layers = voxels[..., None] if voxels.ndim == 3 else voxels
    direction = np.reshape(image.GetDirection(), (3, 3))
    grid = patient_from_grid(image.GetSpacing(), image.GetOrigin(), direction)
    place = placement(
        f"segmentation {path}", grid, layers.shape[:3], volume=volume, resample=resample
    )

    fields = {key: image.GetMetaData(key) for key in image.GetMetaDataKeys()}
    numbers = sorted(
        {int(found[1]) for key in fields if (found := re.match(r"Segment(\d+)_", key))}
    )
    made: list[Label] = []
    outside = empty = 0
    for done, number in enumerate(numbers):
        progress(f"making {len(numbers)} segments", done / len(numbers))
        name = fields.get(f"Segment{number}_Name") or f"segment {number + 1}"
        value = int(fields.get(f"Segment{number}_LabelValue", number + 1))
        layer = int(fields.get(f"Segment{number}_Layer", 0))
        if not 0 <= layer < layers.shape[3]:
            raise VolumeFormatError(
                f"{path} names layer {layer} of {layers.shape[3]}; allowed: layers that it holds"
            )
        mask = np.zeros(volume.shape, np.uint8)
        outside += place.lay((layers[..., layer] == value).astype(np.uint8), mask)
        if mask.any():
            segment = volume.segment(mask, name=name)
            segment.terminology = _terminology(fields, number)
            made.append(Label(segment, _colour(fields, number)))
        else:
            empty += 1
    told = [f"{empty} segments are empty"] if empty else []
    told += [f"{outside} voxels of segments lie outside the scan"] if outside else []
    told += [RESAMPLED] if isinstance(place, Resampling) else []
    return Labels(tuple(made), tuple(told))


def _colour(fields: dict[str, str], number: int) -> Colour | None:
    try:
        red, green, blue = (float(part) for part in fields[f"Segment{number}_Color"].split())
    except (KeyError, ValueError):
        return None
    return red, green, blue


def _terminology(fields: dict[str, str], number: int) -> Terminology | None:
    told = re.search(r"TerminologyEntry:([^|]*)", fields.get(f"Segment{number}_Tags", ""))
    return None if told is None else Terminology.of_slicer(told[1])
