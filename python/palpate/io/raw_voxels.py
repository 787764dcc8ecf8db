"""Raw voxels whose layout a person states, and stacks of pictures.

Neither says how large a voxel is or how it lies in the patient: the size is asked for, the
orientation can be given.

Layout: a file holds whole slices, x fastest; the slices of a folder come in the order of their
names, with numbers read as numbers. Arrays are [z, y, x].
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError, VolumeFormatError
from palpate.base.progress import Progress
from palpate.base.simpleitk import reason_of, simpleitk
from palpate.io.header_check import check_header
from palpate.io.raw_scan import RawScan, check_shape

__all__ = [
    "TYPES",
    "RawLayout",
    "holds_pictures",
    "in_order",
    "is_picture",
    "picture_at",
    "picture_files",
    "picture_size",
    "raw_files",
    "raw_size",
    "raw_slice",
    "read_pictures",
    "read_raw",
]

TYPES = ("int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64")
PICTURES = {
    ".png": "PNGImageIO",
    ".tif": "TIFFImageIO",
    ".tiff": "TIFFImageIO",
    ".bmp": "BMPImageIO",
    ".jpg": "JPEGImageIO",
    ".jpeg": "JPEGImageIO",
}
"""Endings of pictures, and each format's reader in ITK: it would try others by their bytes."""
MOST_PACKED = 5000
"""Times that a picture may be larger than its file: runs of one grey reach 2700 (LZW)."""

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

    @property
    def slice_bytes(self) -> int:
        """What one slice takes."""
        return self.columns * self.rows * self.kind.itemsize

    def told(self) -> str:
        """Returns what a person calls it, such as ``256 x 256 x 113 int16``."""
        edges = (self.columns, self.rows, *([] if self.slices is None else [self.slices]))
        after = f" after {self.skip} bytes" if self.skip else ""
        return f"{' x '.join(map(str, edges))} {self.kind.name}{after}"


def read_raw(
    path: Path, layout: RawLayout, *, voxel: Size | None, max_voxels: int, progress: Progress
) -> RawScan:
    """Reads a file, or a folder of files, of raw voxels.

    Raises:
        OptionError: The size of a voxel is not given.
        VolumeFormatError: The files do not hold what the layout says.
    """
    spacing = _asked(path, voxel)
    counts = _counts(path, layout, max_voxels)
    pixels = layout.columns * layout.rows
    parts = []
    for number, (file, count) in enumerate(counts):
        progress(f"reading {len(counts)} files", number / len(counts))
        part = np.fromfile(file, layout.kind, count * pixels, offset=layout.skip)
        parts.append(part.astype(layout.kind.newbyteorder("="), copy=False))
    values = np.concatenate(parts).reshape(-1, layout.rows, layout.columns)
    return _scan(path, values, spacing)


def raw_files(path: Path) -> Sequence[Path]:
    """Lists the files of raw voxels at a path, in the order of their slices.

    Raises:
        VolumeFormatError: There is none.
    """
    files = in_order(path.iterdir()) if path.is_dir() else [path]
    if not files:
        raise VolumeFormatError(f"{path} is an empty folder; allowed: a folder of raw slices")
    return files


def raw_size(path: Path, layout: RawLayout, *, max_voxels: int) -> tuple[int, int, int]:
    """Returns the voxels along x, y, z that are at a path by a layout.

    Raises:
        VolumeFormatError: The files do not hold what the layout says.
    """
    slices = sum(count for _, count in _counts(path, layout, max_voxels))
    return layout.columns, layout.rows, slices


def raw_slice(path: Path, layout: RawLayout, number: int) -> NDArray[Any]:
    """Returns one slice of those that are at a path by a layout, shape [rows, columns].

    Raises:
        VolumeFormatError: The files do not hold it.
    """
    for file in raw_files(path):
        count = _slices_in(file, layout, None)
        if number < count:
            offset = layout.skip + number * layout.slice_bytes
            pixels = layout.columns * layout.rows
            values: NDArray[Any] = np.fromfile(file, layout.kind, pixels, offset=offset)
            return values.reshape(layout.rows, layout.columns)
        number -= count
    raise VolumeFormatError(f"{path} holds fewer slices; allowed: one of them")


def _counts(path: Path, layout: RawLayout, max_voxels: int) -> list[tuple[Path, int]]:
    """Returns how many slices each file holds, once they fit the layout."""
    files = raw_files(path)
    wanted = layout.slices if len(files) == 1 else None
    counts = [(file, _slices_in(file, layout, wanted)) for file in files]
    slices = sum(count for _, count in counts)
    if layout.slices not in {None, slices}:
        raise VolumeFormatError(
            f"{path} holds {slices} slices in {len(files)} files; {layout.told()} asks "
            f"{layout.slices}; allowed: {slices}, or bytes to skip where files have headers"
        )
    check_shape(str(path), (layout.columns, layout.rows, slices), max_voxels)
    return counts


def _slices_in(file: Path, layout: RawLayout, wanted: int | None) -> int:
    """Returns how many slices a file holds: as many as ``wanted``, or as are in it."""
    held, each = file.stat().st_size, layout.slice_bytes
    count, rest = divmod(held - layout.skip, each)
    if count < 1 or rest or wanted not in {None, count}:
        asked = layout.skip + each * (wanted or 1)
        more = "" if wanted else f" and {each} for each slice more"
        fits = ", or ".join(_fits(held, layout, wanted)) or "other columns and rows"
        raise VolumeFormatError(
            f"{file} has {held} bytes; {layout.told()} asks {asked}{more}; allowed: {fits}"
        )
    return count


def _fits(held: int, layout: RawLayout, wanted: int | None) -> list[str]:
    """Says which changes of a layout would fit so many bytes, each alone."""
    each, after = layout.slice_bytes, held - layout.skip
    fits = [f"{after // each} slices"] if wanted and after >= each and after % each == 0 else []
    spare = held - each * wanted if wanted else held % each
    if spare != layout.skip and 0 <= spare <= held - each:
        fits.append(f"{spare} bytes to skip")
    for kind in ("uint8", "int16", "float32", "float64"):
        slice_ = layout.columns * layout.rows * np.dtype(kind).itemsize
        whole = after == slice_ * wanted if wanted else after >= slice_ and after % slice_ == 0
        if slice_ != each and whole:
            fits.append(f"numbers of {kind}")
    return fits


# --- pictures ---------------------------------------------------------------------------


def is_picture(path: Path) -> bool:
    """Says whether a file is named as a picture."""
    return path.suffix.lower() in PICTURES and path.is_file()


def holds_pictures(folder: Path) -> bool:
    """Says whether a folder is a stack of pictures, beside hidden files and notes."""
    names = [path for path in in_order(folder.iterdir()) if path.suffix.lower() != ".txt"]
    return bool(names) and all(is_picture(path) for path in names)


def picture_files(path: Path) -> Sequence[Path]:
    """Lists the pictures at a path, in the order of their slices."""
    if not path.is_dir():
        return [path]
    return [file for file in in_order(path.iterdir()) if is_picture(file)]


def picture_size(path: Path) -> tuple[tuple[int, int, int], tuple[float, float] | None]:
    """Returns the voxels along x, y, z of a stack, and its pixels [mm] where the files tell them.

    Raises:
        VolumeFormatError: The first of them cannot be read.
    """
    files = picture_files(path)
    reader = _opened(files[0])
    columns, rows, *pages = reader.GetSize()
    across, down = reader.GetSpacing()[:2]
    # 1 is what readers say where a file says nothing
    told = (
        not np.allclose((across, down), 1.0)
        and 0.0 < min(across, down) <= max(across, down) < np.inf
    )
    slices = len(files) if len(files) > 1 else int(np.prod(pages, dtype=np.int64))
    return (columns, rows, slices), (across, down) if told else None


def picture_at(path: Path, number: int) -> NDArray[Any]:
    """Returns one slice of a stack, shape [rows, columns].

    Raises:
        VolumeFormatError: It is damaged or coloured.
    """
    files = picture_files(path)
    pages = _picture(files[number] if len(files) > 1 else files[0])
    found: NDArray[Any] = pages[0 if len(files) > 1 else number]
    return found


def read_pictures(
    path: Path, *, voxel: Size | None, max_voxels: int, progress: Progress
) -> RawScan:
    """Reads a folder of PNG, TIFF, BMP or JPEG slices, or one file with many pages.

    Raises:
        OptionError: The size of a voxel is not given.
        VolumeFormatError: They are damaged, coloured, or of several sizes.
    """
    spacing = _asked(path, voxel)
    files = picture_files(path)
    parts: list[NDArray[Any]] = []
    for number, file in enumerate(files):
        progress(f"reading {len(files)} pictures", number / len(files))
        size = _opened(file).GetSize()
        check_shape(str(path), (*size[:2], max(len(files), *size[2:], 2)), max_voxels)
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


def _opened(file: Path) -> Any:  # noqa: ANN401  # SimpleITK has no types
    """Returns a reader that has read a picture's header, which its file can hold."""
    check_header(file)
    reader = simpleitk().ImageFileReader()
    reader.SetFileName(str(file))
    reader.SetImageIO(PICTURES[file.suffix.lower()])
    try:
        reader.ReadImageInformation()
    except RuntimeError as error:
        raise _damaged(file, error) from None
    size, held = reader.GetSize(), file.stat().st_size
    if math.prod(size) > MOST_PACKED * held:
        raise VolumeFormatError(
            f"{file} announces {' x '.join(map(str, size))} pixels in {held} bytes; allowed: at "
            f"most {MOST_PACKED} for each byte"
        )
    return reader


def _picture(file: Path) -> NDArray[Any]:
    """Returns a picture's pages, shape [pages, rows, columns]; grey ones also from colour files."""
    sitk = simpleitk()
    reader = _opened(file)
    try:
        image = reader.Execute()
    except RuntimeError as error:
        raise _damaged(file, error) from None
    values: NDArray[Any] = sitk.GetArrayFromImage(image)
    if image.GetNumberOfComponentsPerPixel() > 1:
        if (values[..., :3] != values[..., :1]).any():
            raise VolumeFormatError(
                f"{file} is coloured; allowed: grey pictures, one intensity per pixel"
            )
        values = values[..., 0]
    return values.reshape(-1, *values.shape[-2:])


def _damaged(file: Path, error: RuntimeError) -> VolumeFormatError:
    return VolumeFormatError(
        f"{file} cannot be read ({reason_of(error)}); allowed: complete, undamaged pictures"
    )


# --- both -------------------------------------------------------------------------------


def _asked(path: Path, voxel: Size | None) -> Size:
    if voxel is None:
        raise OptionError(
            f"{path} does not say how large its voxels are; allowed: with `voxel_size=X,Y,Z` [mm], "
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
