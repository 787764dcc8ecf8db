"""Whether files hold segments and no scan: by what they say of themselves, else by their values."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from palpate.base.errors import PalpateError
from palpate.base.progress import Progress, silent
from palpate.base.reader_process import apart
from palpate.io.dicom.series import is_dicom
from palpate.io.image_file import header_of, is_beside, middle_of, read_file
from palpate.labels.label_map import ENDINGS
from palpate.labels.labels import modality_of
from palpate.labels.seg_nrrd import is_segmentation
from palpate.volumes.label_like import is_named_so, may_be_labels

__all__ = ["LabelsTold", "labels_in", "labels_told"]

DICOM = {"SEG": "a DICOM segmentation", "RTSTRUCT": "structures of radiotherapy (RTSTRUCT)"}
BESIDE = (".csv", ".json", ".txt", ".raw", ".zraw")
"""Endings of what may lie beside masks: tables, and voxels of their own."""
MOST_VOXELS = 1024**3


@dataclass(frozen=True)
class LabelsTold:
    """What a file or folder is that holds segments."""

    name: str
    what: str
    """Such as "a label map"."""
    image: bool
    """Whether it could be opened as a scan too."""


def labels_in(place: Path) -> Path:
    """Returns what of a drop holds labels: the only image where there is one, beside its table."""
    if not place.is_dir():
        return place
    images = [path for path in place.iterdir() if _is_image(path)]
    return images[0] if len(images) == 1 else place


def labels_told(path: Path, *, progress: Progress = silent) -> LabelsTold | None:
    """Returns what segments there are at a path; None where there is something else, or nothing."""
    try:
        return apart(_told, path, path=path, progress=progress)
    except PalpateError:
        # whoever reads it as a scan says what is wrong with it
        return None


def _told(path: Path, *, progress: Progress) -> LabelsTold | None:
    place = labels_in(path)
    if place != path and any(_is_other(file) for file in path.iterdir() if file != place):
        # a scan may be there too
        return None
    try:
        if place.is_dir():
            return _masks(place, progress)
        return _file(place, progress) if place.is_file() else None
    except (PalpateError, RuntimeError):
        # whoever reads it as a scan says what is wrong with it
        return None


def _file(path: Path, progress: Progress) -> LabelsTold | None:
    if is_dicom(path):
        kind = DICOM.get(modality_of(path))
        return None if kind is None else LabelsTold(path.name, kind, image=False)
    if not path.name.lower().endswith(ENDINGS):
        return None
    if is_segmentation(path):
        return LabelsTold(path.name, "a segmentation of 3D Slicer", image=True)
    progress(f"looking at {path.name}", None)
    return LabelsTold(path.name, "a label map", image=True) if _is_map(path, progress) else None


def _masks(folder: Path, progress: Progress) -> LabelsTold | None:
    """Returns what a folder with a mask for each structure is."""
    files = sorted(folder.iterdir())
    masks = [path for path in files if _is_image(path)]
    if len(masks) < 2 or any(_is_other(path) for path in files if path not in masks):
        return None
    first = header_of(masks[0])
    if not first.kind.startswith("8-bit"):
        return None
    for done, path in enumerate(masks):
        progress(f"looking at {len(masks)} files", done / len(masks))
        if header_of(path) != first:
            return None
    if not may_be_labels(middle_of(masks[0]), named=False):
        return None
    return LabelsTold(folder.name, f"a folder of {len(masks)} masks", image=False)


def _is_image(path: Path) -> bool:
    return path.name.lower().endswith(ENDINGS) and not is_beside(path.name)


def _is_other(path: Path) -> bool:
    return not path.name.startswith(".") and path.suffix.lower() not in BESIDE


def _is_map(path: Path, progress: Progress) -> bool:
    values = middle_of(path)
    if not values.any():
        # what there is may lie anywhere
        values = read_file(path, max_voxels=MOST_VOXELS, progress=progress).values
    return bool(values.any()) and may_be_labels(values, named=is_named_so(path.name))
