"""Segments from files: label maps, segmentations of Slicer and DICOM, contours, mask folders."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from palpate.base.damaged_file import damage_as
from palpate.base.errors import OptionError, VolumeFormatError
from palpate.base.given import given_text, path_of
from palpate.base.plain_file import check_plain
from palpate.base.progress import Progress, silent
from palpate.base.reader_process import apart
from palpate.io.dicom.header import damage_told
from palpate.io.dicom.mark import is_dicom, read_dataset
from palpate.io.dicom.promises import check_deflated
from palpate.labels.contours import read_rtstruct
from palpate.labels.dicom_seg import read_seg
from palpate.labels.grid import Label, Labels
from palpate.labels.label_map import read_label_map, read_mask_folder
from palpate.labels.seg_nrrd import is_segmentation, read_seg_nrrd
from palpate.volumes.volume import Volume

__all__ = ["Label", "Labels", "modality_of", "read_any_labels", "read_labels"]


def read_labels(
    path: str | PathLike[str],
    volume: Volume,
    *,
    resample: bool = False,
    another_patient: bool = False,
    progress: Progress = silent,
) -> Labels:
    """Reads segments that belong to a scan, with names and colours where the file has them.

    Args:
        path: A label map, a ``.seg.nrrd``, a DICOM SEG or RTSTRUCT file, or a folder with one mask
            for each structure.
        volume: The scan. The segments must be on its grid, except for the extent and for axes in
            the opposite direction.
        resample: Whether segments may be on any grid: each voxel of the scan takes the label at its
            centre, and a warning says so.
        another_patient: Whether segments of DICOM may be of another patient, study or frame of
            reference than the scan: their coordinates are used as they are, and a warning says so.
        progress: Takes the progress.

    Returns:
        The segments, and sentences on what was changed or left out.

    Raises:
        FileNotFoundError: ``path`` does not exist.
        VolumeFormatError: It cannot be read.
        OptionError: It is on another grid than the scan, of another patient or study, or has no
            segment.
    """
    found = read_any_labels(
        path, volume, resample=resample, another_patient=another_patient, progress=progress
    )
    if not found.labels:
        why = "; ".join(found.warnings) or "no labels"
        raise OptionError(
            f"{path_of(path)} holds no segments ({why}); allowed: files with segments"
        )
    return found


def read_any_labels(
    path: str | PathLike[str],
    volume: Volume,
    *,
    resample: bool = False,
    another_patient: bool = False,
    progress: Progress = silent,
) -> Labels:
    """Reads segments as ``read_labels`` does; there may be none.

    Raises:
        FileNotFoundError: ``path`` does not exist.
        VolumeFormatError: It cannot be read.
        OptionError: It is on another grid than the scan, or of another patient or study.
    """
    source = path_of(path)
    if not source.exists():
        raise FileNotFoundError(f"{source} does not exist; allowed: an existing file or folder")
    check_plain(source)
    damaged, allowed = f"{source} is damaged", "complete, undamaged files of segments"
    with damage_as(VolumeFormatError, damaged, allowed=allowed):
        return _read(
            source, volume, resample=resample, another_patient=another_patient, progress=progress
        )


def _read(
    source: Path, volume: Volume, *, resample: bool, another_patient: bool, progress: Progress
) -> Labels:
    if source.is_dir():
        return read_mask_folder(source, volume, resample=resample, progress=progress)
    if is_dicom(source):
        modality = modality_of(source)
        reader = {"SEG": read_seg, "RTSTRUCT": read_rtstruct}.get(modality)
        if reader is not None:
            with damage_told(source):
                return reader(
                    source,
                    volume,
                    resample=resample,
                    another_patient=another_patient,
                    progress=progress,
                )
        # of a damaged file it may be the rest of the file
        told = given_text(modality) if modality else "unknown"
        raise OptionError(f"{source} is DICOM of modality {told}; allowed: SEG or RTSTRUCT")
    if is_segmentation(source):
        return read_seg_nrrd(source, volume, resample=resample, progress=progress)
    return read_label_map(source, volume, resample=resample, progress=progress)


def modality_of(path: Path) -> str:
    """Returns the modality of a DICOM file, such as "SEG"; "" where it has none."""
    return apart(_modality_of, path, path=path)


def _modality_of(path: Path) -> str:
    with damage_told(path):
        check_deflated(path)
        dataset = read_dataset(path, stop_before_pixels=True, specific_tags=["Modality"])
        return str(dataset.get("Modality") or "")
