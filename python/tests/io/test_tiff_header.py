"""TIFF pages that a file does not hold, or that differ, never reach the library."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
import SimpleITK
from palpate.base.errors import VolumeFormatError
from palpate.io.header_check import check_header


def pages(folder: Path) -> Path:
    """Three pages of 5 x 4 pixels, each a strip without compression."""
    values = np.arange(60, dtype=np.uint16).reshape(3, 4, 5)
    path = folder / "pages.tif"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(path))
    check_header(path)
    return path


def changed(path: Path, tag: int, value: int) -> None:
    """Gives a field of the first page another value."""
    content = bytearray(path.read_bytes())
    (first,) = struct.unpack_from("<I", content, 4)
    (count,) = struct.unpack_from("<H", content, first)
    for entry in range(first + 2, first + 2 + 12 * count, 12):
        found, kind = struct.unpack_from("<HH", content, entry)
        if found == tag:
            struct.pack_into("<I" if kind == 4 else "<H", content, entry + 8, value)
            path.write_bytes(content)
            return
    raise AssertionError(f"no field {tag}")


@pytest.mark.parametrize(
    ("tag", "value", "why"),
    [
        (254, 0, "some are called pages"),
        (254, 0xFFFFFFFF, "small copy or a mask"),
        (256, 6, "lie|hold|page 1 has"),
        (257, 60000, "page 1"),
        (258, 8, "page 1 has .* 8 bits"),
        (258, 999, "of 999 bits"),
        (273, 1 << 31, "do not hold"),
        (277, 3, "page 1 has"),
    ],
)
def test_what_its_pages_promise_is_held_against_the_file(
    tmp_path: Path, tag: int, value: int, why: str
) -> None:
    path = pages(tmp_path)
    changed(path, tag, value)
    with pytest.raises(VolumeFormatError, match=rf"pages\.tif cannot be read .*({why}).*allowed"):
        check_header(path)


def test_directories_lie_in_the_file_and_come_once(tmp_path: Path) -> None:
    path = pages(tmp_path)
    content = path.read_bytes()
    (first,) = struct.unpack_from("<I", content, 4)
    (count,) = struct.unpack_from("<H", content, first)
    link = first + 2 + 12 * count
    for place, why in ((first, "one of those before"), (1 << 31, "lie beyond")):
        path.write_bytes(content[:link] + struct.pack("<I", place) + content[link + 4 :])
        with pytest.raises(VolumeFormatError, match=why):
            check_header(path)
