"""Pixels without what no picture shows: unused bits, bytes after the end, comments in codestreams.

Pictures stay the same to the bit. In codestreams the content of comments and of application
segments is filled with zeros, so that no length and no offset changes.

Sources: DICOM PS3.5, 8.1.1 (bits of a pixel) and A.4 (encapsulation); ITU-T T.81, B.2 (JPEG);
ITU-T T.87 (JPEG-LS); ITU-T T.800, A.4 and A.9 (JPEG 2000).
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from struct import unpack_from
from typing import TYPE_CHECKING

import numpy as np

from palpate.base.errors import PalpateError

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

__all__ = ["HiddenBytesError", "cleaned_codestreams", "cleaned_pixels", "cleaned_values"]

EOI, COMMENT = 0xD9, 0xFE
SOT, SOD, EOC, COMMENT_2000 = 0xFF90, 0xFF93, 0xFFD9, 0xFF64
CODED_FOR = (b"Adobe\0", b"Adobe", b"mrfx")
"""Application segments that decoders need: the transforms of colours."""
CODED_LENGTH = 12


class HiddenBytesError(PalpateError):
    """Compressed pixels may hold texts that cannot be found."""


def cleaned_pixels(dataset: Dataset) -> tuple[bytes, str | None]:
    """Returns an object's pixel data without what no picture shows, and what was cleaned.

    Raises:
        HiddenBytesError: It is compressed in a way that is not looked into.
    """
    from pydicom.uid import RLELossless

    held: bytes = dataset.PixelData
    meta = getattr(dataset, "file_meta", None)
    syntax = getattr(meta, "TransferSyntaxUID", None)
    if syntax is None or not syntax.is_compressed or syntax.is_deflated:
        made = cleaned_values(held, dataset)
        return made, None if made == held else "unused bits cleared"
    if syntax == RLELossless:
        return held, None
    made = _cleaned_fragments(held)
    return made, None if made == held else "comments of the codestream cleared"


def cleaned_values(held: bytes, dataset: Dataset) -> bytes:
    """Returns uncompressed pixels with unused bits as the sign has them, and nothing after them."""
    allocated, stored = int(dataset.BitsAllocated), int(dataset.get("BitsStored") or 0)
    count = int(dataset.Rows) * int(dataset.Columns) * int(dataset.get("NumberOfFrames") or 1)
    count *= int(dataset.get("SamplesPerPixel") or 1)
    if dataset.get("PhotometricInterpretation") == "YBR_FULL_422":
        count = count * 2 // 3
    size = (count * allocated + 7) // 8
    padding = bytes(min(size % 2, max(0, len(held) - size)))
    whole = held[:size] + padding
    if allocated not in (8, 16, 32) or not 0 < stored < allocated or len(held) < size:
        return whole
    kind = np.dtype(f"{'i' if dataset.get('PixelRepresentation') else 'u'}{allocated // 8}")
    is_big = dataset.original_encoding[1] is False
    values = np.frombuffer(held[:size], kind.newbyteorder(">" if is_big else "<"))
    lowest = int(dataset.get("HighBit") or stored - 1) - stored + 1
    # up to the top, and back with the sign; a picture may lie above bits that are not used
    up = allocated - stored - lowest
    if lowest < 0 or up < 0:
        return whole
    shown = ((values << up) >> (up + lowest)) << lowest
    return shown.astype(values.dtype).tobytes() + padding


def _cleaned_fragments(held: bytes) -> bytes:
    """Returns encapsulated pixels whose codestreams have no comments."""
    made = bytearray(held)
    places = list(_fragments(held))
    # a frame may lie in several
    joined = bytearray(b"".join(held[start:end] for start, end in places))
    cleaned_codestreams(joined)
    at = 0
    for start, end in places:
        made[start:end] = joined[at : at + end - start]
        at += end - start
    return bytes(made)


def _fragments(held: bytes) -> Iterator[tuple[int, int]]:
    """Yields the places of fragments, after the table of offsets."""
    at, number = 0, 0
    while at + 8 <= len(held) and held[at : at + 4] == b"\xfe\xff\x00\xe0":
        (length,) = unpack_from("<I", held, at + 4)
        if number:
            yield at + 8, at + 8 + length
        at, number = at + 8 + length, number + 1


def cleaned_codestreams(joined: bytearray) -> None:
    """Clears the comments of codestreams that follow one another, and what is between them.

    Raises:
        HiddenBytesError: They are neither JPEG, nor JPEG-LS, nor JPEG 2000.
    """
    at = 0
    try:
        while at < len(joined):
            if joined[at : at + 2] == b"\xff\xd8":
                at = _clean_jpeg(joined, at + 2)
            elif joined[at : at + 2] == b"\xff\x4f":
                at = _clean_jpeg_2000(joined, at + 2)
            elif at == 0:
                raise HiddenBytesError(OTHER)
            else:
                # padding
                starts = [joined.find(mark, at) for mark in (b"\xff\xd8\xff", b"\xff\x4f\xff\x51")]
                end = min((place for place in starts if place >= 0), default=len(joined))
                joined[at:end] = bytes(end - at)
                at = end
    except (struct.error, IndexError):
        raise HiddenBytesError(OTHER) from None


OTHER = (
    "the scan's images are compressed in a way that may hide texts; allowed: .seg.nrrd, or "
    "`keep_identity=True` for an archive that may know the patient"
)


def _clean_jpeg(joined: bytearray, at: int) -> int:
    """Clears the comments of a JPEG image; returns where it ends."""
    while True:
        at = _next_marker(joined, at)
        marker = joined[at + 1]
        if marker == EOI:
            return at + 2
        (length,) = unpack_from(">H", joined, at + 2)
        start, end = at + 4, at + 2 + length
        if marker == COMMENT or 0xE0 <= marker <= 0xEF:
            _clear(joined, start, end)
        at = end


def _next_marker(joined: bytearray, at: int) -> int:
    """Returns where the next marker with a length stands, after the data of a scan, if any."""
    while True:
        at = joined.find(0xFF, at)
        if at < 0:
            raise IndexError
        after = joined[at + 1]
        # after data of JPEG-LS a bit is stuffed: what follows 0xFF is below 0x80
        if after >= 0x80 and not 0xD0 <= after <= 0xD7 and after != 0xFF:
            return at
        at += 1


def _clear(joined: bytearray, start: int, end: int) -> None:
    kept = CODED_LENGTH if bytes(joined[start:end]).startswith(CODED_FOR) else 0
    joined[start + kept : end] = bytes(max(0, end - start - kept))


def _clean_jpeg_2000(joined: bytearray, at: int) -> int:
    """Clears the comments of a JPEG 2000 codestream; returns where it ends."""
    tile_end: int | None = None
    while True:
        (marker,) = unpack_from(">H", joined, at)
        if marker == EOC:
            return at + 2
        if marker == SOD:
            if tile_end is None or tile_end <= at:
                raise IndexError
            at = tile_end
            continue
        (length,) = unpack_from(">H", joined, at + 2)
        if marker == SOT:
            (size,) = unpack_from(">I", joined, at + 6)
            # the last one may reach to the end
            tile_end = at + size if size else joined.rindex(b"\xff\xd9")
        elif marker == COMMENT_2000:
            # how it is registered stays
            joined[at + 6 : at + 2 + length] = bytes(length - 4)
        at += 2 + length
