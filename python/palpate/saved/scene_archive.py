"""The zip archive of a scene file: reading of its members, and detection of damage."""

from __future__ import annotations

import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from palpate.base.damaged_file import is_wrong_place
from palpate.base.errors import SceneFormatError

__all__ = ["check_size", "check_whole", "member", "opened"]

CHUNK = 1 << 20
"""Bytes that are unpacked at a time."""


def opened(path: Path) -> zipfile.ZipFile:
    """Yields the archive of a scene file.

    Raises:
        SceneFormatError: It is not a zip archive.
    """
    try:
        return zipfile.ZipFile(path)
    except (zipfile.BadZipFile, OSError) as error:
        if isinstance(error, OSError) and not is_wrong_place(error):
            raise
        raise SceneFormatError(
            f"{path} is no scene file, or a damaged one ({error}); allowed: a file that "
            "Palpate saved"
        ) from None


def member(path: Path, archive: zipfile.ZipFile, name: str) -> bytes:
    """Returns the content of a member of the archive at ``path``.

    Raises:
        SceneFormatError: The member is missing or damaged.
    """
    with _damage_told(path, name):
        return archive.read(name)


def check_whole(path: Path, archive: zipfile.ZipFile, name: str) -> None:
    """Refuses a member with a wrong checksum, without unpacking all of it at once.

    Raises:
        SceneFormatError: The member is missing or damaged.
    """
    with _damage_told(path, name), archive.open(name) as file:
        while file.read(CHUNK):
            pass


def check_size(path: Path, archive: zipfile.ZipFile, name: str, *, exact: int) -> None:
    """Refuses a member of another size [bytes], before anything of it is unpacked.

    Raises:
        SceneFormatError: It has another size.
    """
    if any(each.filename == name and each.file_size != exact for each in archive.filelist):
        raise SceneFormatError(f"{path}: {name} is damaged: not {exact} bytes")


@contextmanager
def _damage_told(path: Path, name: str) -> Iterator[None]:
    try:
        yield
    except KeyError:
        raise SceneFormatError(f"{path}: {name} is missing; the file is damaged") from None
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as error:
        raise SceneFormatError(f"{path}: {name} is damaged: {error}") from None
    except OSError as error:
        if is_wrong_place(error):
            raise SceneFormatError(f"{path}: {name} is damaged: {error}") from None
        raise
