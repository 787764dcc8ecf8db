"""Data sets of ``palpate bench haptics``: bones of scans, of the phantom, of a whole chest.

Scans are in the folder ``PALPATE_DATA``, by default ``../shared/data``; missing ones are left out
and reported. ``r`` and ``h`` are in units of the smallest spacing of each scan.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from palpate import _core
from palpate.base.simpleitk import simpleitk
from palpate.bench.goals.haptics import CHEST, HEAD, LARGE, MANY, TORSO, TRUNK
from palpate.io.reading import read
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume

__all__ = [
    "AMOS",
    "CTHEAD",
    "CTHEAD_BONE",
    "EMBEDDED_IN",
    "LIDC",
    "SOURCES",
    "MissingDataError",
    "Source",
    "data_file",
    "ground_of",
    "skin",
]

CTHEAD = "cthead_stanford/CThead.mha"
AMOS = "amos_0336/amos_0336.mhd"
LIDC = "lidc0001_totalseg/cxr.nii.gz"
LIDC_LABELS = "lidc0001_totalseg/mask.nii.gz"
LIDC_NAMES = "lidc0001_totalseg/structures.csv"

CTHEAD_BONE = 1351.0
"""Threshold of bone in CThead, which is not in HU."""

BODY_HU = -300.0
"""Threshold between air and skin."""

SKIN_MM = 3.0

BONES = (
    *("sacrum", "vertebrae", "humerus", "scapula", "clavicula", "femur", "hip"),
    *("skull", "rib", "sternum", "carpal"),
)
"""Beginnings of the names of bones among the structures of LIDC."""

EMBEDDED_IN = (1024, 1024, 1024)


class MissingDataError(Exception):
    """A file of a data set is missing; the message says which."""


def folder() -> Path:
    """Returns the folder of the scans, whether or not it exists."""
    return Path(os.environ.get("PALPATE_DATA") or "../shared/data")


@dataclass(frozen=True)
class Source:
    """A data set, loaded on demand."""

    name: str
    load: Callable[[], _core.Ground]


def ground_of(*segments: Segment) -> _core.Ground:
    """Returns segments of one scan for touch."""
    volume = segments[0].volume
    return _core.Ground(
        volume._internal,  # noqa: SLF001
        [segment._internal for segment in segments],  # noqa: SLF001
        [segment.range for segment in segments],
    )


def cthead_bone() -> _core.Ground:
    """Returns the bone of the thesis' small head."""
    return ground_of(read(data_file(CTHEAD)).threshold(CTHEAD_BONE))


def amos_bone() -> _core.Ground:
    """Returns the default segment of bone."""
    return ground_of(read(data_file(AMOS)).offered_bone())


def lidc_bone() -> _core.Ground:
    """Returns the default segment of bone."""
    return ground_of(read(data_file(LIDC)).offered_bone())


def lidc_bones_and_skin() -> _core.Ground:
    """Returns each labelled bone and the skin as segments."""
    volume = read(data_file(LIDC))
    sitk = simpleitk()
    labels = sitk.GetArrayFromImage(sitk.ReadImage(str(data_file(LIDC_LABELS))))
    with data_file(LIDC_NAMES).open(encoding="utf-8", newline="") as names:
        numbers = {row["structure"]: int(row["id"]) for row in csv.DictReader(names)}
    bones = [
        volume.segment(labels == number, name=name)
        for name, number in numbers.items()
        if name.startswith(BONES)
    ]
    bones = [bone for bone in bones if bone.voxel_count > 0]
    return ground_of(*bones, volume.segment(skin(volume), name="skin"))


def phantom_torso() -> _core.Ground:
    """Returns the phantom's bones at the size of the thesis' torso, slices first."""
    return _core.Ground.phantom((512, 512, 520))


def phantom_1024() -> _core.Ground:
    """Returns the phantom's bones at the largest size."""
    return _core.Ground.phantom((1024, 1024, 1024))


SOURCES = (
    Source(HEAD, cthead_bone),
    Source(TRUNK, amos_bone),
    Source(CHEST, lidc_bone),
    Source(MANY, lidc_bones_and_skin),
    Source(TORSO, phantom_torso),
    Source(LARGE, phantom_1024),
)
"""All data sets, in the order of the report."""


def skin(volume: Volume) -> NDArray[np.bool_]:
    """Returns the outer 3 mm of the largest body component, of the shape of the volume.

    Air inside counts as body, slice by slice, since airways are open where the scan ends. Where the
    scan cuts the body there is no skin.
    """
    sitk = simpleitk()
    solid = volume.array * volume.slope + volume.intercept > BODY_HU
    image = sitk.GetImageFromArray(solid.astype(np.uint8))
    image.SetSpacing(volume.spacing)
    parts = sitk.RelabelComponent(sitk.ConnectedComponent(image), sortByObjectSize=True)
    body = sitk.GetArrayFromImage(parts) == 1
    for number, layer in enumerate(body):
        filled = sitk.BinaryFillhole(sitk.GetImageFromArray(layer.astype(np.uint8)))
        body[number] = sitk.GetArrayFromImage(filled) != 0
    outside = sitk.GetImageFromArray((~body).astype(np.uint8))
    outside.SetSpacing(volume.spacing)
    # from the middle of a voxel to that of the nearest one outside
    depth = sitk.SignedMaurerDistanceMap(
        outside, insideIsPositive=False, squaredDistance=False, useImageSpacing=True
    )
    outermost: NDArray[np.bool_] = body & (sitk.GetArrayFromImage(depth) <= SKIN_MM)
    return outermost


def data_file(name: str) -> Path:
    """Returns a file of the data sets.

    Raises:
        MissingDataError: It is missing.
    """
    path = folder() / name
    if not path.is_file():
        raise MissingDataError(name)
    return path
