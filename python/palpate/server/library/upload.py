"""Files that are dropped into the page: into a folder of our own, for as long as they are needed.

Files that a server sent wait there too, where one of several volumes is still to be chosen.

Names and sizes are announced first and bounded; each file then has exactly the announced bytes.
Folders are kept, since series lie in them; a name that leads elsewhere is refused.
"""

from __future__ import annotations

import shutil
from itertools import count
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from typing import BinaryIO

import msgspec
from starlette.requests import ClientDisconnect, Request

from palpate.base.errors import OptionError

__all__ = ["MOST_UPLOAD_BYTES", "MOST_UPLOAD_FILES", "Upload", "UploadedFile", "Uploads"]

MOST_UPLOAD_FILES = 50_000
MOST_UPLOAD_BYTES = 16 * 2**30
"""Bytes of one upload, as for archives."""
MOST_UPLOADS = 4
"""Uploads that wait to be opened; the oldest is removed for another."""
SPARE = 2**28
"""Bytes of the disk that are left free."""
LONGEST_NAME = 255
"""Bytes of one part of a path."""
FORBIDDEN = frozenset('\\/:*?"<>|')
"""In names, on one system or another."""


class UploadedFile(msgspec.Struct, frozen=True):
    """A file that will come."""

    name: str
    """With its folders, parted by "/"."""
    size: int


class Upload:
    """Files of one drop, and the folder that they come into."""

    def __init__(self, wanted: list[UploadedFile]) -> None:
        """Makes the folder.

        Raises:
            OptionError: They are too many, too large, or a name cannot be.
        """
        _check(wanted)
        self.folder = TemporaryDirectory(prefix="palpate-")
        root = Path(self.folder.name)
        try:
            total = sum(one.size for one in wanted)
            room = shutil.disk_usage(root).free - SPARE
            if total > room:
                raise OptionError(
                    f"{total / 2**20:.0f} MiB given; allowed: {max(0, room) / 2**20:.0f} MiB, the "
                    "room in the folder for temporary files (TMPDIR)"
                )
            self.files = [(root.joinpath(*_parts(one.name)), one.size) for one in wanted]
            if len({str(path).casefold() for path, _ in self.files}) < len(self.files):
                raise OptionError("two files have one name; allowed: files with different names")
        except BaseException:
            self.folder.cleanup()
            raise
        self._missing = set(range(len(wanted)))

    @property
    def path(self) -> Path:
        """What was dropped: the one file or folder that it is, else the folder with all of it.

        Raises:
            OptionError: Files have not come.
        """
        if self._missing:
            raise OptionError(
                f"{len(self._missing)} files have not come; allowed: give the files again"
            )
        root = Path(self.folder.name)
        within = list(root.iterdir())
        return within[0] if len(within) == 1 else root

    @property
    def loose(self) -> bool:
        """Whether several files or folders were dropped, which have no name together."""
        return self.path == Path(self.folder.name)

    async def take(self, number: int, request: Request) -> None:
        """Takes the bytes of a file.

        Raises:
            OptionError: They are not as many as announced, or come twice.
        """
        if number not in self._missing:
            raise OptionError(f"file {number} is not waited for; allowed: each once")
        path, size = self.files[number]
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            with path.open("xb") as file:
                await _receive(request, file, size=size)
        except BaseException:
            path.unlink(missing_ok=True)
            raise
        self._missing.discard(number)


class Whole(Upload):
    """Files that are there already, in a folder of their own."""

    def __init__(self, folder: TemporaryDirectory[str]) -> None:
        """Takes the folder."""
        self.folder = folder
        self.files = []
        self._missing = set()


class Uploads:
    """Those that wait to be opened."""

    def __init__(self) -> None:
        """Begins without any."""
        self._numbers = count(1)
        self._waiting: dict[int, Upload] = {}

    def begin(self, wanted: list[UploadedFile]) -> int:
        """Makes room for files; returns the number of the upload.

        Raises:
            OptionError: They are too many, too large, or a name cannot be.
        """
        return self._wait_for(Upload(wanted))

    def keep(self, folder: TemporaryDirectory[str]) -> int:
        """Takes files that were downloaded; returns a number, as for an upload."""
        return self._wait_for(Whole(folder))

    def _wait_for(self, upload: Upload) -> int:
        number = next(self._numbers)
        self._waiting[number] = upload
        while len(self._waiting) > MOST_UPLOADS:
            self.drop(min(self._waiting))
        return number

    def of(self, number: int) -> Upload:
        """Returns an upload.

        Raises:
            OptionError: There is none, any more.
        """
        try:
            return self._waiting[number]
        except KeyError:
            raise OptionError(f"upload {number} is gone; allowed: give the files again") from None

    def take_out(self, number: int) -> TemporaryDirectory[str]:
        """Returns an upload's folder, which now belongs to whoever asked."""
        return self._waiting.pop(number).folder

    def drop(self, number: int) -> None:
        """Removes an upload and its files."""
        upload = self._waiting.pop(number, None)
        if upload is not None:
            upload.folder.cleanup()

    def close(self) -> None:
        """Removes all of them."""
        for number in list(self._waiting):
            self.drop(number)


def _check(wanted: list[UploadedFile]) -> None:
    if not 1 <= len(wanted) <= MOST_UPLOAD_FILES:
        raise OptionError(f"{len(wanted)} files given; allowed: 1 to {MOST_UPLOAD_FILES}")
    if any(one.size < 0 for one in wanted):
        raise OptionError("a file of less than nothing was told; allowed: 0 bytes or more")
    total = sum(one.size for one in wanted)
    if total > MOST_UPLOAD_BYTES:
        raise OptionError(
            f"{total / 2**30:.1f} GiB given; allowed: at most {MOST_UPLOAD_BYTES / 2**30:.0f} GiB"
        )


def _parts(name: str) -> tuple[str, ...]:
    """Returns the parts of a path that stays below where it begins.

    Raises:
        OptionError: It does not, or no system would have such a name.
    """
    parts = PurePosixPath(name).parts
    fits = parts and all(
        part not in (".", "..")
        and not FORBIDDEN & set(part)
        and part.isprintable()
        and len(part.encode()) <= LONGEST_NAME
        for part in parts
    )
    if not fits or len(parts) > 32:
        raise OptionError(
            "a file's name leads elsewhere; allowed: names and folders below the drop"
        )
    return parts


async def _receive(request: Request, file: BinaryIO, *, size: int) -> None:
    received = 0
    try:
        async for chunk in request.stream():
            received += len(chunk)
            if received > size:
                raise OptionError(f"more than the {size} bytes that were told have come")
            file.write(chunk)
    except ClientDisconnect:
        raise OptionError("the page has left while a file came") from None
    if received < size:
        raise OptionError(f"{received} of {size} bytes have come; allowed: give the files again")
