"""Reading of single image files, each with the library that reads its format best.

Frame: LPS [mm]; see the modules of each library.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from palpate.base.errors import VolumeFormatError
from palpate.base.progress import Progress
from palpate.io.header_check import check_header
from palpate.io.open_image import OpenImage
from palpate.io.raw_scan import RawScan, check_shape, choose_frame
from palpate.volumes.siblings import Siblings

__all__ = [
    "FORMATS",
    "ImageHeader",
    "form_of",
    "header_of",
    "image_files",
    "is_beside",
    "middle_of",
    "read_file",
]

FORMATS = {
    "nifti": (".nii", ".nii.gz", ".hdr", ".img", ".img.gz", ".hdr.gz"),
    "metaimage": (".mha", ".mhd"),
    "nrrd": (".nrrd", ".nhdr"),
    "minc": (".mnc", ".mnc2"),
    "mgh": (".mgh", ".mgz", ".mgh.gz"),
    "parrec": (".par", ".rec"),
    "afni": (".head", ".brik", ".brik.gz"),
}
"""Each format's endings of files, small letters or capitals."""
NAMES = {
    "nifti": "NIfTI or Analyze",
    "metaimage": "MetaImage",
    "nrrd": "NRRD",
    "minc": "MINC",
    "mgh": "FreeSurfer",
    "parrec": "PAR/REC",
    "afni": "AFNI",
}
"""What people call them."""
HALVES = (".img", ".img.gz", ".rec", ".brik", ".brik.gz")
"""Endings of voxels beside a header, which stands for both."""
APPLE_DOUBLE = b"\x00\x05\x16\x07"
"""How the files begin that macOS lays beside others on foreign disks, as ``._name``."""

ALLOWED = (
    "NIfTI (.nii, .nii.gz), MetaImage (.mha, .mhd), NRRD (.nrrd, .nhdr), MINC (.mnc), FreeSurfer "
    "(.mgh, .mgz), Analyze (.hdr), PAR/REC (.par), AFNI (.HEAD), a DICOM folder or a zip archive "
    "of one, or pictures of slices with `voxel_size=X,Y,Z`"
)


def is_beside(name: str) -> bool:
    """Says whether a file is only what macOS lays beside another."""
    return name.startswith("._")


def image_files(folder: Path, *, among: int) -> list[Path]:
    """Lists the image files in a folder and those below, of so many files that are looked at."""
    endings = tuple(ending for some in FORMATS.values() for ending in some)
    files = islice(folder.rglob("*"), among)
    found = (path for path in files if path.name.lower().endswith(endings) and path.is_file())
    return sorted(
        path
        for path in found
        # the two files of a pair are one scan: its header stands for it
        if not path.name.lower().endswith(HALVES) and not is_beside(path.name)
    )


def form_of(path: Path) -> str:
    """Returns what people call the format of a file, by its name."""
    name = path.name.lower()
    return next((NAMES[key] for key, ends in FORMATS.items() if name.endswith(ends)), "an image")


def read_file(
    path: Path, *, frame: int | None = None, max_voxels: int, progress: Progress
) -> RawScan:
    """Reads one file that holds a volume, or the one asked for of several, counted from 1.

    Its axes may be sheared.

    Raises:
        SeriesChoiceError: It holds several volumes and none was chosen, or not so many.
        VolumeFormatError: The file is no volume, is damaged, or has too many voxels.
    """
    image = _checked(path, max_voxels)
    chosen = choose_frame(str(path), image.size, frame)
    scan = image.scan(chosen, progress)
    count = math.prod(image.size[3:])
    if count > 1:
        scan.siblings = Siblings("frame", tuple(range(1, count + 1)), chosen + 1)
    return scan


@dataclass(frozen=True)
class ImageHeader:
    """What is known of an image file before its voxels are read."""

    size: tuple[int, int, int]
    """Voxels along x, y, z."""
    spacing: tuple[float, float, float]
    """Along x, y, z [mm]."""
    kind: str
    """Of its numbers, such as "8-bit unsigned integer"."""
    frames: int
    """Volumes in it, such as times."""


def header_of(path: Path, *, max_voxels: int = 1024**3) -> ImageHeader:
    """Returns what a file's header tells.

    Raises:
        VolumeFormatError: The file is no volume, or has too many voxels.
    """
    image = _checked(path, max_voxels)
    x, y, z = image.size[:3]
    across, down, along = image.spacing[:3]
    return ImageHeader((x, y, z), (across, down, along), image.kind, math.prod(image.size[3:]))


def middle_of(path: Path, frame: int = 1) -> NDArray[Any]:
    """Returns the values of the middle slice of a volume along z, shape [y, x].

    Raises:
        VolumeFormatError: The file cannot be read, or has fewer than three axes.
    """
    image = _opened(path)
    if len(image.size) < 3:
        # refuses it
        check_shape(str(path), image.size, max_voxels=1 << 62)
    return image.middle(frame - 1)


def _checked(path: Path, max_voxels: int) -> OpenImage:
    """Opens a file, and refuses by its header what is no scan before voxels are loaded."""
    image = _opened(path)
    image.check()
    check_shape(str(path), image.size[:3], max_voxels)
    return image


def _opened(path: Path) -> OpenImage:
    """Opens a file with what reads its format."""
    from palpate.io import itk_image, neuro_image, nifti_file

    if not path.is_file():
        raise VolumeFormatError(f"{path} is no file; allowed: {ALLOWED}")
    with path.open("rb") as file:
        start = file.read(8)
    if not start:
        raise VolumeFormatError(f"{path} is empty; allowed: {ALLOWED}")
    if start.startswith(APPLE_DOUBLE):
        raise VolumeFormatError(
            f"{path} only holds what macOS keeps beside a file (AppleDouble); allowed: that file, "
            "whose name is without the ._"
        )
    check_header(path)
    name = path.name.lower()
    format_name = next((key for key, ends in FORMATS.items() if name.endswith(ends)), None)
    if format_name == "nifti":
        return nifti_file.open_nifti(path)
    if format_name == "mgh":
        return neuro_image.open_mgh(path)
    if format_name in ("parrec", "afni") or (format_name == "minc" and start.startswith(b"CDF")):
        return neuro_image.NeuroImage(path, format_name)
    if format_name is None:
        raise _unknown(path)
    return itk_image.ItkImage(path, format_name)


def _unknown(path: Path) -> VolumeFormatError:
    """Says what a file is that ITK knows and this module does not: it may be a picture."""
    from palpate.io.itk_image import ItkImage

    try:
        image = ItkImage(path, "")
    except VolumeFormatError:
        return VolumeFormatError(f"{path} is no image; allowed: {ALLOWED}")
    image.check()
    check_shape(str(path), image.size, max_voxels=1 << 62)
    return VolumeFormatError(f"{path} is an image of another format; allowed: {ALLOWED}")
