"""Checks that an image file holds all the bytes its header announces, undamaged.

SimpleITK takes damaged zlib data of any format without a word; so sizes and checksums are compared
here, before reading.

Sources of the formats: MetaIO documentation (Kitware), "MetaImage"; NRRD 5 definition (teem),
"Data file"; RFC 1950 and 1952.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from palpate.base.errors import VolumeFormatError

__all__ = ["Payload", "check_payload", "header_text", "metaimage_header", "nrrd_header"]

CHUNK = 1 << 20
ZLIB, GZIP = 15, 31
"""Window bits that tell Python's zlib which of the two wrappers to expect."""

METAIMAGE_BYTES = {
    "MET_CHAR": 1, "MET_UCHAR": 1, "MET_SHORT": 2, "MET_USHORT": 2, "MET_INT": 4, "MET_UINT": 4,
    "MET_LONG": 4, "MET_ULONG": 4, "MET_LONG_LONG": 8, "MET_ULONG_LONG": 8, "MET_FLOAT": 4,
    "MET_DOUBLE": 8,
}  # fmt: skip

NRRD_BYTES = {
    1: "int8 uint8 char uchar int8_t uint8_t signed_char unsigned_char",
    2: "short ushort int16 uint16 int16_t uint16_t signed_short unsigned_short short_int",
    4: "int uint int32 uint32 int32_t uint32_t signed_int unsigned_int float",
    8: "longlong ulonglong int64 uint64 int64_t uint64_t long_long double",
}


@dataclass(frozen=True)
class Payload:
    """Where the voxels of a file stand and how many bytes they must be."""

    path: Path
    start: int
    """Bytes before them."""
    size: int
    """Bytes of all voxels, decompressed."""
    wrapper: int | None = None
    """Window bits of the compression; None for plain bytes."""


def check_payload(path: Path, format_name: str) -> None:
    """Refuses a file whose voxels are incomplete or damaged.

    Args:
        path: The file, or the header where the voxels stand in another.
        format_name: ``metaimage`` or ``nrrd``.

    Raises:
        VolumeFormatError: Bytes are missing, or a checksum differs.
    """
    payload = {"metaimage": _metaimage, "nrrd": _nrrd}[format_name](path)
    if payload is None:
        return
    if not payload.path.is_file():
        raise VolumeFormatError(
            f"{path} names {payload.path.name} as the file of its voxels, which does not exist; "
            "allowed: both files in one folder"
        )
    if payload.wrapper is None:
        held = payload.path.stat().st_size - payload.start
    else:
        held = _decompressed_size(payload)
    if held < payload.size:
        raise VolumeFormatError(
            f"{payload.path} is truncated: its header announces {payload.size} bytes of voxels, "
            f"{max(held, 0)} are there; allowed: complete files"
        )


def _decompressed_size(payload: Payload) -> int:
    """Decompresses all members of a stream and returns how many bytes came out."""
    with payload.path.open("rb") as file:
        file.seek(payload.start)
        try:
            return sum(_sizes(file, payload.wrapper or ZLIB))
        except zlib.error as error:
            raise VolumeFormatError(
                f"{payload.path} is damaged: its compressed voxels do not fit their checksum "
                f"({error}); allowed: undamaged files"
            ) from None


def _sizes(file: BinaryIO, wrapper: int) -> Iterator[int]:
    """Yields how many bytes come out of a compressed file, in pieces of bounded memory."""
    stream = zlib.decompressobj(wrapper)
    while piece := file.read(CHUNK):
        while piece:
            yield len(stream.decompress(piece, CHUNK))
            piece = stream.unconsumed_tail
            if stream.eof:
                # another member may follow; anything else after the end is padding
                piece = stream.unused_data
                if wrapper != GZIP or not piece.startswith(b"\x1f\x8b"):
                    return
                stream = zlib.decompressobj(wrapper)


def header_text(line: bytes) -> str:
    """Returns text of a header: UTF-8, as programs write it today, else Latin-1."""
    try:
        return line.decode()
    except UnicodeDecodeError:
        return line.decode("latin-1")


# --- MetaImage --------------------------------------------------------------------------


def metaimage_header(path: Path) -> tuple[dict[str, str], int]:
    """Reads the fields of a MetaImage header and the byte at which it ends."""
    fields: dict[str, str] = {}
    with path.open("rb") as file:
        # a header is a few lines; a file without an end to it is none
        for line in iter(lambda: file.readline(CHUNK), b""):
            name, _, value = header_text(line).partition("=")
            fields[name.strip()] = value.strip()
            if name.strip() == "ElementDataFile":
                break
        return fields, file.tell()


def _metaimage(path: Path) -> Payload | None:
    fields, end = metaimage_header(path)
    name = fields.get("ElementDataFile", "")
    # several files are rare and MetaIO itself refuses short ones
    if name.startswith("LIST") or "%" in name or not name:
        return None
    size = METAIMAGE_BYTES.get(fields.get("ElementType", ""), 1)
    for length in fields.get("DimSize", "").split():
        size *= int(length)
    size *= int(fields.get("ElementNumberOfChannels", "1"))
    local = name.upper() == "LOCAL"
    start = end if local else max(0, int(fields.get("HeaderSize", "0")))
    zipped = fields.get("CompressedData", "").lower() in ("true", "1")
    return Payload(path if local else path.parent / name, start, size, ZLIB if zipped else None)


# --- NRRD -------------------------------------------------------------------------------


def nrrd_header(path: Path) -> tuple[dict[str, str], int]:
    """Reads the fields of a NRRD header and the byte at which it ends."""
    fields: dict[str, str] = {}
    with path.open("rb") as file:
        for line in iter(lambda: file.readline(CHUNK), b""):
            text = header_text(line).strip()
            if not text:
                break
            name, separator, value = text.partition(":")
            if separator and not text.startswith("#"):
                fields[name.strip().lower()] = value.strip()
        return fields, file.tell()


def _nrrd(path: Path) -> Payload | None:
    fields, end = nrrd_header(path)
    name = fields.get("data file", fields.get("datafile", ""))
    encoding = fields.get("encoding", "raw").lower()
    # text encodings, several files and skipped bytes are rare and teem checks their length
    skips = {"line skip", "lineskip", "byte skip", "byteskip"} & fields.keys()
    if encoding not in ("raw", "gzip", "gz") or "%" in name or name.startswith("LIST") or skips:
        return None
    kind = fields.get("type", "").replace(" ", "_")
    size = next((size for size, names in NRRD_BYTES.items() if kind in names.split()), 1)
    for length in fields.get("sizes", "").split():
        size *= int(length)
    return Payload(
        path.parent / name if name else path,
        0 if name else end,
        size,
        None if encoding == "raw" else GZIP,
    )
