"""Directories of TIFF files, held against their files before a library sees them.

Source: TIFF 6.0 (Aldus 1992); BigTIFF as in libtiff 4.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from palpate.base.errors import VolumeFormatError

__all__ = ["check_tiff"]

MOST_PACKED = 5000
"""Times that pixels may be larger than their file: runs of one grey reach 2700 (LZW)."""
MOST_PAGES = 65535
"""That ITK counts."""
INTEGERS = {1: "B", 3: "H", 4: "I", 13: "I", 16: "Q", 18: "Q"}
"""Kinds of unsigned numbers, by their code in a directory."""
MOST_BITS = 64

KIND, COLUMNS, ROWS, BITS, PACKING = 254, 256, 257, 258, 259
STRIPS, SAMPLES, STRIP_ROWS, STRIP_BYTES, PLANES = 273, 277, 278, 279, 284
TILE_COLUMNS, TILE_ROWS, TILES, TILE_BYTES, FORMAT = 322, 323, 324, 325, 339
READ = {
    KIND, COLUMNS, ROWS, BITS, PACKING, STRIPS, SAMPLES, STRIP_ROWS, STRIP_BYTES, PLANES,
    TILE_COLUMNS, TILE_ROWS, TILES, TILE_BYTES, FORMAT,
}  # fmt: skip
"""Fields that are looked at."""
REDUCED, PAGE, MASK = 1, 2, 4
"""Bits of a page's kind."""

Fields = dict[int, tuple[int, ...]]


def check_tiff(path: Path) -> None:
    """Refuses pages that a file does not hold, that differ, or of which some are no slices.

    ITK reads each into room for pages that are all like the first one. A file that does not begin
    as TIFF is left to it.

    Raises:
        VolumeFormatError: There are such pages.
    """
    length = path.stat().st_size
    with path.open("rb") as file:
        layout = _layout(file, length)
        if layout is None:
            return
        try:
            pages = list(_pages(layout))
            for number, page in enumerate(pages, 1):
                _check_page(page, number, length)
            _check_alike(pages)
        except ValueError as error:
            raise VolumeFormatError(
                f"{path} cannot be read ({error}); allowed: complete, undamaged pictures, the "
                "pages of one file alike"
            ) from None


@dataclass(frozen=True)
class _Layout:
    """How the directories of a file are written."""

    file: IO[bytes]
    order: str
    """Of bytes, as in ``struct``."""
    big: bool
    """Whether places have 8 bytes."""
    first: int
    """Place of the first directory."""
    length: int
    """Of the file [bytes]."""

    @property
    def place(self) -> str:
        """Kind of number that places are."""
        return "Q" if self.big else "I"

    def numbers(self, kinds: str, content: bytes) -> tuple[int, ...]:
        """Returns the numbers that bytes stand for."""
        return struct.unpack(self.order + kinds, content)


def _layout(file: IO[bytes], length: int) -> _Layout | None:
    """Returns how a file is written by its first 16 bytes; None where it is no TIFF."""
    head = file.read(16)
    order = {b"II": "<", b"MM": ">"}.get(head[:2])
    if order is None or len(head) < 16:
        return None
    (version,) = struct.unpack(order + "H", head[2:4])
    if version not in (42, 43):
        return None
    big = version == 43
    (first,) = struct.unpack(order + ("Q" if big else "I"), head[8:16] if big else head[4:8])
    return _Layout(file, order, big, first, length)


def _pages(layout: _Layout) -> Iterator[Fields]:
    """Yields the fields of each page that are looked at.

    Raises:
        ValueError: A directory lies outside the file, or comes twice.
    """
    seen: set[int] = set()
    place = layout.first
    while place:
        if place in seen or len(seen) == MOST_PAGES:
            raise ValueError(f"the directory of its page {len(seen) + 1} is one of those before")
        seen.add(place)
        page, place = _directory(layout, place, len(seen))
        yield page


def _directory(layout: _Layout, place: int, number: int) -> tuple[Fields, int]:
    """Returns the fields of a page, and where the next directory lies; 0 after the last."""
    head = "Q" if layout.big else "H"
    entry = 20 if layout.big else 12
    (count,) = layout.numbers(head, _bytes(layout, place, struct.calcsize("<" + head)))
    begins = place + struct.calcsize("<" + head)
    after = struct.calcsize("<" + layout.place)
    content = _bytes(layout, begins, count * entry + after)
    page: Fields = {}
    for start in range(0, count * entry, entry):
        tag, kind = layout.numbers("HH", content[start : start + 4])
        if tag in READ and tag not in page:
            try:
                page[tag] = _values(layout, kind, content[start + 4 : start + entry])
            except ValueError as error:
                raise ValueError(f"field {tag} of page {number}: {error}") from None
    (following,) = layout.numbers(layout.place, content[-after:])
    return page, following


def _values(layout: _Layout, kind: int, entry: bytes) -> tuple[int, ...]:
    """Returns the numbers of a field, which stand in its entry or elsewhere."""
    if kind not in INTEGERS:
        raise ValueError(f"its numbers are of kind {kind}, not whole ones")
    half = len(entry) // 2
    (count,) = layout.numbers(layout.place, entry[:half])
    held = count * struct.calcsize("<" + INTEGERS[kind])
    if held <= half:
        return layout.numbers(f"{count}{INTEGERS[kind]}", entry[half : half + held])
    (place,) = layout.numbers(layout.place, entry[half:])
    return layout.numbers(f"{count}{INTEGERS[kind]}", _bytes(layout, place, held))


def _bytes(layout: _Layout, place: int, held: int) -> bytes:
    if place + held > layout.length:
        raise ValueError(f"{held} bytes at {place} lie beyond its {layout.length} bytes")
    layout.file.seek(place)
    return layout.file.read(held)


# --- pages --------------------------------------------------------------------------------


def _check_page(page: Fields, number: int, length: int) -> None:
    """Holds a page's promises against the length of its file [bytes].

    Raises:
        ValueError: It does not hold them.
    """
    columns, rows, samples = (_one(page, tag, 1) for tag in (COLUMNS, ROWS, SAMPLES))
    bits = page.get(BITS) or (1,)
    if min(columns, rows, samples, *bits) < 1 or max(bits) > MOST_BITS or len(set(bits)) > 1:
        raise ValueError(
            f"page {number} announces {columns} x {rows} pixels of {samples} numbers of "
            f"{', '.join(map(str, bits[:4]))} bits"
        )
    if columns * rows * samples * bits[0] > 8 * MOST_PACKED * length:
        raise ValueError(
            f"page {number} announces {columns} x {rows} pixels of {samples} numbers in {length} "
            "bytes"
        )
    places, held = _parts(page, number, length)
    if len(held) < len(places):
        raise ValueError(f"page {number} has lengths of {len(held)} parts of {len(places)}")
    for place, count in zip(places, held, strict=False):
        if place < 8 or place + count > length:
            raise ValueError(
                f"page {number} has {count} bytes at {place}, which its {length} bytes do not hold"
            )


def _parts(page: Fields, number: int, length: int) -> tuple[Sequence[int], Sequence[int]]:
    """Returns places and lengths of a page's strips or tiles [bytes].

    Raises:
        ValueError: There are fewer than its pixels need, or tiles of no size.
    """
    columns, rows, samples = (_one(page, tag, 1) for tag in (COLUMNS, ROWS, SAMPLES))
    planes = samples if _one(page, PLANES, 1) == 2 else 1
    tiled = TILES in page or TILE_COLUMNS in page
    across, down = columns, min(_one(page, STRIP_ROWS, rows) or rows, rows)
    places, held = page.get(STRIPS, ()), page.get(STRIP_BYTES, ())
    if tiled:
        across, down = _one(page, TILE_COLUMNS, 0), _one(page, TILE_ROWS, 0)
        if min(across, down) < 1 or across * down > MOST_PACKED * length:
            raise ValueError(f"page {number} announces tiles of {across} x {down} pixels")
        places, held = page.get(TILES, places), page.get(TILE_BYTES, held)
    each = -(-columns // across) * -(-rows // down)
    if len(places) < each * planes:
        raise ValueError(f"page {number} has {len(places)} parts of {each * planes}")
    places = places[: each * planes]
    if _one(page, PACKING, 1) != 1:
        return places, held or (1,) * len(places)
    line = -(-across * _one(page, BITS, 1) * samples // planes // 8)
    # the last strip of each plane may be shorter
    last = down if tiled else rows - (rows - 1) // down * down
    plane = [line * down] * (each - 1) + [line * last]
    return places, plane * planes


def _check_alike(pages: Sequence[Fields]) -> None:
    """Refuses pages that differ, since each is read into the room of one like the first.

    Raises:
        ValueError: They do.
    """
    kinds = [_one(page, KIND, 0) for page in pages]
    slices = [not kind & (REDUCED | MASK) for kind in kinds]
    if not any(slices) or slices != sorted(slices, reverse=True):
        raise ValueError("a small copy or a mask comes before a page")
    kept = [page for page, is_slice in zip(pages, slices, strict=True) if is_slice]
    if len({kind & PAGE for kind in kinds[: len(kept)]}) > 1:
        raise ValueError("of its pictures some are called pages and others not")
    told = [
        (
            f"{_one(page, COLUMNS, 1)} x {_one(page, ROWS, 1)} pixels of {_one(page, SAMPLES, 1)} "
            f"numbers of {_one(page, BITS, 1)} bits"
        )
        for page in kept
    ]
    for number, (page, one) in enumerate(zip(kept, told, strict=True), 1):
        if one != told[0]:
            raise ValueError(f"page 1 has {told[0]}, page {number} has {one}")
        if _one(page, FORMAT, 1) != _one(kept[0], FORMAT, 1):
            raise ValueError(f"page {number} has numbers of another kind than page 1")


def _one(page: Fields, tag: int, otherwise: int) -> int:
    """Returns the first number of a field."""
    return (page.get(tag) or (otherwise,))[0]
