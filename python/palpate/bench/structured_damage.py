"""Damage that knows what a file is made of: fields of headers, elements, lines, members.

Random bytes seldom get past the first check of a reader. Here a field keeps its place and its form,
and takes a value that cannot be, or is lost, doubled or told with another length.
"""

from __future__ import annotations

import gzip
import io
import re
import struct
import zipfile
import zlib
from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple, TypeVar

import numpy as np

__all__ = ["restructured"]

Value = TypeVar("Value")

TEXTS = (
    b"", b"0", b"-1", b"-0", b"1e308", b"1e400", b"nan", b"inf", b"-inf", b"0x10", b"1.5",
    b"99999999", b"2147483648", b"4294967296", b"18446744073709551616", b"9" * 400, b"%n%s%d",
    b"%99999d 0 9 0", b"LIST", b"/etc/services", b"../../x", b"\\", b"1\\2", b"1 2", b"none",
    b"\x00", b"\xff\xfe", b"null", b"[]", b"{}", b"[[1]]", b'""', b"true", b"word",
)  # fmt: skip
"""Values of fields that are written as text."""
NUMBERS = (0, 1, -1, 2, 7, 127, 128, 255, 32767, 32768, 65535, 2**31 - 1, 2**31, 2**32 - 1)
FLOATS = (0.0, -0.0, -1.0, float("nan"), float("inf"), 1e30, -1e30, 1e-40, 1e300)
NIFTI_FIELDS = (
    ("<h", range(40, 56, 2)), ("<h", (70, 72, 252, 254)), ("<f", range(76, 120, 4)),
    ("<f", range(256, 328, 4)), ("<i", (0,)), ("<B", (123, 344, 345, 348)),
)  # fmt: skip
"""Forms and places of the fields of NIfTI-1."""
NIFTI_2_FIELDS = (
    ("<i", (0, 344, 348, 496, 500, 504)), ("<h", (12, 14)), ("<q", range(16, 80, 8)),
    ("<q", (168, 224, 232)), ("<d", range(104, 168, 8)), ("<d", (176, 184)),
    ("<d", range(352, 496, 8)),
)  # fmt: skip
"""Of NIfTI-2."""
MGH_FIELDS = (
    (">i", range(0, 28, 4)), (">h", (28,)), (">f", range(30, 90, 4)),
)  # fmt: skip
"""Of FreeSurfer's MGH: size and type, whether there is a place, the place."""
LONG_LENGTH = (b"OB", b"OW", b"OF", b"OD", b"SQ", b"UN", b"UT", b"UC", b"UR", b"OL", b"SV", b"UV")
"""Value representations of DICOM with a length of four bytes (PS3.5, 7.1.2)."""
ITEM = b"\xfe\xff\x00\xe0"
"""How an item of a sequence begins."""
UNDEFINED = 0xFFFF_FFFF
"""Length of what ends with a delimiter."""
NETCDF_HEADER = 6000
"""Bytes of the header of small files, about."""
TEXT_HEADER = 1 << 16
MOST_MEMBER = 1 << 22
"""Of an archive, that is unpacked [bytes]."""

Generator = np.random.Generator


def restructured(content: bytes, generator: Generator) -> bytes:
    """Returns content with one field of it made wrong; as it is where nothing is known of it."""
    for begins, change in (
        (lambda head: head[128:132] == b"DICM", _element),
        (lambda head: head[:2] == b"\x1f\x8b", _unzipped),
        (lambda head: head[:2] == b"PK", _member),
        (lambda head: head[:4] == b"\x5c\x01\x00\x00", partial(_field, NIFTI_FIELDS)),
        (lambda head: head[:4] == b"\x1c\x02\x00\x00", partial(_field, NIFTI_2_FIELDS)),
        (lambda head: head[:4] == b"\x00\x00\x00\x01", partial(_field, MGH_FIELDS)),
        (lambda head: head[:3] == b"CDF", _netcdf),
        (lambda head: head[:8] == b"\x89PNG\r\n\x1a\n", _png),
        (lambda head: head[:4] in (b"II*\0", b"MM\0*"), _tiff),
        (lambda head: head[:4] == b"glTF", _glb),
    ):
        if begins(content[:256]):
            return change(content, generator)
    return _line(content, generator)


def _one_of(values: Sequence[Value], generator: Generator) -> Value:
    return values[int(generator.integers(len(values)))]


def _packed(form: str, generator: Generator) -> bytes:
    """Returns a number that hardly can be, in a form."""
    if form[1] in "fd":
        value: float = _one_of(FLOATS, generator)
        try:
            return struct.pack(form, value)
        except OverflowError:
            return struct.pack(form, float("inf"))
    width = 8 * struct.calcsize(form)
    number = _one_of(NUMBERS, generator) & (1 << width) - 1
    return number.to_bytes(width // 8, "big" if form[0] == ">" else "little")


# --- DICOM --------------------------------------------------------------------------------


class _Element(NamedTuple):
    """Where an element stands in explicit little endian."""

    begin: int
    value: int
    end: int
    owners: tuple[int, ...]
    """Places of the lengths of the sequences and items that hold it."""


def _elements(
    content: bytes, begin: int, end: int, *, owners: tuple[int, ...] = ()
) -> list[_Element]:
    """Lists elements of a data set, and below each those that it holds."""
    found = []
    while begin + 8 <= end:
        kind = content[begin + 4 : begin + 6]
        if not kind.isupper():
            break
        width = 4 if kind in LONG_LENGTH else 2
        value = begin + 4 + 2 * width
        length = int.from_bytes(content[value - width : value], "little")
        last = min(end, value + length)
        found.append(_Element(begin, value, last, owners))
        if kind == b"SQ":
            found += _held(content, found[-1])
        begin = last
    return found


def _held(content: bytes, sequence: _Element) -> list[_Element]:
    """Lists the elements of all items of a sequence."""
    found = []
    _, begin, end, owners = sequence
    while content[begin : begin + 4] == ITEM and begin + 8 <= end:
        last = min(end, begin + 8 + int.from_bytes(content[begin + 4 : begin + 8], "little"))
        lengths = (*owners, sequence.value - 4, begin + 4)
        found += _elements(content, begin + 8, last, owners=lengths)
        begin = last
    return found


def _element(content: bytes, generator: Generator) -> bytes:
    elements = _elements(content, 132, len(content))
    if not elements:
        return content
    chosen = _one_of(elements, generator)
    begin, value, end, owners = chosen
    kind = content[begin + 4 : begin + 6]
    width = 4 if kind in LONG_LENGTH else 2
    other = _one_of((b"US", b"DS", b"IS", b"FD", b"UI", b"AT", b"SS"), generator)
    changed = (
        # lost, doubled, of another kind, of another length than its own
        content[:begin] + content[end:],
        content[:end] + content[begin:],
        content[: begin + 4] + other + content[begin + 6 :],
        content[: value - width] + _packed(("<I", "<H")[width == 2], generator) + content[value:],
    )
    what = int(generator.integers(6))
    made = changed[what] if what < 4 else _with_value(content, chosen, generator)
    return _lengthened(made, owners, len(made) - len(content))


def _lengthened(content: bytes, owners: tuple[int, ...], by: int) -> bytes:
    """Corrects the lengths of what holds an element, so that what follows is still read."""
    made = bytearray(content)
    for place in owners:
        length = int.from_bytes(made[place : place + 4], "little")
        if length != UNDEFINED:
            made[place : place + 4] = struct.pack("<I", length + by)
    return bytes(made)


def _with_value(content: bytes, place: _Element, generator: Generator) -> bytes:
    """Returns content with a value that an element hardly can have."""
    begin, value, end, _ = place
    kind = content[begin + 4 : begin + 6]
    forms = {b"US": "<H", b"SS": "<H", b"UL": "<I", b"SL": "<I", b"FD": "<d", b"FL": "<f"}
    put = _packed(forms[kind], generator) if kind in forms else _one_of(TEXTS, generator)
    if kind in (b"DS", b"IS") and generator.integers(2):
        put = b"\\".join([put] * int(generator.integers(1, 8)))
    put += b" " * (len(put) % 2)
    if kind in LONG_LENGTH:
        return content[: value - 4] + struct.pack("<I", len(put)) + put + content[end:]
    return content[: value - 2] + struct.pack("<H", len(put)) + put + content[end:]


# --- packed files -------------------------------------------------------------------------


def _unzipped(content: bytes, generator: Generator) -> bytes:
    try:
        plain = gzip.decompress(content)
    except (OSError, EOFError, zlib.error):
        return content
    changed = restructured(plain, generator)
    return content if changed == plain else gzip.compress(changed, 1, mtime=0)


def _member(content: bytes, generator: Generator) -> bytes:
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            members = [(one, archive.read(one)) for one in archive.infolist()
                       if one.file_size < MOST_MEMBER]  # fmt: skip
    except (zipfile.BadZipFile, NotImplementedError, OSError, ValueError, zlib.error):
        return content
    if not members:
        return content
    chosen = int(generator.integers(len(members)))
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for number, (info, held) in enumerate(members):
            changed = restructured(held, generator) if number == chosen else held
            archive.writestr(zipfile.ZipInfo(info.filename), changed)
    return target.getvalue()


# --- binary headers -----------------------------------------------------------------------


Fields = Sequence[tuple[str, Sequence[int]]]
"""Forms and places of the fields of a header."""


def _field(fields: Fields, content: bytes, generator: Generator) -> bytes:
    form, places = _one_of(fields, generator)
    place = _one_of(places, generator)
    put = _packed(form, generator)
    return content[:place] + put + content[place + len(put) :]


def _netcdf(content: bytes, generator: Generator) -> bytes:
    """Changes a count, a length or a type of netCDF, in which MINC 1 is written.

    Its header is of words of four bytes; those of small numbers tell what it is made of.
    """
    words = np.frombuffer(content[: len(content[:NETCDF_HEADER]) // 4 * 4], ">u4")
    places = [4 * int(word) for word in np.flatnonzero(words < 1 << 16)[1:]]
    if not places:
        return content
    place = _one_of(places, generator)
    return content[:place] + _packed(">i", generator) + content[place + 4 :]


def _png(content: bytes, generator: Generator) -> bytes:
    """Changes a field of the first chunk, and its checksum with it."""
    place = _one_of((16, 20, 24, 25, 26, 28), generator)
    put = _packed(">I" if place < 24 else ">B", generator)
    head = content[12:place] + put + content[place + len(put) : 29]
    return content[:12] + head + struct.pack(">I", zlib.crc32(head)) + content[33:]


def _tiff(content: bytes, generator: Generator) -> bytes:
    """Changes an entry of the first directory, or where that is."""
    order = "<" if content[:2] == b"II" else ">"
    directory = struct.unpack_from(f"{order}I", content, 4)[0]
    if directory + 14 > len(content) or generator.random() < 0.1:
        return content[:4] + _packed(f"{order}I", generator) + content[8:]
    count = struct.unpack_from(f"{order}H", content, directory)[0]
    place = directory + 2 + 12 * int(generator.integers(max(1, count)))
    place += _one_of((0, 2, 4, 8), generator)
    put = _packed(f"{order}I" if place % 4 == (directory + 2) % 4 else f"{order}H", generator)
    return content[:place] + put + content[place + len(put) :]


def _glb(content: bytes, generator: Generator) -> bytes:
    size = int.from_bytes(content[12:16], "little")
    text = _line(content[20 : 20 + size], generator)
    text += b" " * (-len(text) % 4)
    rest = content[20 + size :]
    head = content[:8] + struct.pack("<II", 20 + len(text) + len(rest), len(text)) + b"JSON"
    return head + text + rest


# --- text ---------------------------------------------------------------------------------


def _line(content: bytes, generator: Generator) -> bytes:
    """Changes a value of a header of lines, of JSON, of YAML or of a table; or a whole line."""
    if not re.match(rb"[\t\r\n -~]{8}", content):
        return content
    head, rest = content[:TEXT_HEADER], content[TEXT_HEADER:]
    change: Callable[[bytes, Generator], bytes] = _token if generator.random() < 0.8 else _whole
    return change(head, generator) + rest


def _token(head: bytes, generator: Generator) -> bytes:
    # what stands behind the first bytes that are no text is left as it is
    plain = re.match(rb"[\t\r\n -~]*", head)
    values = [*re.finditer(rb'"[^"]*"|[^\s,:=()\[\]{}"]+', plain[0] if plain else b"")]
    if not values:
        return head
    chosen = _one_of(values, generator)
    return head[: chosen.start()] + _one_of(TEXTS, generator) + head[chosen.end() :]


def _whole(head: bytes, generator: Generator) -> bytes:
    ends = [found.end() for found in re.finditer(rb"\n", head)][:200]
    if len(ends) < 2:
        return head
    number = int(generator.integers(1, len(ends)))
    begin, end = ends[number - 1], ends[number]
    if generator.integers(2):
        return head[:begin] + head[end:]
    return head[:end] + head[begin:end] + head[end:]
