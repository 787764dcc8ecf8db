"""Reading of medical volumes into patient space."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from pathlib import Path

import numpy as np

from palpate.base.errors import OptionError, PalpateError, VolumeFormatError
from palpate.base.progress import Progress, silent
from palpate.io.archive import is_archive, unpacked
from palpate.io.dicom.header import Series
from palpate.io.dicom.reading import read_dicom_file, read_dicom_files, read_dicom_folder
from palpate.io.dicom.series import called_of, is_dicom, series_among, series_in
from palpate.io.image_file import read_file
from palpate.io.packed_images import image_of, read_unpacked
from palpate.io.raw_scan import RawScan
from palpate.io.raw_voxels import RawLayout, holds_pictures, is_picture, read_pictures, read_raw
from palpate.volumes.orientation import direction_of, letters_of
from palpate.volumes.stored_values import to_stored
from palpate.volumes.volume import Source, Volume, VolumeTraits

__all__ = ["list_series", "read"]

Place = str | PathLike[str]

UNITS = ("HU",)
"""Units that a user can state for a scan."""


def read(
    path: Place | Sequence[Place],
    *,
    series: str | None = None,
    orientation: str | None = None,
    unit: str | None = None,
    fill: float | None = None,
    strict: bool = False,
    raw: str | None = None,
    voxel_size: tuple[float, float, float] | None = None,
    max_voxels: int = 1024**3,
    progress: Progress = silent,
) -> Volume:
    """Reads one volume and places it in patient space, LPS [mm].

    Args:
        path: A folder with a DICOM series, a zip archive of one, or a DICOM file with all its
            slices; a NIfTI, NRRD, MetaImage or MINC file; a folder of pictures; raw voxels. Several
            paths are DICOM files, or folders of them, of one scan.
        series: Series to read where there are several: its UID, its description, or its number in
            the list of the error message; also the name of an image file in a folder or an archive.
        orientation: Sides toward which the file's x, y and z run, such as "LPS", where the file
            does not state them or is wrong.
        unit: "HU" where the values are known to be HU.
        fill: Replacement for NaN and infinite values; without it such voxels have no value: they
            are transparent, cannot be touched, and are left out of thresholds and statistics.
        strict: Whether a scan with NaN or infinite values is refused instead, if there is no
            ``fill``.
        raw: Layout of raw voxels, as SIZE,TYPE[,ORDER[,SKIP]], such as "256x256x113,int16,big"; for
            a folder, each file holds slices.
        voxel_size: Voxel size along x, y, z [mm], for raw voxels and pictures that do not state it.
        max_voxels: Largest number of voxels to accept, which guards against running out of memory.
        progress: Takes the progress.

    Returns:
        The volume; its ``warnings`` say what was assumed or lost.

    Raises:
        FileNotFoundError: ``path`` does not exist.
        VolumeFormatError: It is not a complete, three-dimensional scan with one value per voxel.
        SeriesChoiceError: There are several series, or not the requested one.
        OptionError: An option has a value that is not allowed.
    """
    places = _places(path)
    source = called_of(places)
    _check_options(source, series=series, unit=unit, max_voxels=max_voxels)
    if len(places) > 1:
        _refuse_bare(raw, voxel_size)
        scan = read_dicom_files(places, series=series, max_voxels=max_voxels, progress=progress)
    elif raw is not None or _is_pictures(source, sized=voxel_size is not None):
        layout = None if raw is None else RawLayout.of(raw)
        scan = _read_bare(
            source, layout, voxel=voxel_size, max_voxels=max_voxels, progress=progress
        )
    elif voxel_size is not None:
        raise OptionError(
            f"voxel size given for {source}; allowed: for raw voxels and pictures, others tell it"
        )
    else:
        scan = _read(source, series=series, max_voxels=max_voxels, progress=progress)
    _apply_orientation(scan, orientation)
    if unit is not None:
        scan.unit = unit

    progress("storing values as 16 bits", None)
    try:
        stored = to_stored(scan.values, fill=fill, file_scale=scan.file_scale)
    except PalpateError as error:
        raise type(error)(f"{source}: {error}") from None
    if strict and stored.missing:
        raise VolumeFormatError(
            f"{source}: {stored.missing} of {stored.values.size} values are NaN or infinite; "
            "allowed: finite values, a value to put in their place (fill), or no value there "
            "(not strict)"
        )
    if stored.filled:
        scan.warnings.append(f"{stored.filled} NaN or infinite values were set to {fill:g}")
    if not scan.unit:
        scan.warnings.append("the unit of the values is unknown; give --unit HU if it is HU")
    volume = Volume(
        stored.values,
        spacing=scan.spacing,
        origin=scan.origin,
        direction=scan.direction,
        slope=stored.scale.slope,
        intercept=stored.scale.intercept,
        exact=stored.exact,
        traits=VolumeTraits(
            name=scan.name,
            description=scan.description,
            modality=scan.modality,
            unit=scan.unit,
            series=scan.series,
            frame=scan.frame,
            orientation_known=scan.orientation_known,
            warnings=tuple(scan.warnings),
        ),
    )
    # what other places of the file and of the program could not know
    options = {
        "series": series,
        "orientation": orientation,
        "unit": unit,
        "fill": fill,
        "strict": strict or None,
        "raw": raw,
        "voxel_size": voxel_size,
    }
    given = {name: option for name, option in options.items() if option is not None}
    # several files have no place of their own to be read from again
    volume.source = Source(source.resolve(), given) if len(places) == 1 else None
    return volume


def list_series(path: Place | Sequence[Place], *, progress: Progress = silent) -> list[Series]:
    """Lists the scans in a DICOM folder, a zip archive or several DICOM files, longest first.

    Raises:
        FileNotFoundError: ``path`` does not exist.
        VolumeFormatError: It is none of these, or has no scan.
    """
    places = _places(path)
    if len(places) > 1:
        return series_among(places, progress=progress)[0]
    source = places[0]
    if not source.exists():
        raise FileNotFoundError(f"{source} does not exist; allowed: an existing file or folder")
    if is_archive(source):
        with unpacked(source, progress) as folder:
            return series_in(folder, called=source, progress=progress)[0]
    if not source.is_dir():
        raise VolumeFormatError(f"{source} is one file; allowed: a DICOM folder or zip archive")
    return series_in(source, progress=progress)[0]


def _places(path: Place | Sequence[Place]) -> list[Path]:
    places = [Path(path)] if isinstance(path, str | PathLike) else [Path(one) for one in path]
    if not places:
        raise OptionError("no path given; allowed: one, or several DICOM files")
    return places


def _refuse_bare(raw: str | None, voxel: tuple[float, float, float] | None) -> None:
    if raw is not None or voxel is not None:
        raise OptionError(
            "a layout or voxel size given for several files; allowed: for one file or folder"
        )


def _check_options(source: Path, *, series: str | None, unit: str | None, max_voxels: int) -> None:
    if not source.exists():
        raise FileNotFoundError(f"{source} does not exist; allowed: an existing file or folder")
    if unit is not None and unit not in UNITS:
        raise OptionError(f"unit {unit!r} is not known; allowed: {', '.join(UNITS)}")
    if max_voxels < 1:
        raise OptionError(f"max_voxels is {max_voxels}; allowed: 1 or more")
    if series is not None and not (source.is_dir() or is_archive(source) or is_dicom(source)):
        raise OptionError(
            f"series {series!r} was asked of {source}; allowed: with a DICOM folder, archive or "
            "file"
        )


def _read(source: Path, *, series: str | None, max_voxels: int, progress: Progress) -> RawScan:
    if source.is_dir():
        image = image_of(source, series, called=source, progress=progress)
        if image is not None:
            return read_file(image, max_voxels=max_voxels, progress=progress)
        return read_dicom_folder(source, series=series, max_voxels=max_voxels, progress=progress)
    if is_archive(source):
        with unpacked(source, progress) as folder:
            image = image_of(folder, series, called=source, progress=progress)
            if image is not None:
                return read_unpacked(
                    image, folder, called=source, max_voxels=max_voxels, progress=progress
                )
            return read_dicom_folder(
                folder, series=series, max_voxels=max_voxels, progress=progress, called=source
            )
    if is_dicom(source):
        return read_dicom_file(source, series=series, max_voxels=max_voxels, progress=progress)
    return read_file(source, max_voxels=max_voxels, progress=progress)


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


def _apply_orientation(scan: RawScan, orientation: str | None) -> None:
    """Lays the file's axes as told; warns where the file disagrees."""
    if orientation is None:
        return
    direction = direction_of(orientation)
    told = letters_of(scan.direction)
    if scan.orientation_known and not np.allclose(direction, scan.direction):
        scan.warnings.append(f"orientation {orientation.upper()} replaces the file's own, {told}")
    scan.direction, scan.orientation_known = direction, True
