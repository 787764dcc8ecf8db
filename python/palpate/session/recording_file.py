"""Recordings as files: one compressed NumPy archive with an array for each column.

``numpy.load`` opens a ``.palpate-session`` file too. Ticks are columns with one row for each tick;
what else a replay needs (the state at the start, commands, bricks) has columns of its own, as the
engine provides them; ``about`` is UTF-8 JSON on the origin of the recording. Nothing in a file is
ever executed: arrays are read as plain numbers, and only where type, shape and size are right.

Frames: those of ``recording.py``.
"""

from __future__ import annotations

import math
import re
import zipfile
import zlib
from pathlib import Path
from typing import IO, Any, BinaryIO, cast

import msgspec
import numpy as np
from numpy.typing import NDArray

from palpate.base.damaged_file import is_wrong_place
from palpate.base.errors import RecordingFormatError
from palpate.base.whole_file import whole_file
from palpate.session.recording_columns import (
    SINCE_3,
    SINCE_4,
    TAPE,
    TICKS,
    Columns,
    TapeColumns,
    TickColumns,
    by_name,
)

__all__ = [
    "FORMAT",
    "VERSION",
    "About",
    "AboutScan",
    "AboutSegment",
    "read_file",
    "write_file",
]

FORMAT = "palpate-session"
VERSION = 5
"""Version of the file format; an older Palpate refuses a newer version. Since version 5 the answers
of soft tissue say whether they stay where the next one is late; older ones are dropped then."""
OLDEST_VERSION = 2
"""Oldest version that can be read. It has no tool; the tool counts as resting then."""

MAGIC = b"\x93NUMPY\x01\x00"
HEADER = re.compile(
    rb"\{'descr': '([\x21-\x7e]{1,20})', 'fortran_order': False, "
    rb"'shape': \(((?:\d{1,12}, ?)*\d{0,12})\), \} *\n"
)
"""Header of an array (NEP 1), as NumPy writes it."""

MOST_BYTES = 1 << 32
"""Most unpacked bytes; the longest recording takes a third of it."""

MOST_ABOUT_BYTES = 1 << 20

Vector = tuple[float, float, float]


class AboutScan(msgspec.Struct, frozen=True):
    """The scan of a session; see ``Volume`` for the fields."""

    name: str
    modality: str
    unit: str
    dimensions: tuple[int, int, int]
    spacing: Vector
    origin: Vector
    direction: list[float]


class AboutSegment(msgspec.Struct, frozen=True):
    """A segment at the start of a recording."""

    id: int
    name: str
    touchable: bool
    voxels: int
    range: tuple[float, float] | None


class About(msgspec.Struct, frozen=True):
    """Origin of a recording."""

    format: str
    version: int
    palpate: str
    build: str
    recorded: str
    device: str
    rate_hz: int
    real_time: bool
    scan: AboutScan
    segments: list[AboutSegment]
    settings: dict[str, Any]
    """Settings of touch; the names are those of the version that wrote the file."""


def write_file(path: Path, *, ticks: TickColumns, tape: TapeColumns | None, about: About) -> None:
    """Writes a recording, completely or not at all.

    Raises:
        OSError: The folder cannot be written.
    """
    columns = by_name(ticks) | ({} if tape is None else by_name(tape))
    columns["about"] = np.frombuffer(msgspec.json.encode(about), np.uint8)
    with whole_file(path) as unfinished, unfinished.open("wb") as file:
        np.savez_compressed(file, allow_pickle=False, **columns)


def read_file(path: Path) -> tuple[TickColumns, TapeColumns | None, About]:
    """Reads a recording: its ticks, what else a replay needs, and its origin.

    Raises:
        RecordingFormatError: The file is not a recording, is truncated or damaged.
        OSError: The file cannot be read.
    """
    try:
        with path.open("rb") as file:
            return _read(path, file)
    except (
        zipfile.BadZipFile,
        zlib.error,
        EOFError,
        ValueError,
        # what zipfile raises for ways of packing that it does not know
        NotImplementedError,
        RuntimeError,
    ) as error:
        if isinstance(error, RecordingFormatError):
            raise
        raise _refused(path, f"is damaged ({error})") from None
    except OSError as error:
        if is_wrong_place(error):
            raise _refused(path, f"is damaged ({error})") from None
        raise


def _read(path: Path, file: BinaryIO) -> tuple[TickColumns, TapeColumns | None, About]:
    if not zipfile.is_zipfile(file):
        raise _refused(path, "is no recording, or was cut off")
    with zipfile.ZipFile(file) as archive:
        names = {name.removesuffix(".npy") for name in archive.namelist()}
        size = sum(member.file_size for member in archive.infolist())
        if size > MOST_BYTES:
            raise _refused(path, f"unpacks to {size} bytes; allowed: at most {MOST_BYTES}")
        if "about" not in names:
            raise _refused(path, "is no recording")
        about = _about(path, _column(archive, "about", ("|u1", 0)))

        has_tape = not names.isdisjoint(TAPE)
        stored = [name for name in TICKS if about.version >= 3 or name not in SINCE_3]
        taped = [name for name in TAPE if about.version >= 4 or name not in SINCE_4]
        missing = (set(stored) | (set(taped) if has_tape else set())) - names
        if missing:
            raise _refused(path, f"lacks {', '.join(sorted(missing))}")
        ticks: Columns = {name: _column(archive, name, TICKS[name]) for name in stored}
        for name in set(TICKS) - set(stored):
            ticks[name] = np.zeros(len(ticks["tick"]))
        tape: Columns = (
            {name: _column(archive, name, TAPE[name]) for name in taped} if has_tape else {}
        )
        for name in set(TAPE) - set(taped):
            kind, width = TAPE[name]
            tape[name] = np.zeros((0, width) if width else 0, kind)
    if len({len(column) for column in ticks.values()}) > 1:
        raise _refused(path, "has columns of different length")
    # all names are there, with the right kinds of number
    whole = cast("TapeColumns", tape) if has_tape else None
    return cast("TickColumns", ticks), whole, about


def _about(path: Path, packed: NDArray[Any]) -> About:
    if len(packed) > MOST_ABOUT_BYTES:
        raise _refused(path, "says too much about itself")
    try:
        about = msgspec.json.decode(packed.tobytes(), type=About)
    except msgspec.MsgspecError as error:
        raise _refused(path, f"is no recording ({error})") from None
    if about.format != FORMAT:
        raise _refused(path, f"is of the form {about.format!r}")
    if not OLDEST_VERSION <= about.version <= VERSION:
        raise RecordingFormatError(
            f"{path} has version {about.version} of the form; allowed: version {OLDEST_VERSION} "
            f"to {VERSION} "
            f"(it was written by Palpate {about.palpate})"
        )
    return about


def _column(archive: zipfile.ZipFile, name: str, kind: tuple[str, int]) -> NDArray[Any]:
    """Reads one array; its type and shape are checked before its numbers are read."""
    with archive.open(f"{name}.npy") as member:
        given, shape = _header(name, member)
        width = kind[1]
        fits = len(shape) == (2 if width else 1) and (not width or shape[1] == width)
        if given != kind[0] or not fits:
            raise ValueError(f"{name} holds {given} of shape {list(shape)}")
        # to the end, where the checksum is compared
        numbers = member.read()
    dtype = np.dtype(given)
    if len(numbers) != math.prod(shape) * dtype.itemsize:
        raise ValueError(f"{name} has {len(numbers)} bytes for {list(shape)}")
    return np.frombuffer(numbers, dtype).reshape(shape)


def _header(name: str, member: IO[bytes]) -> tuple[str, tuple[int, ...]]:
    """Reads the header of an array, in the one form that NumPy writes.

    NumPy's own reader accepts any literal of Python, and fails in many ways.
    """
    start = member.read(len(MAGIC) + 2)
    length = int.from_bytes(start[len(MAGIC) :], "little")
    header = HEADER.fullmatch(member.read(length))
    if not start.startswith(MAGIC) or header is None:
        raise ValueError(f"{name} has another form")
    shape = tuple(int(count) for count in header[2].split(b",") if count)
    return header[1].decode("ascii"), shape


def _refused(path: Path, reason: str) -> RecordingFormatError:
    return RecordingFormatError(
        f"{path} {reason}; allowed: a .palpate-session file as `palpate record` writes it"
    )
