"""Segments from files: label maps, segmentations of Slicer and DICOM, contours, mask folders."""

from __future__ import annotations

from typing import TYPE_CHECKING

from palpate.base.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from palpate.labels.labels import Label, Labels, modality_of, read_labels

__all__ = ["Label", "Labels", "modality_of", "read_labels"]

__getattr__ = lazy_exports(
    __name__,
    {
        "Label": "labels",
        "Labels": "labels",
        "modality_of": "labels",
        "read_labels": "labels",
    },
)
