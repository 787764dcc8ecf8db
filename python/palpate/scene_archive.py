"""The zip archive that a scene file is: what is read out of it, and how damage is told."""

from __future__ import annotations

import zipfile
import zlib
from pathlib import Path

from palpate.errors import SceneFormatError

__all__ = ["check_size", "member", "opened"]


def opened(path: Path) -> zipfile.ZipFile:
    """Returns the archive of a scene file.

    Raises:
        SceneFormatError: It is none.
    """
    try:
        return zipfile.ZipFile(path)
    except zipfile.BadZipFile as error:
        raise SceneFormatError(
            f"{path} is no scene file, or a damaged one ({error}); allowed: a file that "
            "Palpate saved"
        ) from None


def member(path: Path, archive: zipfile.ZipFile, name: str) -> bytes:
    """Returns a whole member of the archive at ``path``.

    Raises:
        SceneFormatError: It is missing or damaged.
    """
    try:
        return archive.read(name)
    except KeyError:
        raise SceneFormatError(f"{path}: {name} is missing; the file is damaged") from None
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as error:
        raise SceneFormatError(f"{path}: {name} is damaged: {error}") from None


def check_size(path: Path, archive: zipfile.ZipFile, name: str, *, exact: int) -> None:
    """Refuses a member of another size [bytes], before anything of it is unpacked.

    Raises:
        SceneFormatError: It has another one.
    """
    if any(each.filename == name and each.file_size != exact for each in archive.filelist):
        raise SceneFormatError(f"{path}: {name} is damaged: not {exact} bytes")
