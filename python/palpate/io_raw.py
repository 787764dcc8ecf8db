"""Raw voxels whose layout a person states, and stacks of pictures.

Neither says how large a voxel is or how it lies in the patient: the size is asked for, the
orientation can be given.

Layout: a file holds whole slices, x fastest; the slices of a folder come in the order of their
names, with numbers read as numbers. Arrays are [z, y, x].
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.errors import OptionError, VolumeFormatError
from palpate.progress import Progress
from palpate.raw_scan import RawScan, check_shape
from palpate.simpleitk import reason_of, simpleitk

__all__ = [
    "RawLayout",
    "holds_pictures",
    "in_order",
    "is_picture",
    "read_pictures",
    "read_raw",
]

TYPES = ("int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64")
PICTURES = (".png", ".tif", ".tiff", ".bmp", ".jpg", ".jpeg")

Size = tuple[float, float, float]


@dataclass(frozen=True)
class RawLayout:
    """How voxels stand in a file."""

    columns: int
    rows: int
    slices: int | None
    """In all files together; None takes as many as there are."""
    kind: np.dtype[Any]
    skip: int
    """Bytes at the start of each file that are no voxels."""

    @classmethod
    def of(cls, given: str) -> RawLayout:
        """Reads SIZE,TYPE[,ORDER[,SKIP]], such as ``256x256x113,int16,big``.

        Raises:
            OptionError: It is something else.
        """
        found = re.fullmatch(
            r"(\d+)x(\d+)(?:x(\d+))?,(\w+)(?:,(little|big))?(?:,(\d+))?", given.replace(" ", "")
        )
        numbers = [int(length) for length in found.group(1, 2, 3) if length] if found else [0]
        if found is None or found[4] not in TYPES or min(numbers) < 1:
            raise OptionError(
                f"raw layout {given!r} given; allowed: SIZE,TYPE[,ORDER[,SKIP]] with a size such "
                f"as 256x256x113 or 256x256, a type of {', '.join(TYPES)}, an order of bytes of "
                "little or big, and bytes to skip in each file, such as 256x256,int16,big"
            )
        kind = np.dtype(found[4]).newbyteorder(">" if found[5] == "big" else "<")
        slices = int(found[3]) if found[3] else None
        return cls(numbers[0], numbers[1], slices, kind, int(found[6] or 0))


def read_raw(
    path: Path, layout: RawLayout, *, voxel: Size | None, max_voxels: int, progress: Progress
) -> RawScan:
    """Reads a file, or a folder of files, of raw voxels.

    Raises:
        OptionError: The size of a voxel is not given.
        VolumeFormatError: The files do not hold what the layout says.
    """
    spacing = _asked(path, voxel)
    files = in_order(path.iterdir()) if path.is_dir() else [path]
    if not files:
        raise VolumeFormatError(f"{path} is an empty folder; allowed: a folder of raw slices")
    pixels = layout.columns * layout.rows
    counts = [_slices_in(file, layout) for file in files]
    if layout.slices not in (None, sum(counts)):
        raise VolumeFormatError(
            f"{path} holds {sum(counts)} slices of {layout.columns} x {layout.rows} "
            f"{layout.kind.name}; the layout says {layout.slices}"
            "; allowed: a layout that fits, with bytes to skip where files have headers"
        )
    check_shape(str(path), (layout.columns, layout.rows, sum(counts)), max_voxels)
    parts = []
    for number, (file, count) in enumerate(zip(files, counts, strict=True)):
        progress(f"reading {len(files)} files", number / len(files))
        part = np.fromfile(file, layout.kind, count * pixels, offset=layout.skip)
        parts.append(part.astype(layout.kind.newbyteorder("="), copy=False))
    values = np.concatenate(parts).reshape(-1, layout.rows, layout.columns)
    return _scan(path, values, spacing)


def _slices_in(file: Path, layout: RawLayout) -> int:
    held = file.stat().st_size - layout.skip
    each = layout.columns * layout.rows * layout.kind.itemsize
    if held < each or held % each:
        raise VolumeFormatError(
            f"{file} holds {held} bytes of voxels, which are no whole slices of {layout.columns} x "
            f"{layout.rows} {layout.kind.name} = {each} bytes; allowed: files that fit the layout"
        )
    return held // each


# --- pictures ---------------------------------------------------------------------------


def is_picture(path: Path) -> bool:
    """Says whether a file is named as a picture."""
    return path.name.lower().endswith(PICTURES) and path.is_file()


def holds_pictures(folder: Path) -> bool:
    """Says whether a folder is a stack of pictures, beside hidden files and notes."""
    names = [path for path in in_order(folder.iterdir()) if path.suffix.lower() != ".txt"]
    return bool(names) and all(is_picture(path) for path in names)


def read_pictures(
    path: Path, *, voxel: Size | None, max_voxels: int, progress: Progress
) -> RawScan:
    """Reads a folder of PNG, TIFF, BMP or JPEG slices, or one file with many pages.

    Raises:
        OptionError: The size of a voxel is not given.
        VolumeFormatError: They are damaged, coloured, or of several sizes.
    """
    spacing = _asked(path, voxel)
    files = [path]
    if path.is_dir():
        files = [file for file in in_order(path.iterdir()) if is_picture(file)]
    parts: list[NDArray[Any]] = []
    for number, file in enumerate(files):
        progress(f"reading {len(files)} pictures", number / len(files))
        parts.append(_picture(file))
        if parts[-1].shape[1:] != parts[0].shape[1:]:
            first, other = ("{2} x {1}".format(*part.shape) for part in (parts[0], parts[-1]))
            raise VolumeFormatError(
                f"{file} has {other} pixels, {files[0].name} has {first}; allowed: slices of one "
                "size"
            )
        depth = max(len(files), len(parts[0]))
        check_shape(str(path), (*parts[0].shape[:0:-1], depth), max_voxels)
    return _scan(path, np.concatenate(parts), spacing)


def _picture(file: Path) -> NDArray[Any]:
    """Returns a picture's pages, shape [pages, rows, columns]; grey ones also from colour files."""
    sitk = simpleitk()
    try:
        image = sitk.ReadImage(str(file))
    except RuntimeError as error:
        raise VolumeFormatError(
            f"{file} cannot be read ({reason_of(error)}); allowed: complete, undamaged pictures"
        ) from None
    values: NDArray[Any] = sitk.GetArrayFromImage(image)
    if image.GetNumberOfComponentsPerPixel() > 1:
        if (values[..., :3] != values[..., :1]).any():
            raise VolumeFormatError(
                f"{file} is coloured; allowed: grey pictures, one intensity per pixel"
            )
        values = values[..., 0]
    return values.reshape(-1, *values.shape[-2:])


# --- both -------------------------------------------------------------------------------


def _asked(path: Path, voxel: Size | None) -> Size:
    if voxel is None:
        raise OptionError(
            f"{path} does not say how large its voxels are; allowed: with --voxel-size X,Y,Z [mm], "
            "such as 0.5,0.5,1.25"
        )
    if not all(np.isfinite(voxel)) or min(voxel) <= 0.0:
        raise OptionError(f"voxel size {voxel} mm given; allowed: three lengths above 0")
    return voxel


def in_order(paths: Iterable[Path]) -> Sequence[Path]:
    """Lists files by name, numbers in it as numbers, without hidden ones."""
    files = [path for path in paths if path.is_file() and not path.name.startswith(".")]
    return sorted(files, key=_by_number)


def _by_number(path: Path) -> list[tuple[int, int, str]]:
    parts = re.split(r"(\d+)", path.name)
    return [(0, int(part), "") if part.isdecimal() else (1, 0, part) for part in parts if part]


def _scan(path: Path, values: NDArray[Any], spacing: Size) -> RawScan:
    return RawScan(
        values=values,
        spacing=spacing,
        origin=(0.0, 0.0, 0.0),
        direction=np.eye(3),
        name=path.stem if path.is_file() else path.name,
        orientation_known=False,
    )
