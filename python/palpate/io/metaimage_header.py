"""Headers of MetaImage files, checked before a library sees them.

MetaIO takes sizes, names and counts as they are: it prints names as formats, writes beyond its
arrays and leaves memory as it was where files are missing.

Source: MetaIO documentation (Kitware), "MetaImage", "Reading a brick of bytes" and "List of files".
"""

from __future__ import annotations

import math
import re
from itertools import islice
from pathlib import Path

from palpate.base.errors import VolumeFormatError
from palpate.io.detached_voxels import DEFLATE_RATIO, check_held, numbered, voxel_file
from palpate.io.payload import header_text

__all__ = ["check_metaimage"]

MOST_HEADER = 1 << 20
"""Of the header itself [bytes]."""
MOST_AXES = 10
"""That MetaIO has room for."""
MOST_NUMBERS = {"DimSize": 1, "ElementSpacing": 1, "ElementSize": 1, "Offset": 1, "Position": 1,
                "Origin": 1, "CenterOfRotation": 1, "TransformMatrix": 2, "Orientation": 2,
                "Rotation": 2}  # fmt: skip
"""Fields of one number for each axis, or for each pair of axes."""
SWITCHES = "BinaryData", "BinaryDataByteOrderMSB", "ElementByteOrderMSB", "CompressedData"
"""Fields that are true or false."""
MOST_NAME = 255
"""Letters of a Name; MetaIO writes beyond the room that it has without asking."""
LARGEST = 1e9
"""Of a length or place [mm]."""
TYPE_BYTES = {
    "MET_CHAR": 1, "MET_UCHAR": 1, "MET_SHORT": 2, "MET_USHORT": 2, "MET_INT": 4, "MET_UINT": 4,
    "MET_LONG": 4, "MET_ULONG": 4, "MET_LONG_LONG": 8, "MET_ULONG_LONG": 8, "MET_FLOAT": 4,
    "MET_DOUBLE": 8,
}  # fmt: skip


def check_metaimage(path: Path) -> None:
    """Refuses a header that promises what its files do not hold, or names other files.

    Raises:
        VolumeFormatError: It does.
    """
    fields, rest = _fields(path)
    _check_words(path, fields)
    size = _size(path, fields)
    _check_numbers(path, fields, axes=len(size))
    name = fields["ElementDataFile"]
    files = _files(path, name, rest=rest, size=size)
    packed = fields.get("CompressedData", "").lower() in ("true", "1")
    text = fields.get("BinaryData", "True").lower() in ("false", "0")
    if packed and text:
        # MetaIO frees a part of it twice
        raise VolumeFormatError(
            f"{path} has BinaryData False and CompressedData True; allowed: one of both"
        )
    channels = _whole(path, fields, "ElementNumberOfChannels", low=1, high=1 << 16, otherwise=1)
    _whole(path, fields, "HeaderSize", low=-1, high=files[0].stat().st_size, otherwise=0)
    numbers = math.prod(size) * channels
    # of text, a digit and a space for each number
    wanted = 2 * numbers - 1 if text else numbers * TYPE_BYTES[fields["ElementType"]]
    check_held(path, files, wanted=wanted, ratio=DEFLATE_RATIO if packed else 1)
    for file in files if len(files) > 1 and not packed else ():
        check_held(file, [file], wanted=wanted // len(files))


def _fields(path: Path) -> tuple[dict[str, str], list[str]]:
    """Returns the fields of a header, and the lines after it that may name files."""
    fields: dict[str, str] = {}
    with path.open("rb") as file:
        head = file.read(MOST_HEADER)
    lines = iter(head.split(b"\n"))
    for line in lines:
        text = header_text(line).rstrip("\r")
        key, value = _parted(text)
        if "elementdatafile" in text.lower() and (key != "ElementDataFile" or not value):
            raise VolumeFormatError(
                f"{path} has a line {text[:80]!r}; allowed: ElementDataFile = …"
            )
        if key in fields and key in {*MOST_NUMBERS, "NDims", "ElementType"}:
            raise VolumeFormatError(f"{path} tells {key} twice; allowed: once")
        fields[key] = value
        if key == "ElementDataFile":
            named = [header_text(each).strip() for each in islice(lines, 1 << 16)]
            return fields, named if value.split()[0] == "LIST" else []
    raise VolumeFormatError(
        f"{path} is no readable metaimage file (no ElementDataFile in its header); allowed: "
        "complete, undamaged files"
    )


def _parted(line: str) -> tuple[str, str]:
    found = re.match(r"\s*([^=:]*?)\s*[=:]\s*(.*?)\s*$", line)
    return (found[1], found[2]) if found else ("", "")


def _check_words(path: Path, fields: dict[str, str]) -> None:
    """Refuses words of which MetaIO makes something else, or too much."""
    for key in SWITCHES:
        told = fields.get(key, "False")
        if told.lower() not in ("true", "false", "1", "0"):
            raise VolumeFormatError(f"{path} has {key} {told[:80]!r}; allowed: True or False")
    name = fields.get("Name", "").encode()
    if len(name) > MOST_NAME:
        raise VolumeFormatError(
            f"{path} has a Name of {len(name)} letters; allowed: at most {MOST_NAME}"
        )


def _size(path: Path, fields: dict[str, str]) -> list[int]:
    axes = _whole(path, fields, "NDims", low=2, high=MOST_AXES)
    told = fields.get("DimSize", "").split()
    if len(told) != axes or not all(re.fullmatch(r"[1-9]\d{0,9}", length) for length in told):
        raise VolumeFormatError(
            f"{path} has DimSize {' '.join(told)[:80]!r}; allowed: {axes} numbers above 0, as "
            "NDims says"
        )
    if fields.get("ElementType") not in TYPE_BYTES:
        raise VolumeFormatError(
            f"{path} has ElementType {fields.get('ElementType', '')[:80]!r}; allowed: "
            f"{', '.join(TYPE_BYTES)}"
        )
    return [int(length) for length in told]


def _check_numbers(path: Path, fields: dict[str, str], *, axes: int) -> None:
    for key, power in MOST_NUMBERS.items():
        if key not in fields:
            continue
        told = fields[key].split()
        if len(told) != axes**power or not all(_is_finite(number) for number in told):
            raise VolumeFormatError(
                f"{path} has {key} {' '.join(told)[:80]!r}; allowed: {axes**power} finite numbers"
            )
    spacing = fields.get("ElementSpacing", fields.get("ElementSize", "1")).split()
    if any(float(length) == 0.0 for length in spacing):
        raise VolumeFormatError(
            f"{path} has voxels of {' x '.join(spacing)[:80]} mm; allowed: lengths above 0"
        )


def _is_finite(number: str) -> bool:
    try:
        return abs(float(number)) < LARGEST and "_" not in number
    except ValueError:
        return False


def _whole(
    path: Path, fields: dict[str, str], key: str, *, low: int, high: int, otherwise: int = 0
) -> int:
    told = fields.get(key, str(otherwise))
    if not re.fullmatch(r"[+-]?\d{1,18}", told) or not low <= int(told) <= high:
        raise VolumeFormatError(f"{path} has {key} {told[:80]!r}; allowed: {low} to {high}")
    return int(told)


def _files(path: Path, name: str, *, rest: list[str], size: list[int]) -> list[Path]:
    """Returns all files that hold voxels."""
    words = name.split()
    if name.upper() == "LOCAL":
        return [path]
    if words[0] == "LIST":
        axes = re.fullmatch(r"(\d)D?", words[1]) if len(words) == 2 else None
        in_one = int(axes[1]) if axes else len(size) - 1
        named = rest[: math.prod(size[in_one:])]
    elif "%" in name:
        in_one = len(size) - 1
        named = numbered(path, words[0], words[1:] or ["1", str(size[-1]), "1"])
    else:
        return [voxel_file(path, name)]
    slices = math.prod(size[in_one:])
    there = len([each for each in named if each])
    if there != slices or not 1 <= in_one < len(size):
        raise VolumeFormatError(
            f"{path} names {there} files for {slices} slices; allowed: one for each"
        )
    return [voxel_file(path, each) for each in named]
