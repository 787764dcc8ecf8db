"""Image files in archives and folders: which one is meant, and its reading."""

from __future__ import annotations

from pathlib import Path

from palpate.base.counted import listed
from palpate.base.errors import SeriesChoiceError, VolumeFormatError
from palpate.base.progress import Progress
from palpate.io.dicom.series import MOST_FILES, series_in
from palpate.io.image_file import image_files, read_file
from palpate.io.raw_scan import RawScan

__all__ = ["image_of", "read_unpacked"]

MOST_NAMED = 12
"""Files named in one message."""


def image_of(folder: Path, wanted: str | None, *, called: Path, progress: Progress) -> Path | None:
    """Returns the image file that is meant in a folder or unpacked archive; None where DICOM is.

    DICOM goes before image files, unless one of them is ``wanted``: by its name, or by its number
    in the list of all, DICOM first.

    Raises:
        SeriesChoiceError: There are several, and no DICOM, or not the one asked for.
    """
    images = {
        path.relative_to(folder).as_posix(): path for path in image_files(folder, among=MOST_FILES)
    }
    if wanted in images:
        return images[wanted]
    if not images:
        return None
    # numbers go on after those of the series
    series = _count_of_series(folder, progress)
    number = int(wanted) - series if wanted is not None and wanted.isdecimal() else 0
    if 1 <= number <= len(images):
        return [*images.values()][number - 1]
    if series > 0:
        return None
    if wanted is None and len(images) == 1:
        return next(iter(images.values()))
    named = listed([*images], most=MOST_NAMED)
    asked = "" if wanted is None else f", and none is {wanted!r}"
    raise SeriesChoiceError(
        f"{called} holds {len(images)} image files{asked}; choose one with `series=NAME`: {named}"
    )


def _count_of_series(folder: Path, progress: Progress) -> int:
    try:
        return len(series_in(folder, progress=progress)[0])
    except VolumeFormatError:
        return 0


def read_unpacked(
    image: Path,
    folder: Path,
    *,
    called: Path,
    frame: int | None = None,
    max_voxels: int,
    progress: Progress,
) -> RawScan:
    """Reads an image file of an unpacked archive; messages name it as one of the archive.

    Raises:
        VolumeFormatError: It is no volume, is damaged, has too many voxels, or names files
            elsewhere.
    """
    try:
        return read_file(image, frame=frame, max_voxels=max_voxels, progress=progress)
    except VolumeFormatError as error:
        raise type(error)(str(error).replace(f"{folder}/", f"{called}: ")) from None
