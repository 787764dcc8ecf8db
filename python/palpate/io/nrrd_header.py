"""Headers of NRRD files, checked before a library sees them.

teem prints patterns of file names as formats of any width, and makes room for what sizes promise.

Source: teem, "Definition of NRRD File Format", sections 4 (fields) and 5 (detached headers).
"""

from __future__ import annotations

import math
import re
from pathlib import Path

from palpate.base.errors import VolumeFormatError
from palpate.io.detached_voxels import DEFLATE_RATIO, check_held, numbered, voxel_file
from palpate.io.payload import header_text

__all__ = ["check_nrrd"]

MOST_HEADER = 1 << 24
"""Of the header itself [bytes]: those of segmentations and of diffusion are long."""
MOST_AXES = 16
"""That teem has room for (NRRD_DIM_MAX)."""
NUMBER_BYTES = {
    name: size
    for size, names in {
        1: "int8 uint8 char uchar int8_t uint8_t signed_char unsigned_char",
        2: "short ushort int16 uint16 int16_t uint16_t signed_short signed_short_int short_int "
        "unsigned_short unsigned_short_int",
        4: "int uint int32 uint32 int32_t uint32_t signed_int unsigned_int float",
        8: "longlong ulonglong int64 uint64 int64_t uint64_t long_long long_long_int "
        "signed_long_long signed_long_long_int unsigned_long_long unsigned_long_long_int double",
    }.items()
    for name in names.split()
}
LARGEST = 1e9
"""Of a length or place, of whatever unit."""
VECTORS = ("space directions", "space origin", "spacings", "axis mins", "axis maxs", "thicknesses")
"""Fields of numbers; "nan" and "none" stand for none of them."""


def check_nrrd(path: Path) -> None:
    """Refuses a header that promises what its files do not hold, or names other files.

    Raises:
        VolumeFormatError: It does.
    """
    fields, rest, end = _fields(path)
    size = _size(path, fields)
    for key in VECTORS:
        _check_vectors(path, key, fields.get(key, ""))
    files = _files(path, fields, rest=rest, size=size)
    skipped = _skipped(path, fields, most=max(file.stat().st_size for file in files))
    encoding = fields.get("encoding", "").lower()
    numbers, each = math.prod(size), NUMBER_BYTES[fields["type"].replace(" ", "_")]
    wanted, ratio = numbers * each, 1
    if encoding in ("gzip", "gz"):
        ratio = DEFLATE_RATIO
    elif encoding in ("hex",):
        wanted *= 2
    elif encoding in ("txt", "text", "ascii"):
        # of text, a digit and a space for each number
        wanted = 2 * numbers - 1
    elif encoding != "raw":
        raise VolumeFormatError(
            f"{path} has encoding {encoding[:80]!r}; allowed: raw, gzip, hex and text"
        )
    elif files == [path]:
        wanted += end
    if not skipped or ratio == 1:
        check_held(path, files, wanted=wanted, ratio=ratio)
    for file in files if len(files) > 1 and encoding == "raw" else ():
        check_held(file, [file], wanted=wanted // len(files))


def _fields(path: Path) -> tuple[dict[str, str], list[str], int]:
    """Returns the fields of a header, lines after a LIST, and the byte at which it ends."""
    fields: dict[str, str] = {}
    listed: list[str] | None = None
    with path.open("rb") as file:
        if not file.read(8).startswith(b"NRRD000"):
            raise VolumeFormatError(
                f"{path} is no readable nrrd file (it does not begin with NRRD000); allowed: "
                "complete, undamaged files"
            )
        while (line := file.readline(MOST_HEADER)) and file.tell() <= MOST_HEADER:
            text = header_text(line).strip()
            if listed is not None:
                listed += [text] if text else []
                continue
            if not text and line.strip(b"\r\n") == b"":
                # the first line may have had more than its mark
                if file.tell() > 10 or fields:
                    break
                continue
            key, separator, value = text.partition(":")
            if not separator or text.startswith("#") or value.startswith("="):
                continue
            key = key.strip().lower().replace("datafile", "data file")
            if key in fields:
                raise VolumeFormatError(f"{path} tells {key[:80]!r} twice; allowed: once")
            fields[key] = value.strip()
            if key == "data file" and fields[key].split(" ")[0] == "LIST":
                listed = []
        return fields, listed or [], file.tell()


def _size(path: Path, fields: dict[str, str]) -> list[int]:
    told = fields.get("dimension", "")
    if not re.fullmatch(r"\d{1,2}", told) or not 1 <= int(told) <= MOST_AXES:
        raise VolumeFormatError(f"{path} has dimension {told[:80]!r}; allowed: 1 to {MOST_AXES}")
    sizes = fields.get("sizes", "").split()
    if len(sizes) != int(told) or not all(re.fullmatch(r"0*[1-9]\d{0,9}", one) for one in sizes):
        raise VolumeFormatError(
            f"{path} has sizes {' '.join(sizes)[:80]!r}; allowed: {told} numbers above 0, as its "
            "dimension says"
        )
    if fields.get("type", "").replace(" ", "_") not in NUMBER_BYTES:
        raise VolumeFormatError(
            f"{path} has type {fields.get('type', '')[:80]!r}; allowed: int8 to int64, unsigned "
            "too, float and double"
        )
    return [int(one) for one in sizes]


def _check_vectors(path: Path, key: str, value: str) -> None:
    for word in re.split(r"[(),\s]+", value):
        if word.lower() in ("", "none", "nan"):
            continue
        try:
            fits = abs(float(word)) < LARGEST
        except ValueError:
            fits = False
        if not fits:
            raise VolumeFormatError(f"{path} has {key} {value[:80]!r}; allowed: finite numbers")


def _skipped(path: Path, fields: dict[str, str], *, most: int) -> bool:
    """Says whether something is left out before the voxels."""
    skipped = False
    for key, low in (("line skip", 0), ("byte skip", -1)):
        told = fields.get(key, fields.get(key.replace(" ", ""), "0"))
        if not re.fullmatch(r"[+-]?\d{1,18}", told) or not low <= int(told) <= max(most, 1 << 30):
            raise VolumeFormatError(f"{path} has {key} {told[:80]!r}; allowed: {low} or more")
        skipped = skipped or int(told) != 0
    return skipped


def _files(path: Path, fields: dict[str, str], *, rest: list[str], size: list[int]) -> list[Path]:
    """Returns all files that hold voxels."""
    name = fields.get("data file", "")
    words = name.split()
    if not words:
        return [path]
    if words[0] == "LIST":
        named = rest
        axes = words[1] if len(words) > 1 else str(len(size) - 1)
    elif "%" in name:
        if len(words) not in {4, 5}:
            raise VolumeFormatError(
                f"{path} names files {name[:100]!r}; allowed: a pattern, first, last and step"
            )
        named = numbered(path, words[0], words[1:4])
        axes = words[4] if len(words) > 4 else str(len(size) - 1)
    else:
        return [voxel_file(path, name)]
    # a file may also be a slab of the last axis
    in_one = int(axes) if re.fullmatch(r"\d{1,2}", axes) else -1
    slices = math.prod(size[in_one:]) if 0 <= in_one < len(size) else len(named)
    if not 0 < in_one <= len(size) or not named or len(named) != slices:
        raise VolumeFormatError(
            f"{path} names {len(named)} files for {slices} slices; allowed: one for each"
        )
    return [voxel_file(path, each) for each in named]
