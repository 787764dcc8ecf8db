"""Writing of scans and label maps as image files: NIfTI, NRRD and MetaImage, by SimpleITK.

What was written is read again and compared before it takes its place: ITK tells of a full disk
in some formats only.

Frame: LPS [mm]; NIfTI's own axes are ITK's concern.
"""

from __future__ import annotations

import csv
import errno
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.simpleitk import image_on, reason_of, simpleitk
from palpate.base.whole_file import whole_file
from palpate.export.masks import label_map
from palpate.volumes.scene import SceneSegment
from palpate.volumes.volume import Volume

__all__ = ["IMAGE_SUFFIXES", "write_image", "write_label_map", "write_scan"]

IMAGE_SUFFIXES = (".nii.gz", ".nii", ".nrrd", ".mha")

I16 = np.iinfo(np.int16)


def write_scan(volume: Volume, path: Path) -> None:
    """Writes the values of a scan [its unit]: whole ones that fit as int16, others as float32.

    Raises:
        OSError: The disk refuses it.
    """
    write_image(_values(volume), volume, path)


def write_label_map(segments: Sequence[SceneSegment], volume: Volume, path: Path) -> list[str]:
    """Writes numbers of segments, and their names and colours beside it as ``.csv``.

    Returns what was lost, in words.

    Raises:
        OSError: The disk refuses it.
    """
    labels, shared = label_map(segments)
    names = path.with_name(path.name.split(".")[0] + ".csv")
    with whole_file(names) as table:
        _write_names(segments, table)
        write_image(labels, volume, path)
    if not shared:
        return []
    return [
        (
            f"{shared} voxels belong to several segments and are kept in the last one; .seg.nrrd "
            "and DICOM SEG keep them in all"
        )
    ]


def write_image(array: NDArray[Any], volume: Volume, path: Path) -> None:
    """Writes an array on the grid of a scan, shape [depth, height, width].

    Raises:
        OSError: The disk refuses it.
    """
    sitk = simpleitk()
    image = image_on(volume, array)
    with whole_file(path) as unfinished:
        try:
            sitk.WriteImage(image, str(unfinished), useCompression=True)
            again = sitk.ReadImage(str(unfinished))
        except RuntimeError as error:
            raise OSError(errno.EIO, f"cannot be written ({reason_of(error)})", path) from None
        if not np.array_equal(sitk.GetArrayViewFromImage(again), array):
            raise OSError(errno.EIO, "was not written as it should be; is the disk full?", path)


def _values(volume: Volume) -> NDArray[Any]:
    slope, intercept = volume.slope, volume.intercept
    low, high = (volume.value_of(end) for end in (int(volume.array.min()), int(volume.array.max())))
    whole = float(slope).is_integer() and float(intercept).is_integer()
    if whole and I16.min <= min(low, high) and max(low, high) <= I16.max:
        return (volume.array.astype(np.int32) * int(slope) + int(intercept)).astype(np.int16)
    values: NDArray[Any] = (volume.array * np.float64(slope) + intercept).astype(np.float32)
    return values


def _write_names(segments: Sequence[SceneSegment], path: Path) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file)
        table.writerow(["id", "structure", "red", "green", "blue"])
        for number, one in enumerate(segments, 1):
            table.writerow([number, one.name, *(f"{part:.6g}" for part in one.colour)])
