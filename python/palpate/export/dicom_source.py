"""The DICOM files that a scan was read from, for objects that refer to them.

Frame: LPS [mm].
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from palpate.base.errors import OptionError
from palpate.base.progress import Progress
from palpate.io.archive import is_archive, unpacked
from palpate.io.dicom.header import Header, Series, damage_told, frame_of
from palpate.io.dicom.mark import read_dataset
from palpate.io.dicom.reading import volumes_of
from palpate.io.dicom.series import choose_series, is_dicom, series_in
from palpate.io.dicom.usable import usable
from palpate.volumes.volume import Volume

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

__all__ = ["DicomSource", "SourceSlice", "dicom_source", "why_no_dicom"]

SAME_PLACE = 0.02
"""By how much of a voxel a slice of a file may lie off one of the scan."""
ELSEWHERE = "allowed: .seg.nrrd, NIfTI or NRRD, which need no DICOM files"

NEEDED = (
    "PatientID", "PatientName", "PatientBirthDate", "PatientSex", "AccessionNumber", "StudyID",
    "StudyDate", "StudyTime", "ReferringPhysicianName",
)  # fmt: skip
"""What every object has, if empty (type 2)."""
IMAGE_CLASSES = {
    "CT": "1.2.840.10008.5.1.4.1.1.2",
    "MR": "1.2.840.10008.5.1.4.1.1.4",
}
"""Kinds of objects with single slices."""
SECONDARY = "1.2.840.10008.5.1.4.1.1.7"
"""What other images may be: secondary capture."""
IDENTIFIERS = ("StudyInstanceUID", "SeriesInstanceUID", "FrameOfReferenceUID")


@dataclass(frozen=True)
class SourceSlice:
    """The image that shows a slice of the scan."""

    image: Dataset
    frame: int | None
    """Its number, from 1, where the file has several."""


@dataclass(frozen=True)
class DicomSource:
    """Files of a scan."""

    files: tuple[Path, ...]
    """There for as long as the source is open."""
    images: tuple[Dataset, ...]
    """Their headers, in the same order."""
    slices: tuple[SourceSlice | None, ...]
    """For each slice of the scan, what shows it; None where it was made up from others."""

    @property
    def first(self) -> Dataset:
        """One header, for what all of them say."""
        return self.images[0]


def why_no_dicom(volume: Volume) -> str | None:
    """Returns why nothing in DICOM can refer to a scan, as far as is known without its headers.

    None where something may.
    """
    source = volume.source
    if source is None or not source.path.exists():
        gone = "comes from no file" if source is None else f"is not at {source.path} any more"
        return f"the scan {volume.name!r} {gone}"
    if "orientation" in source.options:
        return (
            "the scan was read with an orientation that its files do not tell, so nothing in "
            "DICOM can refer to it"
        )
    path = source.path
    if is_archive(path) or path.is_dir() or is_dicom(path):
        return None
    return f"the scan {volume.name!r} is no DICOM series"


@contextmanager
def dicom_source(volume: Volume, *, complete: bool, progress: Progress) -> Iterator[DicomSource]:
    """Opens the DICOM files of a scan.

    Args:
        volume: A scan that was read.
        complete: Whether identifiers that the files lack are made up, the same for all of them.
        progress: Told how far the reading is.

    Raises:
        OptionError: The scan comes from no DICOM files, they are not there any more, or nothing
            can refer to them.
    """
    source, obstacle = volume.source, why_no_dicom(volume)
    if source is None or obstacle is not None:
        raise OptionError(f"{obstacle}; {ELSEWHERE}")
    path, series = source.path, source.options.get("series")
    if is_archive(path):
        with unpacked(path, progress) as folder:
            chosen, _ = choose_series(folder, series_in(folder, progress=progress)[0], series)
            yield _source(volume, _used(path, chosen), complete=complete)
    elif path.is_dir():
        chosen, _ = choose_series(path, series_in(path, progress=progress)[0], series)
        yield _source(volume, _used(path, chosen), complete=complete)
    else:
        chosen, _ = choose_series(path, volumes_of(path), series)
        yield _source(volume, _used(path, chosen), complete=complete)


def _used(path: Path, chosen: Series) -> tuple[Header, ...]:
    """Returns the files of a series whose slices are the scan's."""
    return usable(str(path), chosen)[0].headers


def _source(volume: Volume, headers: tuple[Header, ...], *, complete: bool) -> DicomSource:
    files = tuple(sorted(header.path for header in headers))
    images = tuple(_read(path) for path in files)
    _complete(images, volume, complete=complete)
    taken = {header.path: header.taken for header in headers}
    return DicomSource(files, images, _slices(volume, images, tuple(taken[path] for path in files)))


def _read(path: Path) -> Dataset:
    with damage_told(path):
        return read_dataset(path, stop_before_pixels=True)


def _complete(images: tuple[Dataset, ...], volume: Volume, *, complete: bool) -> None:
    from pydicom.uid import generate_uid

    made = {name: generate_uid() for name in IDENTIFIERS}
    lacking = _lacking(images)
    if lacking and not complete:
        raise OptionError(
            f"the scan's files have no {' and no '.join(lacking)}, so nothing can refer to them; "
            f"{ELSEWHERE}, or DICOM without `keep_identity=True`, which makes new ones"
        )
    with warnings.catch_warnings():
        # sloppy values are kept as they are
        warnings.simplefilter("ignore")
        for image in images:
            for name in IDENTIFIERS:
                if name in lacking:
                    setattr(image, name, made[name])
            if "SOPInstanceUID of their own" in lacking:
                image.SOPInstanceUID = generate_uid()
            if "SOPClassUID" in lacking:
                image.SOPClassUID = IMAGE_CLASSES.get(str(image.get("Modality")), SECONDARY)
            for name in NEEDED:
                if name not in image:
                    setattr(image, name, "")
            if not image.get("SliceThickness"):
                image.SliceThickness = f"{volume.spacing[2]:.6g}"


def _lacking(images: tuple[Dataset, ...]) -> list[str]:
    """Lists identifiers that files lack, or share though they have to have one of their own."""
    names = (*IDENTIFIERS, "SOPClassUID")
    lacking = [name for name in names if not all(image.get(name) for image in images)]
    own = {image.get("SOPInstanceUID") for image in images} - {None, ""}
    return lacking if len(own) == len(images) else [*lacking, "SOPInstanceUID of their own"]


def _slices(
    volume: Volume, images: tuple[Dataset, ...], taken: tuple[tuple[int, ...] | None, ...]
) -> tuple[SourceSlice | None, ...]:
    """Finds the image at the place of each slice, among the frames that are the scan's."""
    grid_from_patient = np.linalg.inv(volume.patient_from_grid)
    slices: list[SourceSlice | None] = [None] * volume.shape[0]
    for image, own in zip(images, taken, strict=True):
        count = int(image.get("NumberOfFrames") or 1)
        for index in range(count) if own is None else own:
            position = frame_of(image, index).position
            if position is None:
                continue
            place = grid_from_patient[:3, :3] @ position + grid_from_patient[:3, 3] - 0.5
            number = round(float(place[2]))
            off = float(np.abs(place - (0.0, 0.0, number)).max())
            if 0 <= number < len(slices) and off <= SAME_PLACE:
                slices[number] = SourceSlice(image, index + 1 if count > 1 else None)
    return tuple(slices)
