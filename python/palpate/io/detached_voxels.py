"""Files of voxels that the header of another file names: one, a list, or a pattern with numbers.

A header may name files beside it or below it, and no others, whatever it is and wherever it came
from. Patterns and lists are opened up here, since libraries print a pattern as the header has it.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path, PurePosixPath

from palpate.base.errors import VolumeFormatError
from palpate.base.files_read import note_read

__all__ = ["DEFLATE_RATIO", "check_held", "numbered", "voxel_file"]

MOST_FILES = 65_536
"""Of one scan."""
LONGEST_NAME = 255
"""Of a file with its folders below the header [bytes]."""
DEFLATE_RATIO = 1032
"""Times that deflate makes bytes smaller at most (zlib technical details)."""
PATTERN = re.compile(r"[^%]*%0?\d{0,2}[diu][^%]*")


def voxel_file(header: Path, name: str) -> Path:
    """Returns the file of voxels that a header names.

    Raises:
        VolumeFormatError: It is not there, is no plain file, or lies elsewhere.
    """
    parts = PurePosixPath(name).parts
    fits = (
        parts
        and name.isprintable()
        and not re.search(r"[%\\]|^[A-Za-z]:|^/", name)
        and ".." not in parts
        and len(name.encode()) <= LONGEST_NAME
    )
    if not fits:
        raise VolumeFormatError(
            f"{header} names voxels in {name[:100]!r}; allowed: in the same file, or in files "
            "beside it or below"
        )
    file = header.parent / name
    if not file.is_file():
        raise VolumeFormatError(
            f"{header} names {name} as the file of its voxels, which does not exist; allowed: "
            "both files in one folder"
        )
    return file


def numbered(header: Path, pattern: str, numbers: Sequence[str]) -> list[str]:
    """Returns the names that a pattern such as ``slice%03d.raw`` gives from one number to another.

    Args:
        header: For the message.
        pattern: With the place of the number.
        numbers: First, last and step, as the header has them.

    Raises:
        VolumeFormatError: Pattern or numbers are not such.
    """
    # names are printed by the libraries too, with the header's folder before them
    if not PATTERN.fullmatch(pattern) or "%" in str(header.parent):
        raise VolumeFormatError(
            f"{header} names files {pattern[:100]!r}; allowed: one place for a number, such as "
            "slice%03d.raw"
        )
    if not all(re.fullmatch(r"-?\d{1,9}", number) for number in numbers) or len(numbers) != 3:
        raise VolumeFormatError(
            f"{header} numbers files by {' '.join(numbers)[:100]!r}; allowed: first, last and step"
        )
    first, last, step = (int(number) for number in numbers)
    count = (last - first) // step + 1 if step else 0
    if not 1 <= count <= MOST_FILES:
        raise VolumeFormatError(
            f"{header} numbers files from {first} to {last} by {step}; allowed: 1 to {MOST_FILES} "
            "files"
        )
    return [pattern % number for number in range(first, first + count * step, step)]


def check_held(header: Path, files: Sequence[Path], *, wanted: int, ratio: int = 1) -> None:
    """Refuses files that cannot hold the voxels that a header promises.

    Args:
        header: For the message.
        files: All that hold voxels.
        wanted: Bytes of all voxels.
        ratio: Times that the files may be packed.

    Raises:
        VolumeFormatError: They are too short.
    """
    for file in files:
        # ITK opens them unseen
        note_read(file)
    held = sum(file.stat().st_size for file in files)
    if wanted > ratio * held:
        packed = " of packed voxels" if ratio > 1 else ""
        raise VolumeFormatError(
            f"{header} is truncated: its header announces {wanted} bytes of voxels, {held} bytes"
            f"{packed} are there; allowed: complete files"
        )
