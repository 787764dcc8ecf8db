"""What is at a path, one scan or a list of them: read in a worker, see ``base.reader_process``.

Nothing here knows of volumes, so that a worker starts quickly.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from palpate.base.errors import OptionError, VolumeFormatError
from palpate.base.plain_file import check_plain
from palpate.base.progress import Progress
from palpate.base.reader_process import looking_at
from palpate.io.archive import is_archive, unpacked
from palpate.io.called import called_of
from palpate.io.dicom.dicomdir import is_dicomdir
from palpate.io.dicom.header import Series
from palpate.io.dicom.mark import is_dicom
from palpate.io.dicom.reading import (
    read_dicom_file,
    read_dicom_files,
    read_dicom_folder,
    volumes_of,
)
from palpate.io.dicom.series import series_among, series_in
from palpate.io.image_file import form_of, read_file
from palpate.io.packed_images import image_of, read_unpacked
from palpate.io.raw_scan import RawScan
from palpate.io.raw_voxels import RawLayout, holds_pictures, is_picture, read_pictures, read_raw
from palpate.io.upright import squared, upright

__all__ = ["scan_at", "series_at", "stored_scan_at"]

MOST_VOXELS = 1024**3
VoxelSize = tuple[float, float, float]


def scan_at(
    places: Sequence[Path],
    *,
    series: str | None,
    frame: int | None,
    raw: str | None,
    voxel_size: VoxelSize | None,
    max_voxels: int,
    progress: Progress,
) -> RawScan:
    """Reads the scan at a path, or at several, with the options of ``palpate.read``.

    Raises:
        FileNotFoundError: A path does not exist.
        VolumeFormatError: It is not a complete, three-dimensional scan with one value per voxel.
        SeriesChoiceError: There are several series, or not the requested one.
        OptionError: An option has a value that is not allowed.
    """
    source = called_of(places)
    _check_options(source, series=series, max_voxels=max_voxels)
    if len(places) > 1:
        _refuse_bare(raw, voxel_size)
        _refuse_frame(source, frame)
        return read_dicom_files(places, series=series, max_voxels=max_voxels, progress=progress)
    if raw is not None or _is_pictures(source, sized=voxel_size is not None):
        _refuse_frame(source, frame)
        layout = None if raw is None else RawLayout.of(raw)
        return _read_bare(
            source, layout, voxel=voxel_size, max_voxels=max_voxels, progress=progress
        )
    if voxel_size is not None:
        raise OptionError(
            f"voxel size given for {source}; allowed: for raw voxels and pictures, others tell it"
        )
    scan = _read(source, series=series, frame=frame, max_voxels=max_voxels, progress=progress)
    return upright(str(source), scan, max_voxels=max_voxels, progress=progress)


def stored_scan_at(path: Path, *, progress: Progress) -> RawScan:
    """Reads the scan at a path as it stands there: its axes may be sheared.

    Raises:
        PalpateError: As ``scan_at``.
    """
    _check_options(path, series=None, max_voxels=MOST_VOXELS)
    scan = _read(path, series=None, frame=None, max_voxels=MOST_VOXELS, progress=progress)
    return squared(scan)


def series_at(places: Sequence[Path], *, progress: Progress) -> list[Series]:
    """Lists the scans in a DICOM folder, a zip archive or several DICOM files, longest first.

    Raises:
        FileNotFoundError: A path does not exist.
        VolumeFormatError: It is none of these, or has no scan.
    """
    if len(places) > 1:
        return series_among(places, progress=progress)[0]
    source = places[0]
    if not source.exists():
        raise FileNotFoundError(f"{source} does not exist; allowed: an existing file or folder")
    check_plain(source)
    if is_archive(source):
        with unpacked(source, progress) as folder:
            return series_in(folder, called=source, progress=progress)[0]
    if not source.is_dir():
        if is_dicom(source) and is_dicomdir(source):
            return volumes_of(source)
        raise VolumeFormatError(
            f"{source} is one file; allowed: a DICOM folder, DICOMDIR or zip archive"
        )
    return series_in(source, progress=progress)[0]


def _refuse_bare(raw: str | None, voxel: tuple[float, float, float] | None) -> None:
    if raw is not None or voxel is not None:
        raise OptionError(
            "a layout or voxel size given for several files; allowed: for one file or folder"
        )


def _check_options(source: Path, *, series: str | None, max_voxels: int) -> None:
    if not source.exists():
        raise FileNotFoundError(f"{source} does not exist; allowed: an existing file or folder")
    check_plain(source)
    if max_voxels < 1:
        raise OptionError(f"max_voxels is {max_voxels}; allowed: 1 or more")
    if series is not None and not (source.is_dir() or is_archive(source) or is_dicom(source)):
        raise OptionError(
            f"series {series!r} was asked of {source}; allowed: with a DICOM folder, archive or "
            "file"
        )


def _read(
    source: Path, *, series: str | None, frame: int | None, max_voxels: int, progress: Progress
) -> RawScan:
    if source.is_dir():
        image = image_of(source, series, called=source, progress=progress)
        if image is not None:
            with looking_at(image, form_of(image)):
                return read_file(image, frame=frame, max_voxels=max_voxels, progress=progress)
        _refuse_frame(source, frame)
        return read_dicom_folder(source, series=series, max_voxels=max_voxels, progress=progress)
    if is_archive(source):
        with unpacked(source, progress) as folder:
            image = image_of(folder, series, called=source, progress=progress)
            if image is not None:
                return read_unpacked(
                    image,
                    folder,
                    called=source,
                    frame=frame,
                    max_voxels=max_voxels,
                    progress=progress,
                )
            _refuse_frame(source, frame)
            return read_dicom_folder(
                folder, series=series, max_voxels=max_voxels, progress=progress, called=source
            )
    if is_dicom(source):
        _refuse_frame(source, frame)
        return read_dicom_file(source, series=series, max_voxels=max_voxels, progress=progress)
    with looking_at(source, form_of(source)):
        return read_file(source, frame=frame, max_voxels=max_voxels, progress=progress)


def _refuse_frame(source: Path, frame: int | None) -> None:
    if frame is not None:
        raise OptionError(
            f"frame {frame} was asked of {source}; allowed: with an image file of several volumes; "
            "those of DICOM are series"
        )


def _is_pictures(source: Path, *, sized: bool) -> bool:
    """Says whether pictures are to be stacked: a single one is a scan only if said to be one."""
    return holds_pictures(source) if source.is_dir() else sized and is_picture(source)


def _read_bare(
    source: Path,
    layout: RawLayout | None,
    *,
    voxel: tuple[float, float, float] | None,
    max_voxels: int,
    progress: Progress,
) -> RawScan:
    """Reads what does not tell its own geometry."""
    if layout is None:
        return read_pictures(source, voxel=voxel, max_voxels=max_voxels, progress=progress)
    return read_raw(source, layout, voxel=voxel, max_voxels=max_voxels, progress=progress)
