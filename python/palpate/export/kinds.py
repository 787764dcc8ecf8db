"""Kinds of files that other programs read, and the names that stand for them."""

from __future__ import annotations

from pathlib import Path
from typing import Literal, get_args

from palpate.base.errors import OptionError
from palpate.base.file_suffixes import IMAGE_SUFFIXES
from palpate.base.nearest import perhaps

__all__ = ["FROM_DICOM", "KINDS", "Kind", "check_export", "kind_of"]

Kind = Literal["seg-nrrd", "labels", "scan", "dicom-seg", "dicom-labelmap", "rtstruct", "dicom"]
"""What to write: segments for 3D Slicer; a label map; the scan with its edits; one DICOM object; or
a folder of DICOM with all of these."""
KINDS: tuple[Kind, ...] = get_args(Kind)

ENDINGS: dict[Kind, tuple[str, ...]] = {
    "seg-nrrd": (".seg.nrrd",),
    "labels": IMAGE_SUFFIXES,
    "scan": IMAGE_SUFFIXES,
    "dicom-seg": (".dcm",),
    "dicom-labelmap": (".dcm",),
    "rtstruct": (".dcm",),
    "dicom": ("",),
}
"""File name extensions of each kind."""


FROM_DICOM: tuple[Kind, ...] = ("dicom-seg", "dicom-labelmap", "rtstruct", "dicom")
"""What refers to the DICOM files of the scan."""


def kind_of(path: Path, *, has_segments: bool) -> Kind:
    """Returns the kind for a name; for an image, labels where there are segments, else the scan.

    Raises:
        OptionError: The extension is not known.
    """
    name = path.name.lower()
    if name.endswith(".seg.nrrd"):
        return "seg-nrrd"
    if name.endswith(IMAGE_SUFFIXES):
        return "labels" if has_segments else "scan"
    if name.endswith(".dcm"):
        return "dicom-seg"
    if "." in name:
        endings = ", ".join((".seg.nrrd", *IMAGE_SUFFIXES, ".dcm"))
        raise OptionError(
            f"{path.name!r} given; allowed: a name with {endings}, or a new folder for DICOM"
        )
    return "dicom"


def check_export(path: Path, kind: Kind, *, keep_identity: bool) -> None:
    """Refuses what could not be written, before anything is computed.

    Raises:
        OptionError: The name does not fit, its folder does not exist, or a DICOM object would refer
            to nothing.
    """
    if kind not in KINDS:
        raise OptionError(f"kind {kind!r} given{perhaps(kind, KINDS)}; allowed: {', '.join(KINDS)}")
    if not path.name.lower().endswith(ENDINGS[kind]):
        endings = ", ".join(ENDINGS[kind])
        raise OptionError(f"{path.name!r} given for {kind}; allowed: a name with {endings}")
    if not path.absolute().parent.is_dir():
        raise OptionError(f"folder {str(path.parent)!r} given; allowed: one that exists")
    if ENDINGS[kind] == (".dcm",) and not keep_identity:
        raise OptionError(
            f"{path.name!r} would refer to a scan that names the patient; allowed: with "
            "`keep_identity=True` for an archive that has the scan, or a new folder (a name "
            "without an ending), into which the scan goes along, all de-identified"
        )
