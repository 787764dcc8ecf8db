"""Scans whose files do not tell how they are laid out: what is there, what is likely of it.

Raw voxels tell nothing. What is likely of them comes from names, such as ``head_64x64x40_int16``,
from how many bytes there are, and from the values: rows beside one another are alike where their
length, the kind of numbers and the order of bytes are right. Pictures lack the size of voxels only.

Layout: as in ``raw_voxels``.
"""

from __future__ import annotations

import math
import re
from codecs import getincrementaldecoder
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError, VolumeFormatError
from palpate.base.reader_process import apart
from palpate.io.archive import is_archive
from palpate.io.dicom.series import is_dicom
from palpate.io.image_file import FORMATS, image_files
from palpate.io.raw_voxels import (
    TYPES,
    RawLayout,
    holds_pictures,
    is_picture,
    picture_at,
    picture_files,
    picture_size,
    raw_files,
    raw_size,
    raw_slice,
)

__all__ = ["Headerless", "headerless_pictures", "headerless_raw", "laid_out"]

Size = tuple[int, int, int]
Lengths = tuple[float, float, float]

MOST_HEADER = 1 << 16
"""Of bytes before the voxels that are taken for a header."""
MOST_SAMPLE = 1 << 20
"""Of a file that is looked into [bytes]."""
LEAST_BYTES = 64
"""Of a file of voxels."""
BETTER = 0.8
"""By which numbers of another kind have to be smoother than those that are more usual."""
SIDES = (512, 256, 1024, 128, 384, 320, 640, 768, 64, 2048)
"""Of slices, the more usual ones first."""
KINDS = (
    ("uint16", r"uint16|ushort|u16|16ubit"),
    ("int16", r"int16|short|s16|i16|16bit"),
    ("uint8", r"uint8|uchar|u8|byte|8u?bit"),
    ("int8", r"int8|char|i8"),
    ("float64", r"float64|double|f64"),
    ("float32", r"float32|float|f32"),
    ("uint32", r"uint32|u32|uint"),
    ("int32", r"int32|i32"),
)
"""Words for kinds of numbers in names of files."""
ORDERS = (
    (">", r"be|big|bigendian|big-endian|msb"),
    ("<", r"le|little|littleendian|little-endian|lsb"),
)
USUAL = ("<i2", ">i2", "u1", "<u2", ">u2", "<f4", ">f4", "<f8", ">f8")
EDGES = re.compile(r"(?<![\d.])(\d{1,5})([x×_])(\d{1,5})(?:\2(\d{1,5}))?(?!\d|\.\d|\s*mm)")
LENGTHS = re.compile(r"(\d*\.?\d+)([x×_])(\d*\.?\d+)\2(\d*\.?\d+)\s*mm")


@dataclass(frozen=True)
class Headerless:
    """Files whose layout, or the size of whose voxels, is to be told."""

    path: Path
    name: str
    """Of the file or folder."""
    begins: str
    """What names of the files begin with; "" where that is nothing."""
    files: int
    held: int
    """In all files together [bytes]."""
    pictures: bool
    layout: RawLayout | None
    """What is likely of raw voxels; None of pictures."""
    size: Size | None
    """Of pictures: voxels along x, y, z."""
    voxel: tuple[float | None, float | None, float | None]
    """Along x, y, z [mm], as far as files or their names tell."""


def headerless_pictures(path: Path) -> Headerless | None:
    """Returns what is told of a stack of pictures; None where there is none.

    Raises:
        VolumeFormatError: The first of them cannot be read.
    """
    if not (holds_pictures(path) if path.is_dir() else is_picture(path)):
        return None
    files = picture_files(path)
    size, pixel = apart(picture_size, path, path=path)
    if size[2] < 2:
        return None
    across, down = pixel or (None, None)
    told = _voxel_named(path.name) or (across, down, None)
    return _headerless(path, files, layout=None, size=size, voxel=told)


def headerless_raw(path: Path) -> Headerless | None:
    """Returns what is told and likely of raw voxels; None where something else is there."""
    try:
        files = raw_files(path)
    except VolumeFormatError:
        return None
    if path.is_dir() and image_files(path, among=len(files)):
        return None
    if not all(_is_raw(file) for file in files):
        return None
    voxel = _voxel_named(path.name) or (None, None, None)
    return _headerless(path, files, layout=_likely(path, files), size=None, voxel=voxel)


def laid_out(
    path: Path, layout: RawLayout | None, *, max_voxels: int = 1024**3
) -> tuple[Size, NDArray[Any]]:
    """Returns the voxels along x, y, z that a layout gives, and its middle slice [rows, columns].

    Of pictures, where there is no layout, each is a slice.

    Raises:
        VolumeFormatError: The files do not hold what the layout says.
        OptionError: There is no layout, and these are no pictures.
    """
    if layout is not None:
        size = raw_size(path, layout, max_voxels=max_voxels)
        return size, raw_slice(path, layout, size[2] // 2)
    if not picture_files(path) or not is_picture(picture_files(path)[0]):
        raise OptionError(f"no layout given for {path}; allowed: for pictures")
    size, _ = apart(picture_size, path, path=path)
    return size, apart(picture_at, path, size[2] // 2, path=path)


def _headerless(
    path: Path,
    files: Sequence[Path],
    *,
    layout: RawLayout | None,
    size: Size | None,
    voxel: tuple[float | None, float | None, float | None],
) -> Headerless:
    return Headerless(
        path=path,
        name=path.name if path.is_dir() else path.stem,
        begins=_beginning([file.stem for file in files]),
        files=len(files),
        held=sum(file.stat().st_size for file in files),
        pictures=layout is None,
        layout=layout,
        size=size,
        voxel=voxel,
    )


def _beginning(names: Sequence[str]) -> str:
    """Returns the letters that names begin with; "" where they do not."""
    first, last = min(names), max(names)
    alike = next((i for i, (a, b) in enumerate(zip(first, last, strict=False)) if a != b), None)
    return first[:alike].strip("0123456789 ._-")


def _is_raw(file: Path) -> bool:
    """Says whether a file may be voxels and nothing else: no format that is known, and no text."""
    name, held = file.name.lower(), file.stat().st_size
    others = tuple(ending for endings in FORMATS.values() for ending in endings)
    # the voxels of a NIfTI pair are called .img, and so are many that have no header
    lone = name.endswith(".img") and not file.with_suffix(".hdr").exists()
    if held < LEAST_BYTES or is_picture(file) or (name.endswith(others) and not lone):
        return False
    if is_archive(file) or is_dicom(file):
        return False
    with file.open("rb") as opened:
        head = opened.read(4096)
    try:
        # the last letter may be cut
        return "\0" in getincrementaldecoder("utf-8")().decode(head)
    except UnicodeDecodeError:
        return True


# --- what is likely -----------------------------------------------------------------------


def _voxel_named(name: str) -> Lengths | None:
    found = LENGTHS.search(name)
    return (float(found[1]), float(found[3]), float(found[4])) if found else None


def _likely(path: Path, files: Sequence[Path]) -> RawLayout:
    """Returns the layout whose rows are most alike, among those that fit the bytes and names."""
    middle = files[len(files) // 2]
    held = middle.stat().st_size
    name = f"{path.name} {middle.name}".lower()
    with middle.open("rb") as opened:
        opened.seek(max(0, held // 2 - MOST_SAMPLE // 2) // 8 * 8)
        start = opened.tell()
        sample = opened.read(MOST_SAMPLE)
    side = max(2, math.isqrt(held // 2))
    best, least = RawLayout(side, side, None, np.dtype("<i2"), 0), math.inf
    for layout in _fitting(name, held, alone=len(files) == 1):
        # the header may shift numbers against bytes
        rough = _roughness(sample[(layout.skip - start) % layout.kind.itemsize :], layout)
        # of rows of two lengths the right one wins, by however little
        if rough < (least if layout.kind == best.kind else BETTER * least):
            best, least = layout, rough
    return best


def _fitting(name: str, held: int, *, alone: bool) -> Iterator[RawLayout]:
    """Yields layouts that fit the bytes of a file, those that are told or more usual first."""
    kinds = _kinds(name)
    named = [
        (int(columns), int(rows), int(slices) if slices and alone else None)
        for columns, _, rows, slices in EDGES.findall(name)
        if min(int(columns), int(rows)) > 1
    ]
    found = False
    for columns, rows, slices in named:
        for kind in kinds:
            asked = columns * rows * (slices or 1) * kind.itemsize
            spare = held - asked if slices else held % asked
            if asked <= held and 0 <= spare <= MOST_HEADER:
                found = True
                yield RawLayout(columns, rows, slices, kind, spare)
    if not found:
        yield from _square(held, kinds, alone=alone)


def _square(held: int, kinds: Sequence[np.dtype[Any]], *, alone: bool) -> Iterator[RawLayout]:
    """Yields square slices: of any side without a header, of usual ones behind one."""
    for kind in kinds:
        side = round((held / kind.itemsize) ** (1 / 3)) if alone else 0
        if side > 1 and side**3 * kind.itemsize == held:
            yield RawLayout(side, side, side, kind, 0)
        side = 0 if alone else math.isqrt(held // kind.itemsize)
        if side > 1 and side**2 * kind.itemsize == held:
            yield RawLayout(side, side, None, kind, 0)
        for side in SIDES:
            slices, spare = divmod(held, side**2 * kind.itemsize)
            usual = 2 <= slices <= 4 * side if alone else slices == 1
            if usual and spare <= (0 if alone else MOST_HEADER):
                yield RawLayout(side, side, slices if alone else None, kind, spare)


def _kinds(name: str) -> list[np.dtype[Any]]:
    """Returns the kinds of numbers that a name allows."""
    told = next((kind for kind, words in KINDS if _says(name, words)), None)
    order = next((order for order, words in ORDERS if _says(name, words)), None)
    kinds = [np.dtype(each) for each in USUAL]
    if told is not None:
        both = [np.dtype(told).newbyteorder("<"), np.dtype(told).newbyteorder(">")]
        kinds = both if np.dtype(told).itemsize > 1 else both[:1]
    return [
        kind
        for kind in kinds
        if kind.name in TYPES and (order is None or kind.itemsize == 1 or kind.str[0] == order)
    ]


def _says(name: str, words: str) -> bool:
    return re.search(rf"(?<![a-z0-9])(?:{words})(?![a-z0-9])", name) is not None


def _roughness(sample: bytes, layout: RawLayout) -> float:
    """Returns how much rows differ from those beside them, by how much values vary at all."""
    whole = len(sample) // layout.kind.itemsize
    # numbers that are read the wrong way may be of any size, or none
    with np.errstate(all="ignore"):
        values = np.frombuffer(sample, layout.kind, whole).astype(np.float64)
        beside = values[layout.columns :]
        if not len(beside):
            return math.inf
        # not the standard deviation: that may be of the few that are largest
        spread = float(np.abs(values - np.median(values)).mean())
        rough = float(np.abs(beside - values[: len(beside)]).mean()) / spread if spread else 1.0
    return rough if math.isfinite(rough) else math.inf
