"""Which series folders and files of DICOM hold, and which one of them is meant."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice
from pathlib import Path

from palpate.base.errors import OptionError, SeriesChoiceError, VolumeFormatError
from palpate.base.plain_file import check_plain
from palpate.base.progress import Progress
from palpate.io.called import called_of
from palpate.io.dicom.dose import RTDOSE
from palpate.io.dicom.header import Series, find_series
from palpate.io.dicom.mark import is_dicom
from palpate.io.dicom.series_folds import folds
from palpate.volumes.siblings import Siblings

__all__ = [
    "MOST_FILES",
    "choose_series",
    "is_dicom",
    "series_among",
    "series_in",
    "siblings_of",
]

MOST_ODD = 2
"""Slices that are no scan, beside one."""
MOST_LISTED = 12
"""Series named in one message."""
MOST_FILES = 50_000
"""Files looked at in one folder: ten of the largest studies, and not a whole disc."""


def series_in(
    folder: Path, *, called: Path | None = None, progress: Progress
) -> tuple[list[Series], list[Path]]:
    """Lists the series of scans in a folder and those below, the longest first, and damaged files.

    Raises:
        VolumeFormatError: There is none.
    """
    return _series_of(_files_below(folder), called or folder, progress)


def series_among(paths: Sequence[Path], *, progress: Progress) -> tuple[list[Series], list[Path]]:
    """Lists the series of scans in several files and folders, as ``series_in`` does.

    Raises:
        FileNotFoundError: One of them does not exist.
        OptionError: One of them is neither a folder nor a DICOM file.
        VolumeFormatError: There is none.
    """
    files: dict[Path, None] = {}
    for path in paths:
        if not path.exists():
            raise FileNotFoundError(f"{path} does not exist; allowed: existing files and folders")
        check_plain(path)
        if not path.is_dir() and not is_dicom(path):
            raise OptionError(
                f"{path} is one of {len(paths)}; allowed together: DICOM files and folders, "
                "others one by one"
            )
        # the same file may be given twice
        files |= dict.fromkeys(_files_below(path) if path.is_dir() else [path])
    return _series_of(list(files), called_of(paths), progress)


def _series_of(
    files: list[Path], called: Path, progress: Progress
) -> tuple[list[Series], list[Path]]:
    if not files:
        raise VolumeFormatError(
            f"{called} is an empty folder; allowed: a folder with the files of a DICOM series"
        )
    found, damaged = find_series(files, progress)
    if not found:
        raise VolumeFormatError(
            f"{called} holds no DICOM images ({len(files)} files looked at); "
            "allowed: a folder with the files of a DICOM series"
        )
    return found, damaged


def _files_below(folder: Path) -> list[Path]:
    """Lists the files of a folder and of those below it, as archives and discs nest them."""
    files = (
        path for path in folder.rglob("*") if path.is_file() and not _is_of_macos(folder, path)
    )
    listed = list(islice(files, MOST_FILES + 1))
    if len(listed) > MOST_FILES:
        raise VolumeFormatError(
            f"{folder} holds more than {MOST_FILES} files; allowed: the folder of one study"
        )
    return listed


def _is_of_macos(folder: Path, path: Path) -> bool:
    """Says whether a file is what macOS keeps beside others (AppleDouble)."""
    return path.name.startswith("._") or "__MACOSX" in path.relative_to(folder).parts


def choose_series(
    folder: Path, found: list[Series], wanted: str | None
) -> tuple[Series, list[str]]:
    """Returns the series to read, and what to say about those left out.

    Raises:
        SeriesChoiceError: There are several, or not the one asked for.
    """
    listed = _listed(found)
    if wanted is not None:
        chosen = [series for series in found if wanted in (series.uid, series.description)]
        if wanted.isdecimal() and 1 <= int(wanted) <= len(found):
            chosen = chosen or [found[int(wanted) - 1]]
        # odd slices of the series itself leave no doubt either
        if len({series.uid for series in chosen}) == 1 and len(chosen) > 1:
            chosen = [series for series in chosen if series.slices > MOST_ODD] or chosen
        if len(chosen) == 1:
            odd = [one for one in found if one is not chosen[0] and one.uid == chosen[0].uid]
            return chosen[0], [
                f"left out of the series: {one}{_files_told(one)}"
                for one in odd
                if one.slices <= MOST_ODD and not one.part
            ]
        raise SeriesChoiceError(
            f"{folder} holds {len(chosen) or 'no'} series {wanted!r}; "
            f"allowed with `series=NAME`: a number, UID or description of {listed}"
        )

    # a scout of one or two slices or a dose beside a scan leaves no doubt which one is meant
    scans = [series for series in found if series.modality != RTDOSE] or found
    volumes = [series for series in scans if series.slices > MOST_ODD]
    if len(scans) > 1 and len(volumes) != 1:
        raise SeriesChoiceError(
            f"{folder} holds {len(found)} series; choose one with `series=NUMBER` or its UID: "
            f"{listed}"
        )
    chosen_one = volumes[0] if volumes else scans[0]
    left_out = [
        f"left out series {series}{_files_told(series)}"
        for series in found
        if series is not chosen_one
    ]
    return chosen_one, left_out


def siblings_of(chosen: Series, found: Sequence[Series]) -> Siblings | None:
    """Returns the volumes of a series, as numbers of a list; None of one that is alone."""
    numbers = [
        number
        for number, one in enumerate(found, 1)
        if one.volume_of is not None and one.volume_of == chosen.volume_of
    ]
    if len(numbers) < 2:
        return None
    place = next(number for number, one in enumerate(found, 1) if one is chosen)
    return Siblings("series", tuple(map(str, numbers)), numbers.index(place) + 1)


def _files_told(series: Series) -> str:
    """Names the files of a few slices, which may be bad ones of another series."""
    names = ", ".join(header.path.name for header in series.headers)
    return f" ({names})" if len(series.headers) <= MOST_ODD else ""


def _listed(found: list[Series]) -> str:
    rows = [_told(found, places) for places in folds([series.volume_of for series in found])]
    more = len(rows) - MOST_LISTED
    return "; ".join(rows[:MOST_LISTED]) + (f"; and {more} more" if more > 0 else "")


def _told(found: list[Series], places: range) -> str:
    first, last = found[places[0]], found[places[-1]]
    if len(places) == 1:
        return f"[{places[0] + 1}] {first}"
    return (
        f"[{places[0] + 1} to {places[-1] + 1}] {first.uid} {first.whole!r} {first.modality}, "
        f"{len(places)} volumes: {first.part} to {last.part}"
    )
