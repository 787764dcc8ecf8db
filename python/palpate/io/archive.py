"""Zip archives of DICOM or image files, as hospitals and archives send them.

Entries are unpacked into a folder of our own. Plain names are kept, since headers name the files
beside them; all others become numbers, so that no name in an archive can lead out of it. How much
may come out is bounded before anything is written.
"""

from __future__ import annotations

import re
import shutil
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory

from palpate.base.errors import VolumeFormatError
from palpate.base.progress import Progress

__all__ = ["is_archive", "unpacked"]

MOST_ENTRIES = 50_000
MOST_BYTES = 16 * 2**30
"""Unpacked: four times the largest scan that is read by default."""
MOST_RATIO = 200
"""Times that an entry may be larger than packed: deflate reaches 1000 on zeros, images 50."""
MOST_FOLDERS = 16
LONGEST_NAME = 200
"""Of a file or folder [bytes]."""
SMALL = 2**20
"""Entries below this may be packed however well [bytes]."""


def is_archive(path: Path) -> bool:
    """Says whether a file is a zip archive."""
    return path.is_file() and zipfile.is_zipfile(path)


@contextmanager
def unpacked(path: Path, progress: Progress) -> Iterator[Path]:
    """Gives a folder with the files of an archive, for as long as it is needed.

    Raises:
        VolumeFormatError: The archive is damaged, encrypted, or holds too much.
    """
    with TemporaryDirectory(prefix="palpate-") as folder:
        try:
            with zipfile.ZipFile(path) as archive:
                _unpack(path, archive, Path(folder), progress=progress)
        except (
            zipfile.BadZipFile, EOFError, NotImplementedError, zlib.error, FileExistsError,
            NotADirectoryError, IsADirectoryError,
        ) as error:  # fmt: skip
            raise VolumeFormatError(
                f"{path} is a damaged or unusual archive ({error}); allowed: complete zip archives"
            ) from None
        yield Path(folder)


def _unpack(path: Path, archive: zipfile.ZipFile, folder: Path, *, progress: Progress) -> None:
    entries = [entry for entry in archive.infolist() if not entry.is_dir()]
    _check(path, entries, room=shutil.disk_usage(folder).free)
    taken: set[str] = set()
    for number, entry in enumerate(entries):
        progress(f"unpacking {len(entries)} files", number / len(entries))
        name = _safe(entry.filename)
        # also where the disk does not tell large letters from small ones
        if name is None or name.casefold() in taken:
            name = f"{number:05}"
        taken.add(name.casefold())
        path_here = folder / name
        path_here.parent.mkdir(parents=True, exist_ok=True)
        with archive.open(entry) as source, path_here.open("xb") as target:
            # no more comes out than the entry announces
            shutil.copyfileobj(source, target, 1 << 20)


def _safe(name: str) -> str | None:
    """Returns a name of an entry with its folders, where nothing in it leads elsewhere."""
    parts = PurePosixPath(name).parts
    plain = 1 <= len(parts) <= MOST_FOLDERS and all(
        re.fullmatch(r"[\w ()+,=@-][\w ()+,.=@-]*", part)
        and not part.endswith((".", " "))
        and len(part.encode()) <= LONGEST_NAME
        for part in parts
    )
    return "/".join(parts) if plain else None


def _check(path: Path, entries: list[zipfile.ZipInfo], *, room: int) -> None:
    if len(entries) > MOST_ENTRIES:
        raise VolumeFormatError(
            f"{path} holds {len(entries)} files; allowed: at most {MOST_ENTRIES}, as of one study"
        )
    if any(entry.flag_bits & 1 for entry in entries):
        raise VolumeFormatError(f"{path} is encrypted; allowed: archives without a password")
    size = sum(entry.file_size for entry in entries)
    if size > MOST_BYTES:
        raise VolumeFormatError(
            f"{path} would unpack to {size / 2**30:.1f} GiB; allowed: at most "
            f"{MOST_BYTES / 2**30:.0f} GiB"
        )
    for entry in entries:
        if entry.file_size > max(SMALL, MOST_RATIO * entry.compress_size):
            raise VolumeFormatError(
                f"{path} holds an entry that unpacks to {entry.file_size / 2**20:.0f} MiB from "
                f"{entry.compress_size} bytes; allowed: at most {MOST_RATIO} times its packed size"
            )
    if size > room:
        raise VolumeFormatError(
            f"{path} would unpack to {size / 2**20:.0f} MiB, {room / 2**20:.0f} MiB are free; "
            "allowed: with room for its files in the folder for temporary ones (TMPDIR)"
        )
