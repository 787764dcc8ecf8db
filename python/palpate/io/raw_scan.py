"""A scan as a reader finds it, before its values become int16.

Frame: LPS [mm], as ITK gives it; ``origin`` is the centre of the first voxel, the columns of
``direction`` are the file's axes. Arrays are [z, y, x].
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import SeriesChoiceError, VolumeFormatError
from palpate.base.reader_process import expect
from palpate.volumes.siblings import Siblings
from palpate.volumes.stored_values import Scale

__all__ = [
    "RawScan",
    "check_place",
    "check_shape",
    "choose_frame",
    "kind_of",
    "refuse_components",
    "stem_of",
]

LARGEST = 1e9
"""Of voxels and places [mm]: a thousand kilometres are no patient."""


@dataclass(kw_only=True)
class RawScan:
    """Values of any real type, shape [depth, height, width], and what the file says of them."""

    values: NDArray[Any]
    spacing: tuple[float, float, float]
    origin: tuple[float, float, float]
    direction: NDArray[np.float64]
    name: str
    description: str = ""
    """What the file calls it; "" where it does not."""
    modality: str = ""
    unit: str = ""
    series: str = ""
    frame: str = ""
    """FrameOfReferenceUID, for DICOM."""
    subject: tuple[str, str, str] = ("", "", "")
    """StudyInstanceUID, PatientID and PatientName, for DICOM."""
    siblings: Siblings | None = None
    """Volumes of its file or series, such as times; None where it is alone."""
    orientation_known: bool = True
    file_scale: Scale | None = None
    warnings: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    """What was assumed or changed and is hardly ever wrong."""


def check_shape(what: str, size: tuple[int, ...], max_voxels: int) -> None:
    """Refuses what is no volume, or too big a one, by its voxels along x, y, z.

    Raises:
        VolumeFormatError: The size is not that of a three-dimensional scan.
    """
    named = " x ".join(map(str, size))
    if len([length for length in size if length > 1]) < 3:
        kind = "a 2-D image" if len(size) <= 3 else "no volume"
        raise VolumeFormatError(
            f"{what} is {kind} of {named} voxels; allowed: volumes with 2 or more voxels on each "
            "of three axes, such as a folder with all slices of a DICOM series"
        )
    if math.prod(size) > max_voxels:
        raise VolumeFormatError(
            f"{what} has {named} = {math.prod(size)} voxels; allowed: at most {max_voxels}, "
            "or more with `max_voxels=COUNT`"
        )
    expect(math.prod(size))


def check_place(what: str, scan: RawScan) -> None:
    """Refuses a scan whose voxels or place cannot be: 0, NaN, infinite or far beyond any patient.

    Raises:
        VolumeFormatError: One is such.
    """
    axes = scan.direction.ravel().tolist()
    for name, numbers, least in (
        ("voxels", scan.spacing, 0.0),
        ("a first voxel at a place", scan.origin, -LARGEST),
        ("axes", axes, -LARGEST),
    ):
        if not all(least < number < LARGEST for number in numbers):
            told = ", ".join(f"{number:g}" for number in numbers)
            raise VolumeFormatError(
                f"{what} has {name} of {told} mm, which cannot be; allowed: finite lengths of the "
                "size of patients, and voxels of more than 0 mm"
            )


def choose_frame(what: str, size: tuple[int, ...], frame: int | None) -> int:
    """Returns which volume of a file with more than three axes is meant, counted from 0.

    Args:
        what: The file, for the message.
        size: Voxels along x, y, z and the axes beyond.
        frame: Counted from 1, the fourth axis first; None where nobody has chosen.

    Raises:
        SeriesChoiceError: There are several and none was chosen, or not so many.
    """
    count = math.prod(size[3:])
    if frame is None and count == 1:
        return 0
    if frame is None or not 1 <= frame <= count:
        axes = f" ({' x '.join(map(str, size[3:]))})" if len(size) > 4 else ""
        asked = "" if frame is None else f", and {frame} was asked for"
        raise SeriesChoiceError(
            f"{what} is a {len(size)}-D image of {count} volumes{axes}{asked}; allowed: one of "
            f"them, with `frame=NUMBER` from 1 to {count}"
            if count > 1
            else f"{what} holds one volume{asked}; allowed: the first, with `frame=1`"
        )
    return frame - 1


def refuse_components(what: Path, count: int, kind: str) -> NoReturn:
    """Refuses several numbers in each voxel.

    Raises:
        VolumeFormatError: Always.
    """
    raise VolumeFormatError(
        f"{what} has {count} numbers per voxel ({kind}); allowed: one intensity per voxel"
    )


def kind_of(number: np.dtype[Any]) -> str:
    """Returns the name of a kind of numbers, such as "8-bit unsigned integer"."""
    names = {"u": "unsigned integer", "i": "signed integer", "b": "unsigned integer", "f": "float"}
    return f"{8 * number.itemsize}-bit {names.get(number.kind, 'numbers of several parts')}"


def stem_of(path: Path) -> str:
    """Returns the name of a file without its ending."""
    name = path.name[:-3] if path.name.lower().endswith(".gz") else path.name
    return name.rpartition(".")[0] or path.name
