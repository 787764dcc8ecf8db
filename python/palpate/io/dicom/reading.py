"""Reading of DICOM: a folder or files with the slices of a series, or one file with all of them.

Headers are read first, and say where the slices lie and what is wrong with them; then pixels
are decoded, several files at a time, and laid on a right grid where the stack is none.

Frame: LPS [mm].
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from palpate.base.counted import counted
from palpate.base.errors import VolumeFormatError
from palpate.base.progress import Progress, silent
from palpate.io.called import called_of
from palpate.io.dicom.dicomdir import is_dicomdir, listed_files
from palpate.io.dicom.dose import dose_told
from palpate.io.dicom.geometry import Grid, Stack, grid_of, stack_of
from palpate.io.dicom.header import Header, Series, find_series, read_header, volumes_in
from palpate.io.dicom.mixtures import mixture_told
from palpate.io.dicom.pixels import SlicePixels, read_slices
from palpate.io.dicom.promises import check_numbers
from palpate.io.dicom.resample import resample
from palpate.io.dicom.series import (
    choose_series,
    series_among,
    series_in,
    siblings_of,
)
from palpate.io.dicom.suv import quantified
from palpate.io.dicom.unplaced import grid_unplaced, in_told_order
from palpate.io.dicom.usable import left_out, tolerable, usable
from palpate.io.raw_scan import RawScan, check_shape
from palpate.volumes.stored_values import Scale

__all__ = [
    "Plan",
    "plan_of",
    "read_dicom_file",
    "read_dicom_files",
    "read_dicom_folder",
    "volumes_of",
]


def read_dicom_folder(
    folder: Path,
    *,
    series: str | None,
    max_voxels: int,
    progress: Progress,
    called: Path | None = None,
) -> RawScan:
    """Reads the series in a folder and the folders below, or the one asked for of several.

    Messages call the folder as it is ``called``, where its files come from elsewhere.

    Raises:
        SeriesChoiceError: There are several series, or not the one asked for.
        VolumeFormatError: There is none, or it is no stack of slices.
    """
    found = series_in(folder, called=called, progress=progress)
    return _read_chosen(
        called or folder, found, series=series, max_voxels=max_voxels, progress=progress
    )


def read_dicom_files(
    paths: Sequence[Path], *, series: str | None, max_voxels: int, progress: Progress
) -> RawScan:
    """Reads the series in several files and folders, or the one asked for of several.

    Raises:
        FileNotFoundError: One of them does not exist.
        OptionError: One of them is neither.
        SeriesChoiceError: There are several series, or not the one asked for.
        VolumeFormatError: There is none, or it is no stack of slices.
    """
    found = series_among(paths, progress=progress)
    return _read_chosen(
        called_of(paths), found, series=series, max_voxels=max_voxels, progress=progress
    )


def _read_chosen(
    called: Path,
    found: tuple[list[Series], list[Path]],
    *,
    series: str | None,
    max_voxels: int,
    progress: Progress,
) -> RawScan:
    listed, damaged = found
    chosen, warnings = choose_series(called, listed, series)
    what = f"{called} (series {chosen.uid})" if chosen.uid else str(called)
    scan = _read_series(what, chosen, max_voxels=max_voxels, progress=progress)
    scan.description = chosen.description
    scan.name = chosen.description or called.name.removesuffix(".zip")
    scan.siblings = siblings_of(chosen, listed)
    scan.warnings[:0] = warnings
    if damaged:
        trouble = _trouble(damaged)
        some = counted(len(damaged), f"file is {trouble} and was", f"files are {trouble} and were")
        scan.warnings.append(f"{some} left out, such as {damaged[0].name}")
    return scan


def _trouble(files: Sequence[Path]) -> str:
    return " or ".join(
        words
        for words, found in (
            ("damaged", any(path.exists() for path in files)),
            ("missing", not all(path.exists() for path in files)),
        )
        if found
    )


def read_dicom_file(
    path: Path, *, series: str | None, max_voxels: int, progress: Progress
) -> RawScan:
    """Reads a file that holds all slices of a volume, or the one asked for of several.

    Raises:
        SeriesChoiceError: It holds several volumes, such as times, or not the one asked for.
        VolumeFormatError: The file holds one slice, no image, or no stack of slices.
    """
    if is_dicomdir(path):
        found = _listed(path, progress)
        return _read_chosen(path, found, series=series, max_voxels=max_voxels, progress=progress)
    listed = volumes_of(path)
    chosen, _ = choose_series(path, listed, series)
    scan = _read_series(str(path), chosen, max_voxels=max_voxels, progress=progress)
    scan.siblings = siblings_of(chosen, listed)
    scan.description = chosen.description
    scan.name = chosen.description or path.stem
    return scan


def volumes_of(path: Path) -> list[Series]:
    """Lists the volumes that one file holds, such as times and echoes; of a DICOMDIR its series.

    Raises:
        VolumeFormatError: The file holds no image.
    """
    if is_dicomdir(path):
        return _listed(path, silent)[0]
    header = read_header(path)
    if header is None:
        raise VolumeFormatError(
            f"{path} is a DICOM file without an image of a scan; allowed: CT, MR and other scans"
        )
    return volumes_in(Series(header.series, header.description, header.modality, (header,)))


def _listed(path: Path, progress: Progress) -> tuple[list[Series], list[Path]]:
    """Lists the series that a DICOMDIR names, and what of them is damaged or missing."""
    files, missing = listed_files(path)
    found, damaged = find_series(files, progress)
    if not found:
        raise VolumeFormatError(
            f"{path} lists no images of a scan that are there ({len(files)} of "
            f"{len(files) + len(missing)} files found below its folder); allowed: a DICOMDIR with "
            "the files that it lists, or their folder"
        )
    return found, damaged + missing


@dataclass(frozen=True)
class Plan:
    """How a series is read, as its headers say before any pixel is."""

    series: Series
    """With each slice once."""
    stack: Stack | None
    """None where the files tell no positions."""
    grid: Grid
    said: tuple[str, ...]
    """What was left out."""

    @property
    def size(self) -> tuple[int, int, int]:
        """Voxels along x, y, z."""
        return self.grid.size

    @property
    def middle(self) -> tuple[Header, int]:
        """The file with the middle slice, and which of its frames that is."""
        frames = [(one, index) for one in self.series.headers for index in range(len(one.frames))]
        order = range(len(frames)) if self.stack is None else self.stack.order
        return frames[order[len(frames) // 2]]


def plan_of(what: str, series: Series, *, max_voxels: int) -> Plan:
    """Finds how a series is read.

    Raises:
        VolumeFormatError: It is no stack of slices, or has too many voxels.
    """
    first = series.headers[0]
    if first.samples != 1:
        raise VolumeFormatError(
            f"{what} has {first.samples} numbers per pixel, as colour images have; "
            "allowed: one intensity per pixel"
        )
    check_shape(what, (first.columns, first.rows, series.slices), max_voxels)
    series, said = usable(what, series)
    said += dose_told(what, series)
    check_shape(what, (first.columns, first.rows, series.slices), max_voxels)
    check_numbers(what, series.headers)
    stack = stack_of(what, [frame for header in series.headers for frame in header.frames])
    if stack is None:
        ordered, order = in_told_order(series.headers)
        series = replace(series, headers=ordered)
        grid = grid_unplaced(ordered, order)
    else:
        said += stack.told
        grid = grid_of(what, stack, columns=first.columns, rows=first.rows)
        check_shape(what, grid.size, max_voxels)
        if all(len(header.frames) == 1 for header in series.headers):
            # files in the order of their slices need not be moved once they are decoded
            series = replace(series, headers=tuple(series.headers[i] for i in stack.order))
            stack = replace(stack, order=tuple(range(len(stack.order))))
    return Plan(series, stack, grid, (*said, *_told(series)))


def _told(series: Series) -> tuple[str, ...]:
    """Says what is wrong with headers, once for all that say the same."""
    found = Counter(words for header in series.headers for words in header.told)
    count = len(series.headers)
    of_headers = (
        words if times == count else f"{words} ({times} of {count} files)"
        for words, times in found.items()
    )
    return (*_missing_parts(series), *mixture_told(series), *of_headers)


def _read_series(what: str, series: Series, *, max_voxels: int, progress: Progress) -> RawScan:
    # where the slices lie, before the long work
    plan = plan_of(what, series, max_voxels=max_voxels)
    series, told = quantified(what, plan.series)
    plan = replace(plan, series=series)
    pixels = read_slices(series.headers, progress=progress)
    if pixels.failed:
        plan = _without_failed(what, plan, pixels, max_voxels=max_voxels)
    values = pixels.values
    if plan.stack is not None:
        if plan.stack.order != tuple(range(len(values))):
            values = values[list(plan.stack.order)]
        if plan.grid.resampled:
            values = resample(values, plan.stack, plan.grid, air=pixels.air, progress=progress)
    scan = _scan(plan, values)
    scan.warnings += [*plan.said, *told]
    if pixels.padded:
        _tell_padding(scan, pixels)
    return scan


def _tell_padding(scan: RawScan, pixels: SlicePixels) -> None:
    """Notes how many voxels of padding became air; warns where they may be more than padding."""
    unit = f" {scan.unit}" if scan.unit else ""
    some = counted(pixels.padded, "voxel of padding was", "voxels of padding were")
    said = f"{some} set to {pixels.air:g}{unit}, as air (PixelPaddingValue)"
    if pixels.measurable is None:
        scan.notes.append(said)
        return
    low, high = pixels.measurable
    ends = f"{low:g}" if low == high else f"{low:g} to {high:g}"
    scan.warnings.append(f"{said}: tissue may have their value, {ends}{unit}, too")


def _missing_parts(series: Series) -> tuple[str, ...]:
    """Says which files of an image of many frames are missing."""
    parts = [header.concatenation for header in series.headers if header.concatenation]
    there = {part.number for part in parts}
    total = max([0, *there, *(part.total or 0 for part in parts)])
    missing = [str(number) for number in range(1, total + 1) if number not in there]
    if not missing:
        return ()
    return (f"parts {', '.join(missing)} of {total} files of the scan are missing",)


def _without_failed(what: str, plan: Plan, pixels: SlicePixels, *, max_voxels: int) -> Plan:
    """Returns how a series is read without the few files that cannot be decoded.

    Raises:
        VolumeFormatError: They are too many.
    """
    headers = plan.series.headers
    first, why = pixels.failed[0]
    if len(first.frames) > 1 or not tolerable(len(pixels.failed), len(headers)):
        raise why
    told = left_out([(header, "not to be decoded") for header, _ in pixels.failed], len(headers))
    failed = {header.path for header, _ in pixels.failed}
    kept = tuple(header for header in headers if header.path not in failed)
    again = plan_of(what, replace(plan.series, headers=kept), max_voxels=max_voxels)
    return replace(again, said=(*plan.said, told))


def _scan(plan: Plan, values: NDArray[Any]) -> RawScan:
    series, grid = plan.series, plan.grid
    scales = {
        None if header.table else frame.scale
        for header in series.headers
        for frame in header.frames
    }
    scale = scales.pop() if len(scales) == 1 else None
    scan = RawScan(
        values=values,
        spacing=grid.spacing,
        origin=grid.origin,
        direction=grid.direction,
        name="",
        modality=series.modality,
        unit=series.headers[0].unit,
        series=series.uid,
        frame=series.headers[0].frame,
        subject=series.headers[0].subject,
        file_scale=Scale(*scale) if scale else None,
        orientation_known=plan.stack is not None,
    )
    if series.headers[0].inverted:
        said = "the files want low values bright (MONOCHROME1)"
        if scan.unit:
            scan.notes.append(f"{said}: {scan.unit} are kept as they are")
        else:
            scan.warnings.append(f"{said}: values are turned around")
    if grid.told:
        scan.warnings.append("; ".join(grid.told))
    return scan
