"""What scans a folder, an archive or a file holds, for choosing one: what, how large, how it looks.

Headers tell the list; pictures are middle slices, decoded on request, several at a time.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import PalpateError, VolumeFormatError
from palpate.base.plain_file import check_plain
from palpate.base.progress import Progress, silent
from palpate.base.reader_process import apart, apart_each, looking_at
from palpate.io.archive import is_archive, unpacked
from palpate.io.called import called_of
from palpate.io.dicom.header import Header, Series
from palpate.io.dicom.pixels import read_slice
from palpate.io.dicom.reading import plan_of, volumes_of
from palpate.io.dicom.series import MOST_FILES, is_dicom, series_among, series_in
from palpate.io.image_file import form_of, header_of, image_files, middle_of
from palpate.io.preview import preview

__all__ = ["Choice", "browsed", "choices_among", "late_picture", "previews"]

MOST_IMAGES = 200
"""Image files of one folder that are listed."""
MOST_PICTURED = 32
"""Volumes of one image file whose pictures come with the list; the others' come when asked for."""
MOST_THREADS = 4
LARGEST = 1024**3
"""Voxels, as ``palpate.io.read`` has it."""

Picture = Callable[[], NDArray[np.uint8]]
"""Makes a small picture; it may raise what reading raises."""
Fetch = Callable[[Path, Progress], None]


@dataclass(frozen=True)
class MiddleOf:
    """Makes the small picture of a scan's middle slice, in a worker."""

    path: Path
    header: Header | None = None
    """Of DICOM; None for image files."""
    frame: int = 0
    """Of its frames from 0; of the volumes of image files from 1."""
    pixel: tuple[float, float] = (1.0, 1.0)
    """Between columns, between rows [mm], of image files."""

    def __call__(self) -> NDArray[np.uint8]:
        """Returns the picture."""
        return apart(self.draw, path=self.path)

    def draw(self) -> NDArray[np.uint8]:
        """Returns the picture, made in this process."""
        if self.header is not None:
            between = self.header.frames[self.frame].pixel_spacing or (1.0, 1.0)
            return preview(read_slice(self.header, self.frame), (between[1], between[0]))
        with looking_at(self.path, form_of(self.path)):
            return preview(middle_of(self.path, max(1, self.frame)), self.pixel)


@dataclass(frozen=True, kw_only=True)
class Choice:
    """One scan that may be opened."""

    path: Path
    """What ``palpate.io.read`` takes."""
    series: str | None = None
    """Which series of it, as ``read`` takes it."""
    frame: int | None = None
    """Which volume of an image file with several, as ``read`` takes it."""
    patient: str = ""
    study: str = ""
    name: str
    modality: str = ""
    uid: str = ""
    """Of its series; volumes of one series share it."""
    part: str = ""
    """What tells it from other volumes of its series, and ends its name; "" if alone."""
    size: tuple[int, ...]
    """Voxels along x, y, z."""
    spacing: tuple[float, ...] | None = None
    """Along x, y, z [mm]; None where the files do not tell."""
    refused: str | None = None
    """Why it cannot be opened."""
    picture: Picture = field(compare=False)
    """Of its middle."""
    late: bool = False
    """Whether its picture is made only when asked for."""
    fetch: Fetch | None = field(default=None, compare=False)
    """Brings its files into a folder; None where they are at ``path``."""


@contextmanager
def browsed(path: Path, *, progress: Progress = silent) -> Iterator[list[Choice]]:
    """Gives the scans at a path, as long as pictures of them are wanted.

    Raises:
        FileNotFoundError: ``path`` does not exist.
        VolumeFormatError: It holds no scan, or cannot be read.
    """
    if not path.exists():
        raise FileNotFoundError(f"{path} does not exist; allowed: an existing file or folder")
    check_plain(path)
    if is_archive(path):
        with unpacked(path, progress) as folder:
            yield apart(_in_archive, path, folder, path=path, progress=progress)
    else:
        yield apart(_at, path, path=path, progress=progress)


def _at(path: Path, *, progress: Progress) -> list[Choice]:
    """Lists the scans in a folder or file."""
    if path.is_dir():
        return _in_folder(path, progress=progress)
    if is_dicom(path):
        found = volumes_of(path)
        # a single one needs no name
        return _series(path, found) if len(found) > 1 else [_of_series(path, found[0], None)]
    return _image(path, path.name)


def previews(
    choices: Sequence[Choice], *, progress: Progress = silent
) -> Iterator[tuple[int, NDArray[np.uint8]]]:
    """Yields pictures of choices as they are made, with the number of each; none that fail."""
    wanted = {
        number: choice.picture
        for number, choice in enumerate(choices)
        if choice.refused is None and choice.picture is not _nothing and not choice.late
    }
    here = {number: one for number, one in wanted.items() if isinstance(one, MiddleOf)}
    left = dict(here)
    try:
        for number, picture in apart_each(_drawn, here, path=Path("a list"), progress=progress):
            del left[number]
            if picture is not None:
                yield number, picture
    except PalpateError:
        # one of them has ended its reader: each of the others has one more try, alone
        yield from _drawn_alone(left, progress)
    # those of servers are fetched by this process
    for number, picture in _drawn(
        {number: one for number, one in wanted.items() if number not in here}, progress=progress
    ):
        if picture is not None:
            yield number, picture


def late_picture(choice: Choice, *, progress: Progress = silent) -> NDArray[np.uint8]:
    """Returns the picture of a choice, also when its list is no longer ``browsed``.

    Raises:
        FileNotFoundError: Its file is gone.
        PalpateError: It cannot be drawn.
    """
    middle = choice.picture
    if not is_archive(choice.path) or choice.series is None or not isinstance(middle, MiddleOf):
        return middle()
    with unpacked(choice.path, progress) as folder:
        return replace(middle, path=folder / choice.series)()


def _drawn(
    wanted: Mapping[int, Picture], *, progress: Progress
) -> Iterator[tuple[int, NDArray[np.uint8] | None]]:
    """Yields pictures as they are made, several at a time; None for those that fail."""
    with ThreadPoolExecutor(min(MOST_THREADS, os.cpu_count() or 1)) as pool:
        try:
            made = {pool.submit(picture): number for number, picture in wanted.items()}
            for done, future in enumerate(as_completed(made)):
                progress("drawing slices", done / len(wanted))
                try:
                    yield made[future], future.result()
                except (PalpateError, OSError, MemoryError):
                    yield made[future], None
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _drawn_alone(
    wanted: Mapping[int, MiddleOf], progress: Progress
) -> Iterator[tuple[int, NDArray[np.uint8]]]:
    for done, (number, middle) in enumerate(wanted.items()):
        progress("drawing slices", done / len(wanted))
        try:
            yield number, apart(middle.draw, path=middle.path)
        except (PalpateError, OSError, MemoryError):
            continue


def choices_among(paths: Sequence[Path], *, progress: Progress = silent) -> list[Choice]:
    """Lists the scans in several DICOM files and folders together.

    Raises:
        FileNotFoundError: One of them does not exist.
        OptionError: One of them is neither a folder nor a DICOM file.
        VolumeFormatError: They hold no scan.
    """
    return apart(_among, paths, path=called_of(paths), progress=progress)


def _among(paths: Sequence[Path], *, progress: Progress) -> list[Choice]:
    return _series(called_of(paths), series_among(paths, progress=progress)[0])


# --- DICOM --------------------------------------------------------------------------------


def _in_folder(folder: Path, *, progress: Progress, called: Path | None = None) -> list[Choice]:
    images = image_files(folder, among=MOST_FILES)[:MOST_IMAGES]
    try:
        found, _ = series_in(folder, called=called, progress=progress)
    except VolumeFormatError:
        if not images:
            raise
        found = []
    return [
        *_series(called or folder, found),
        *(one for path in images for one in _image(path, path.relative_to(folder).as_posix())),
    ]


def _in_archive(archive: Path, folder: Path, *, progress: Progress) -> list[Choice]:
    listed = _in_folder(folder, progress=progress, called=archive)
    # an image file is one of the archive's, by its name in it
    return [
        one
        if one.path == archive
        else replace(one, path=archive, series=one.path.relative_to(folder).as_posix())
        for one in listed
    ]


def _series(path: Path, found: list[Series]) -> list[Choice]:
    uids = [one.uid for one in found]
    # its place in the list tells it where its UID does not
    return [
        _of_series(path, one, one.uid if one.uid and uids.count(one.uid) == 1 else str(number))
        for number, one in enumerate(found, 1)
    ]


def _of_series(path: Path, one: Series, series: str | None) -> Choice:
    first = one.headers[0]
    size: tuple[int, ...] = (first.columns, first.rows, one.slices)
    spacing, refused, middle = None, None, (first, 0)
    try:
        plan = plan_of("it", one, max_voxels=LARGEST)
    except VolumeFormatError as error:
        refused = str(error)
    else:
        size, middle = plan.size, plan.middle
        spacing = None if plan.stack is None else plan.grid.spacing
    return Choice(
        path=path,
        series=series,
        patient=first.patient,
        study=first.study_told,
        name=one.description,
        modality=one.modality,
        uid=one.uid,
        part=one.part,
        size=size,
        spacing=spacing,
        refused=refused,
        picture=MiddleOf(middle[0].path, *middle),
    )


# --- image files --------------------------------------------------------------------------


def _image(path: Path, name: str) -> list[Choice]:
    """Lists the volumes of an image file; most files hold one."""
    try:
        with looking_at(path, form_of(path)):
            header = header_of(path)
    except VolumeFormatError as error:
        return [Choice(path=path, name=name, size=(), refused=str(error), picture=_nothing)]
    one = Choice(
        path=path,
        name=name,
        size=header.size,
        spacing=header.spacing,
        picture=MiddleOf(path, pixel=header.spacing[:2]),
    )
    if header.frames == 1:
        return [one]
    return [
        replace(
            one,
            name=f"{name}, volume {frame}",
            part=f"volume {frame}",
            frame=frame,
            picture=MiddleOf(path, frame=frame, pixel=header.spacing[:2]),
            late=frame > MOST_PICTURED,
        )
        for frame in range(1, header.frames + 1)
    ]


def _nothing() -> NDArray[np.uint8]:
    return np.zeros((1, 1), np.uint8)
