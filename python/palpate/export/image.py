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
from palpate.export.numbering import changed_numbers, numbers_of
from palpate.labels.name_table import table_beside
from palpate.volumes.scene import SceneSegment
from palpate.volumes.volume import Volume

__all__ = ["write_image", "write_label_map", "write_scan"]


def write_scan(volume: Volume, path: Path) -> None:
    """Writes the values of a scan [its unit]: whole ones as integers, others as floats.

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
    numbers, told = numbers_of(segments)
    labels, shared = label_map(segments, numbers)
    with whole_file(table_beside(path)) as table:
        _write_names(segments, numbers, table)
        write_image(labels, volume, path)
    if not shared:
        return told
    return [
        *told,
        (
            f"{shared} voxels belong to several segments and are kept in the last one; .seg.nrrd "
            "and DICOM SEG keep them in all"
        ),
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
        if not _is_same(sitk.GetArrayViewFromImage(again), array):
            raise OSError(errno.EIO, "was not written as it should be; is the disk full?", path)


def _is_same(again: NDArray[Any], array: NDArray[Any]) -> bool:
    # ITK takes NaN of NIfTI files for 0
    same = (again == array) | np.isnan(array) if array.dtype.kind == "f" else again == array
    return bool(np.all(same))


def _values(volume: Volume) -> NDArray[Any]:
    """Returns values as they were read, whole ones in the narrowest integers that hold them."""
    values = volume.values()
    if values.dtype.kind not in "iu":
        return values
    low, high = volume.range
    kind = next(
        kind
        for kind in (np.int16, np.uint16, np.int32, np.int64, values.dtype)
        if np.iinfo(kind).min <= low and high <= np.iinfo(kind).max
    )
    narrow: NDArray[Any] = values.astype(kind, copy=False)
    return narrow


def _write_names(segments: Sequence[SceneSegment], numbers: Sequence[int], path: Path) -> None:
    """Writes the table; where numbers changed, with a column of those that were read."""
    changed = bool(changed_numbers(segments, numbers))
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file)
        table.writerow(["id", "structure", "red", "green", "blue", *(["original"] * changed)])
        for number, one in zip(numbers, segments, strict=True):
            colour = (f"{part:.6g}" for part in one.colour)
            original = number if one.segment.number is None else one.segment.number
            table.writerow([number, one.name, *colour, *([original] * changed)])
