"""Headers of NIfTI files, checked as they are: libraries mend what cannot be, and say nothing.

A size or place of 0, NaN or 1e300 mm, and an offset or scale that is no number, are refused.

Source: NIfTI-1 header (R. Cox et al. 2004); NIfTI-2 header (2011).
"""

from __future__ import annotations

import gzip
import math
import struct
import zlib
from dataclasses import dataclass
from pathlib import Path

from palpate.base.errors import VolumeFormatError
from palpate.io.detached_voxels import DEFLATE_RATIO

__all__ = ["check_nifti"]

GZIP = b"\x1f\x8b"
LARGEST = 1e9
"""Of a voxel or a place [unit of the file, at least 1 µm]: a kilometre is no patient."""


@dataclass(frozen=True)
class _Layout:
    """Where the fields of a header stand [byte], and how they are written."""

    size: int
    dim: tuple[str, int]
    bits: int
    pixdim: tuple[str, int]
    offset: tuple[str, int]
    scale: tuple[str, int]
    codes: tuple[str, int]
    quaternion: tuple[str, int]
    rows: tuple[str, int]
    magic: int


LAYOUTS = (
    _Layout(348, ("8h", 40), 72, ("8f", 76), ("f", 108), ("2f", 112), ("2h", 252), ("6f", 256),
            ("12f", 280), 344),
    _Layout(540, ("8q", 16), 14, ("8d", 104), ("q", 168), ("2d", 176), ("2i", 344), ("6d", 352),
            ("12d", 400), 4),
)  # fmt: skip


def check_nifti(path: Path) -> None:
    """Refuses a header that no library should mend; one that is none is left to them.

    Raises:
        VolumeFormatError: Sizes, places, an offset or a scale cannot be, or the file is too short.
    """
    try:
        with path.open("rb") as file:
            packed = file.read(2) == GZIP
        with gzip.open(path) if packed else path.open("rb") as file:
            head = file.read(LAYOUTS[1].size)
    except (OSError, EOFError, zlib.error):
        return
    for layout in LAYOUTS:
        for order in "<>":
            if len(head) >= layout.size and struct.unpack_from(f"{order}i", head)[0] == layout.size:
                _check(path, head, layout, order=order, packed=packed)
                return


def _check(path: Path, head: bytes, layout: _Layout, *, order: str, packed: bool) -> None:
    def numbers(field: tuple[str, int]) -> tuple[float, ...]:
        return struct.unpack_from(order + field[0], head, field[1])

    analyze = not head[layout.magic :].startswith((b"n+", b"ni"))
    dim = [int(length) for length in numbers(layout.dim)]
    axes = dim[0]
    # some writers leave axes beyond the third at 0
    if not 1 <= axes <= 7 or min(dim[1 : 1 + min(axes, 3)]) < 1 or min(dim[1 : 1 + axes]) < 0:
        raise VolumeFormatError(f"{path} has dim {dim}; allowed: 1 to 7 axes of 1 voxel or more")
    _check_size(path, dim[1 : 1 + axes], numbers(("h", layout.bits))[0], packed=packed)
    if analyze:
        # its other fields mean something else
        return
    pixdim = numbers(layout.pixdim)
    edges = pixdim[1 : 1 + min(axes, 3)]
    by_rows, by_quaternion = (code > 0 for code in reversed(numbers(layout.codes)))
    # the rows have lengths of their own
    if not all(0.0 < abs(edge) < LARGEST for edge in edges) and not by_rows:
        raise _impossible(path, "pixdim", edges, allowed="voxels of more than 0 mm")
    # a broken transform beside a whole one is told where they are read
    if (
        by_quaternion
        and not by_rows
        and not all(abs(one) < LARGEST for one in numbers(layout.quaternion))
    ):
        raise _impossible(path, "a qform of", numbers(layout.quaternion), allowed="finite numbers")
    if by_rows and not by_quaternion:
        _check_rows(path, numbers(layout.rows))
    offset = numbers(layout.offset)[0]
    if not 0 <= offset <= 1 << 40:
        raise _impossible(path, "vox_offset", (offset,), allowed="0 or more")
    slope, intercept = numbers(layout.scale)
    # 0 and NaN say that there is none
    if slope and not math.isnan(slope) and not (math.isfinite(slope) and math.isfinite(intercept)):
        raise _impossible(path, "slope and intercept", (slope, intercept), allowed="finite numbers")


def _check_size(path: Path, dim: list[int], bits: float, *, packed: bool) -> None:
    if ".hdr" in path.name.lower():
        # the voxels are in another file, which is looked at where they are read
        return
    wanted = math.prod(max(1, length) for length in dim) * int(bits) // 8
    held = path.stat().st_size
    if wanted > held * (DEFLATE_RATIO if packed else 1):
        raise VolumeFormatError(
            f"{path} is truncated: its header announces {wanted} bytes of voxels, {held} bytes"
            f"{' of packed voxels' if packed else ''} are there; allowed: complete files"
        )


def _check_rows(path: Path, rows: tuple[float, ...]) -> None:
    edges = [math.hypot(*(rows[axis + 4 * row] for row in range(3))) for axis in range(3)]
    if not all(abs(one) < LARGEST for one in rows) or not all(edge > 0.0 for edge in edges):
        raise _impossible(
            path, "an sform of", rows, allowed="finite numbers, and voxels of more than 0 mm"
        )


def _impossible(
    path: Path, what: str, numbers: tuple[float, ...], *, allowed: str
) -> VolumeFormatError:
    told = ", ".join(f"{number:g}" for number in numbers)
    return VolumeFormatError(f"{path} has {what} {told}, which cannot be; allowed: {allowed}")
