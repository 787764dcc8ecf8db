"""Reading of medical volumes into patient space."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from palpate.base.counted import counted
from palpate.base.damaged_file import damage_as
from palpate.base.errors import OptionError, PalpateError, VolumeFormatError
from palpate.base.given import given_text, number, path_of, whole_number
from palpate.base.progress import Progress, silent
from palpate.base.reader_process import apart
from palpate.io.called import called_of
from palpate.io.deferred import scan_at, series_at
from palpate.io.raw_scan import RawScan, check_place
from palpate.volumes.orientation import direction_of, letters_of
from palpate.volumes.stored_values import Stored, to_stored
from palpate.volumes.volume import Source, Volume, VolumeTraits

if TYPE_CHECKING:
    from palpate.io.dicom.header import Series

__all__ = ["UNKNOWN_UNIT", "list_series", "read", "read_again", "read_sibling"]

Place = str | PathLike[str]

NONE = "none"
UNITS = ("HU", NONE)
"""Units that a user can state for a scan; none: the values are in no known one."""
UNKNOWN_UNIT = "the unit of the values is unknown; give `unit=HU` if it is HU"
NO_UNIT = "the unit of the values is unknown"
"""Of scans that are never in HU."""
"""Told of scans without one."""


def read(  # noqa: PLR0913  # one for each thing that can be chosen
    path: Place | Sequence[Place],
    *,
    series: str | None = None,
    frame: int | None = None,
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
            slices; a NIfTI, NRRD, MetaImage, MINC, FreeSurfer, Analyze, PAR/REC or AFNI file; a
            folder of pictures; raw voxels. Several paths are DICOM files, or folders of them, of
            one scan.
        series: Series to read where there are several: its UID, its description, or its number in
            the list of the error message; also the name of an image file in a folder or an archive.
        frame: Volume of an image file that holds several, such as times, counted from 1.
        orientation: Sides toward which the file's x, y and z run, such as "LPS", where the file
            does not state them or is wrong.
        unit: "HU" where the values are known to be HU; "none" where they are in no known unit, of
            which nothing is said then.
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
        SeriesChoiceError: There are several series or volumes, or not the requested one.
        OptionError: An option has a value that is not allowed.
    """
    places = _places(path)
    source = called_of(places)
    frame = None if frame is None else whole_number("frame", frame)
    max_voxels = whole_number("max_voxels", max_voxels)
    fill = None if fill is None else _filling(fill)
    for name, text in (("series", series), ("orientation", orientation), ("raw", raw)):
        if text is not None and not isinstance(text, str):
            raise OptionError(f"{name} {given_text(text)} given; allowed: text")
    if unit is not None and unit not in UNITS:
        raise OptionError(f"unit {unit!r} is not known; allowed: {', '.join(UNITS)}")
    scan = apart(
        scan_at,
        places,
        path=source,
        progress=progress,
        series=series,
        frame=frame,
        raw=raw,
        voxel_size=voxel_size,
        max_voxels=max_voxels,
    )
    check_place(str(source), scan)
    _apply_orientation(scan, orientation)
    if unit is not None:
        stated = "" if unit == NONE else unit
        if scan.unit not in ("", stated):
            scan.warnings.append(f"unit {unit} replaces the file's own, {scan.unit}")
        scan.unit = stated

    progress("storing values as 16 bits", None)
    stored = _stored(scan, source, fill=fill, strict=strict)
    if not scan.unit and unit is None:
        # MR and others have no unit that could be given
        is_ct = scan.modality in ("", "CT")
        (scan.warnings if is_ct else scan.notes).append(UNKNOWN_UNIT if is_ct else NO_UNIT)
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
            study=scan.subject[0],
            patient_id=scan.subject[1],
            patient_name=scan.subject[2],
            siblings=scan.siblings,
            orientation_known=scan.orientation_known,
            warnings=tuple(scan.warnings),
            notes=tuple(scan.notes),
        ),
    )
    # what other places of the file and of the program could not know
    options = {
        "series": series,
        "frame": frame,
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


def read_sibling(volume: Volume, number: int, *, progress: Progress = silent) -> Volume:
    """Reads another volume of the file or series of a scan, such as another time, as that was read.

    Args:
        volume: The scan.
        number: Of the volume among those of the file or series, from 1.
        progress: Takes the progress.

    Raises:
        OptionError: There is no such volume.
        PalpateError: As ``read``.
    """
    siblings = volume.traits.siblings
    if siblings is None:
        raise OptionError(f"{volume.name} is the only volume of its file; allowed: to open others")
    return read_again(volume, {siblings.option: siblings.key_of(number)}, progress=progress)


def read_again(
    volume: Volume, changes: Mapping[str, Any], *, progress: Progress = silent
) -> Volume:
    """Reads a scan again as it was read, but for some options of ``read``.

    Raises:
        OptionError: It was made, or read from several files.
        PalpateError: As ``read``.
    """
    if volume.source is None:
        raise OptionError(
            f"{volume.name} has no file of its own; allowed: a scan that was read from one file, "
            "folder or archive"
        )
    return read(volume.source.path, progress=progress, **{**volume.source.options, **changes})


def _filling(fill: float) -> float:
    """Returns a value to put in the place of none.

    Raises:
        OptionError: It is none either, or beyond what values are kept in.
    """
    value = float(number("fill", fill))
    largest = float(np.finfo(np.float32).max)
    if not abs(value) <= largest:
        raise OptionError(
            f"fill is {value:g}; allowed: a finite number between {-largest:.3g} and {largest:.3g}"
        )
    return value


def _stored(scan: RawScan, source: Path, *, fill: float | None, strict: bool) -> Stored:
    """Returns the values of a scan as they are used; refuses those that are none where asked to."""
    try:
        with damage_as(VolumeFormatError, "values that are no numbers", allowed="real numbers"):
            stored = to_stored(scan.values, fill=fill, file_scale=scan.file_scale)
    except PalpateError as error:
        raise type(error)(f"{source}: {error}") from None
    if strict and stored.missing:
        some = counted(stored.missing, "values is", "values are", of=stored.values.size)
        raise VolumeFormatError(
            f"{source}: {some} NaN or infinite; "
            "allowed: finite values, a value to put in their place (fill), or no value there "
            "(not strict)"
        )
    if stored.filled:
        some = counted(stored.filled, "NaN or infinite value was", "NaN or infinite values were")
        scan.warnings.append(f"{some} set to {fill:g}")
    if stored.off:
        scan.warnings.append(
            f"values of 64 bits are kept in 32 bits: they differ by up to {stored.off:.2g}"
        )
    return stored


def list_series(path: Place | Sequence[Place], *, progress: Progress = silent) -> list[Series]:
    """Lists the scans in a DICOM folder, a zip archive or several DICOM files, longest first.

    Raises:
        FileNotFoundError: ``path`` does not exist.
        VolumeFormatError: It is none of these, or has no scan.
    """
    places = _places(path)
    return apart(series_at, places, path=called_of(places), progress=progress)


def _places(path: Place | Sequence[Place]) -> list[Path]:
    if isinstance(path, Iterable) and not isinstance(path, str | bytes | PathLike):
        places = [path_of(one) for one in path]
    else:
        places = [path_of(path)]
    if not places:
        raise OptionError("no path given; allowed: one, or several DICOM files")
    return places


def _apply_orientation(scan: RawScan, orientation: str | None) -> None:
    """Lays the file's axes as told; warns where the file disagrees."""
    if orientation is None:
        return
    direction = direction_of(orientation)
    told = letters_of(scan.direction)
    if scan.orientation_known and not np.allclose(direction, scan.direction):
        scan.warnings.append(f"orientation {orientation.upper()} replaces the file's own, {told}")
    scan.direction, scan.orientation_known = direction, True
