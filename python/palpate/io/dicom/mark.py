"""What tells that a file is DICOM: its mark, or a data set from the first byte on.

Files without preamble and file meta information are what some programs leave when they remove
group 2; their encoding is told by their first elements.

Source: DICOM PS3.10, 7.1 (file meta information); PS3.5, 7.1 (data elements).
"""

from __future__ import annotations

import os
import struct
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

if TYPE_CHECKING:
    from pydicom.dataset import FileDataset

__all__ = ["has_mark", "is_dicom", "read_dataset"]

LOOKED_AT = 4096
"""Bytes in which the first elements are looked for."""
FIRST_GROUPS = (0x0002, 0x0008)
LAST_FIRST = 0x0020
"""A data set begins with an element no later in its group than this."""
ELEMENTS = 4
"""That have to follow one another as they should."""
LONG = (b"OB", b"OD", b"OF", b"OL", b"OV", b"OW", b"SQ", b"SV", b"UC", b"UN", b"UR", b"UT", b"UV")
"""Kinds of values with lengths of 32 bits, behind two bytes."""
SHORT = (
    b"AE", b"AS", b"AT", b"CS", b"DA", b"DS", b"DT", b"FD", b"FL", b"IS", b"LO", b"LT", b"PN",
    b"SH", b"SL", b"SS", b"ST", b"TM", b"UI", b"UL", b"US",
)  # fmt: skip
UNDEFINED = 0xFFFFFFFF


def is_dicom(path: Path) -> bool:
    """Says whether a file carries the mark of DICOM, or is a data set without one."""
    with path.open("rb") as file:
        return has_mark(file)


def has_mark(file: BinaryIO) -> bool:
    """Says so of an open file, and leaves it at its beginning."""
    head = file.read(LOOKED_AT)
    size = os.fstat(file.fileno()).st_size
    file.seek(0)
    return head[128:132] == b"DICM" or any(_is_data_set(head, size, order) for order in "<>")


def _is_data_set(head: bytes, size: int, order: str) -> bool:
    """Says whether bytes begin with elements of rising tags whose values fit into the file."""
    at, last = 0, (0, 0)
    for number in range(ELEMENTS):
        if at + 12 > len(head):
            return number > 1
        tag = struct.unpack_from(f"{order}HH", head, at)
        if number == 0 and (tag[0] not in FIRST_GROUPS or tag[1] > LAST_FIRST):
            return False
        kind = head[at + 4 : at + 6]
        if kind in LONG:
            (length,), header = struct.unpack_from(f"{order}I", head, at + 8), 12
        elif kind in SHORT:
            (length,), header = struct.unpack_from(f"{order}H", head, at + 6), 8
        else:
            (length,), header = struct.unpack_from(f"{order}I", head, at + 4), 8
        if length == UNDEFINED:
            return number > 0
        if tag <= last or length % 2 or at + header + length > size:
            return False
        at, last = at + header + length, tag
    return True


def read_dataset(
    file: Path | BinaryIO,
    *,
    stop_before_pixels: bool = False,
    specific_tags: list[str] | None = None,
) -> FileDataset:
    """Reads a file that is DICOM, with the transfer syntax that it is seen to have if none is told.

    Args:
        file: That ``is_dicom`` knows.
        stop_before_pixels: As ``pydicom.dcmread`` has it.
        specific_tags: As ``pydicom.dcmread`` has it.
    """
    import pydicom
    from pydicom.uid import ExplicitVRBigEndian, ExplicitVRLittleEndian, ImplicitVRLittleEndian

    dataset = pydicom.dcmread(
        file,
        force=True,
        stop_before_pixels=stop_before_pixels,
        specific_tags=[*specific_tags] if specific_tags else None,
    )
    if "TransferSyntaxUID" not in dataset.file_meta:
        implicit, little = dataset.original_encoding
        explicit = ExplicitVRLittleEndian if little else ExplicitVRBigEndian
        dataset.file_meta.TransferSyntaxUID = ImplicitVRLittleEndian if implicit else explicit
    return dataset
