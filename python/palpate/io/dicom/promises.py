"""What DICOM headers promise, held against what is there before room is made for it.

Source: DICOM PS3.5, A.4 (encapsulation) and A.5 (deflated); ISO 10918-1, B.2.2 (frame header);
ISO 14495-1, C.2.2; ISO 15444-1, A.5.1 (image and tile size).
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from palpate.base.errors import VolumeFormatError

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

    from palpate.io.dicom.header import Frame, Header

__all__ = ["check_deflated", "check_encoded", "check_numbers", "frame_count", "inflated"]

DEFLATED = b"1.2.840.10008.1.2.1.99"
HEAD = 4096
"""Bytes that hold the transfer syntax."""
MOST_RATIO = 200
"""Times that a deflated file may become larger, as entries of archives."""
SMALL = 64 << 20
"""Files and frames that become no larger than this may be packed however well [bytes]."""
MOST_PACKED = 20_000
"""Times that a decoded image may be larger than its code: blank frames reach 3000."""
LARGEST = 1e9
"""Of a place or spacing [mm], and of float32 values by far."""
LARGEST_VALUE = 1e30
"""That float32 still holds with room."""
NO_FRAME_HEADER = (0xC4, 0xC8, 0xCC)
"""Markers between SOF0 and SOF15 that are others."""
BARE_MARKERS = (0x01, *range(0xD0, 0xD9))
"""Markers of JPEG without a length."""


def frame_count(dataset: Dataset, *, left: int) -> int:
    """Returns how many frames a file announces: of those that cannot be there, only the first.

    Args:
        dataset: Its header.
        left: Bytes after it.

    Raises:
        VolumeFormatError: There can be no such number.
    """
    told = int(dataset.get("NumberOfFrames") or 1)
    if told < 1:
        raise VolumeFormatError(f"{told} frames announced; allowed: 1 or more")
    bits = int(dataset.get("BitsAllocated") or 16) * int(dataset.get("SamplesPerPixel") or 1)
    pixels = int(dataset.get("Rows") or 1) * int(dataset.get("Columns") or 1)
    syntax = getattr(dataset.file_meta, "TransferSyntaxUID", None)
    packed = syntax is not None and (syntax.is_compressed or syntax.is_deflated)
    # a packed frame has a header of eight bytes at least; one that is cut is looked at, too
    room = left // 8 if packed else left * 8 // max(1, bits * pixels) + 1
    if syntax is not None and syntax.is_deflated:
        room = left * MOST_RATIO * 8 // max(1, bits * pixels) + 1
    if packed and told > max(1, room):
        raise VolumeFormatError(
            f"{told} frames announced in {left} bytes; allowed: frames that are there"
        )
    return min(told, max(1, room))


def check_numbers(what: str, headers: Sequence[Header]) -> None:
    """Refuses slices with places, spacings or scales that cannot be.

    Raises:
        VolumeFormatError: One is NaN, infinite or far beyond any patient.
    """
    for header in headers:
        for frame in header.frames:
            wrong = _impossible(frame)
            if wrong:
                raise VolumeFormatError(
                    f"{what} has {wrong} in {header.path.name}, which cannot be; allowed: finite "
                    "numbers of the size of patients and measured values"
                )


def _impossible(frame: Frame) -> str:
    for name, numbers, most in (
        ("position", frame.position, LARGEST),
        ("orientation", frame.orientation, LARGEST),
        ("pixel spacing", frame.pixel_spacing, LARGEST),
        ("rescale slope and intercept", frame.scale, LARGEST_VALUE),
    ):
        if numbers is not None and not all(abs(number) <= most for number in numbers):
            return f"a {name} of {', '.join(f'{number:g}' for number in numbers)}"
    return ""


# --- packed data ------------------------------------------------------------------------


def check_deflated(path: Path) -> None:
    """Refuses a deflated file that becomes far larger: a library inflates all of it at once.

    Raises:
        VolumeFormatError: It does.
    """
    with path.open("rb") as file:
        head = file.read(HEAD)
        if DEFLATED not in head or head[132:136] != b"\x02\x00\x00\x00":
            return
        # group 2 tells its own length, and is never deflated
        file.seek(144 + int.from_bytes(head[140:144], "little"))
        most = max(SMALL, MOST_RATIO * path.stat().st_size)
        stream, inflated_bytes = zlib.decompressobj(-zlib.MAX_WBITS), 0
        while (piece := stream.unconsumed_tail or file.read(1 << 16)) and not stream.eof:
            try:
                inflated_bytes += len(stream.decompress(piece, 1 << 20))
            except zlib.error:
                return
            if inflated_bytes > most:
                raise VolumeFormatError(
                    f"{path} would inflate to more than {most} bytes; allowed: at most "
                    f"{MOST_RATIO} times its size"
                )


def inflated(frame: bytes, *, size: int) -> bytes:
    """Returns a deflated frame, of which no more than its bytes are unpacked.

    Raises:
        zlib.error: It is damaged.
    """
    return zlib.decompressobj(-zlib.MAX_WBITS).decompress(frame, max(1, size))


def check_encoded(path: Path, dataset: Dataset) -> None:
    """Refuses frames whose own headers tell another size than the file's.

    Raises:
        VolumeFormatError: They do.
    """
    from pydicom.encaps import generate_frames

    rows, columns, count = (
        int(dataset.get(name) or 1) for name in ("Rows", "Columns", "NumberOfFrames")
    )
    # others have no headers of their own
    if "PixelData" not in dataset or not dataset["PixelData"].is_undefined_length:
        return
    decoded = rows * columns * count * -(-int(dataset.get("BitsAllocated") or 8) // 8)
    if decoded > SMALL and decoded > MOST_PACKED * len(dataset.PixelData):
        raise VolumeFormatError(
            f"{path} announces {decoded} bytes of pixels in {len(dataset.PixelData)} packed bytes; "
            f"allowed: at most {MOST_PACKED} times as many"
        )
    for frame in generate_frames(dataset.PixelData, number_of_frames=count):
        size = _size_of_code(frame)
        if size is not None and size != (rows, columns):
            raise VolumeFormatError(
                f"{path} announces {columns} x {rows} pixels, its compressed images have "
                f"{size[1]} x {size[0]}; allowed: the same in both"
            )


def _size_of_code(code: bytes) -> tuple[int, int] | None:
    """Returns rows and columns that a compressed image tells; None where it has no such header."""
    if code.startswith(b"\xff\xd8"):
        return _size_of_jpeg(code)
    begins = code[:HEAD].find(b"\xff\x4f\xff\x51")
    if begins < 0:
        return None
    numbers = struct.unpack_from(">4I", code, begins + 8)
    return numbers[1] - numbers[3], numbers[0] - numbers[2]


def _size_of_jpeg(code: bytes) -> tuple[int, int]:
    place = 2
    while place + 4 <= len(code):
        if code[place] != 0xFF:
            break
        marker = code[place + 1]
        if marker == 0xFF or marker in BARE_MARKERS:
            place += 1 if marker == 0xFF else 2
            continue
        is_frame = 0xC0 <= marker <= 0xCF and marker not in NO_FRAME_HEADER
        if is_frame or marker == 0xF7:
            rows, columns = struct.unpack_from(">2H", code, place + 5)
            return rows, columns
        place += 2 + int.from_bytes(code[place + 2 : place + 4], "big")
    raise ValueError("a JPEG image without a frame header")
