"""Directories of media (DICOMDIR): which files of a set they list.

Source: DICOM PS3.3, F.3 (basic directory), PS3.10, 8.2 (file IDs).
"""

from __future__ import annotations

from pathlib import Path

from palpate.io.dicom.header import damage_told
from palpate.io.dicom.mark import read_dataset

__all__ = ["is_dicomdir", "listed_files"]

DIRECTORY = "1.2.840.10008.1.3.10"
"""Media Storage Directory."""


def is_dicomdir(path: Path) -> bool:
    """Says whether a DICOM file lists others.

    Raises:
        VolumeFormatError: It is damaged.
    """
    with damage_told(path):
        dataset = read_dataset(path, stop_before_pixels=True, specific_tags=["SOPClassUID"])
        return str(dataset.file_meta.get("MediaStorageSOPClassUID") or "") == DIRECTORY


def listed_files(path: Path) -> tuple[list[Path], list[Path]]:
    """Returns the files of a set that are there below its folder, and those that are not.

    Raises:
        VolumeFormatError: The directory is damaged.
    """
    with damage_told(path):
        told = [
            record.ReferencedFileID
            for record in read_dataset(path).get("DirectoryRecordSequence") or []
            if record.get("ReferencedFileID")
        ]
    wanted = [[one] if isinstance(one, str) else [str(part) for part in one] for one in told]
    placed = [(parts, _below(path.parent, parts)) for parts in wanted]
    found = [file for _, file in placed if file is not None]
    missing = [path.parent / "/".join(parts).lstrip("/") for parts, file in placed if file is None]
    return found, missing


def _below(folder: Path, parts: list[str]) -> Path | None:
    """Returns a file below a folder; None where it is missing, or lies elsewhere."""
    root = folder.resolve()
    # discs are often mounted with small letters
    for names in (parts, [part.lower() for part in parts]):
        file = folder.joinpath(*names)
        try:
            if file.is_file() and file.resolve().is_relative_to(root):
                return file
        except (OSError, ValueError):
            continue
    return None
