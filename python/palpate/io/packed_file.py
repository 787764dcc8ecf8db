"""Files that may be compressed by gzip, told by their bytes and not by their names."""

from __future__ import annotations

import gzip
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from palpate.base.errors import VolumeFormatError

__all__ = ["MOST_RATIO", "check_rest", "is_packed", "unpacked_file"]

GZIP = b"\x1f\x8b"
MOST_RATIO = 1032
"""Times that deflate can make bytes more."""
CHUNK = 1 << 20
MOST_REST = 1 << 24
"""Bytes behind the voxels that are looked through for the checksum at their end."""


def is_packed(path: Path) -> bool:
    """Says whether a file is compressed by gzip."""
    with path.open("rb") as file:
        return file.read(2) == GZIP


@contextmanager
def unpacked_file(path: Path) -> Iterator[IO[bytes]]:
    """Opens a file to read what it holds once decompressed.

    Raises:
        VolumeFormatError: What is read of it ends early, or does not fit its checksum.
    """
    try:
        if is_packed(path):
            with gzip.open(path, "rb") as file:
                yield file  # type: ignore[misc]  # it reads as a file does
        else:
            with path.open("rb") as plain:
                yield plain
    except EOFError:
        raise VolumeFormatError(
            f"{path} is truncated: its compressed bytes end early; allowed: complete files"
        ) from None
    except (zlib.error, gzip.BadGzipFile) as error:
        raise VolumeFormatError(
            f"{path} is damaged: its compressed voxels do not fit their checksum ({error}); "
            "allowed: undamaged files"
        ) from None


def check_rest(file: IO[bytes]) -> None:
    """Reads on to the end of a compressed file, where its checksum stands.

    Raises:
        EOFError: It ends early.
        gzip.BadGzipFile: The checksum differs.
    """
    try:
        for _ in range(MOST_REST // CHUNK):
            if not file.read(CHUNK):
                return
    except gzip.BadGzipFile as error:
        # bytes of anything may follow the last member
        if not str(error).startswith("Not a gzipped file"):
            raise
