"""Reading of single image files: NIfTI, MetaImage, NRRD and MINC.

Frame: SimpleITK turns what each format says into LPS [mm]; nothing else here turns axes.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import VolumeFormatError
from palpate.base.progress import Progress
from palpate.base.simpleitk import Image, Reader, reason_of, simpleitk
from palpate.io.header_check import check_header
from palpate.io.payload import check_payload, metaimage_header, nifti_not_finite
from palpate.io.raw_scan import RawScan, check_shape, orthonormal
from palpate.volumes.stored_values import Scale

__all__ = [
    "FORMATS",
    "ImageHeader",
    "check_own_voxels",
    "header_of",
    "image_files",
    "middle_of",
    "read_file",
]

FORMATS = {
    "nifti": ("NiftiImageIO", (".nii", ".nii.gz", ".hdr", ".img", ".img.gz", ".hdr.gz")),
    "metaimage": ("MetaImageIO", (".mha", ".mhd")),
    "nrrd": ("NrrdImageIO", (".nrrd", ".nhdr")),
    "minc": ("MINCImageIO", (".mnc", ".mnc2")),
}
"""Each format's reader in ITK and the endings of its files."""

DATA_FILE = ("elementdatafile", "data file", "datafile")
"""Fields of MetaImage and NRRD that name the file of the voxels."""
MOST_HEADER = 1 << 16
"""Of a header that is looked through [bytes]."""

ALLOWED = (
    "NIfTI (.nii, .nii.gz), MetaImage (.mha, .mhd), NRRD (.nrrd, .nhdr), MINC (.mnc), a DICOM "
    "folder or a zip archive of one, or pictures of slices with --voxel-size"
)


def image_files(folder: Path, *, among: int) -> list[Path]:
    """Lists the image files in a folder and those below, of so many files that are looked at."""
    endings = tuple(ending for _, some in FORMATS.values() for ending in some)
    files = islice(folder.rglob("*"), among)
    found = (path for path in files if path.name.lower().endswith(endings) and path.is_file())
    # the two files of a pair are one scan: its header stands for it
    halves = (".img", ".img.gz")
    return sorted(path for path in found if not path.name.lower().endswith(halves))


def check_own_voxels(path: Path) -> None:
    """Refuses a header that names voxels elsewhere than in itself or in one file beside it.

    Raises:
        VolumeFormatError: It does, as no header of an archive should.
    """
    if not path.name.lower().endswith((".mha", ".mhd", ".nrrd", ".nhdr")):
        return
    with path.open("rb") as file:
        head = file.read(MOST_HEADER).decode("latin-1")
    for line in head.splitlines():
        key, _, name = (part.strip() for part in line.replace("=", ":", 1).partition(":"))
        if key.lower() not in DATA_FILE:
            continue
        if not re.fullmatch(r"[^/\\%:]+", name) or name.split(" ")[0].lower() == "list":
            raise VolumeFormatError(
                f"{path} names voxels in {name[:100]!r}; allowed: in the same file, or in one "
                "beside it"
            )


def read_file(path: Path, *, max_voxels: int, progress: Progress) -> RawScan:
    """Reads one file that holds one volume.

    Raises:
        VolumeFormatError: The file is no volume, is damaged, or has too many voxels.
    """
    reader, format_name = _open(path)
    metadata = {key: reader.GetMetaData(key) for key in reader.GetMetaDataKeys()}

    # all that the header tells, before voxels are loaded
    _check_pixels(path, reader)
    check_shape(str(path), reader.GetSize(), max_voxels)
    # others than MINC are taken by ITK without a word where they are incomplete
    if format_name != "minc":
        progress(f"checking {path.name}", None)
        check_payload(path, metadata, format_name)

    progress(f"reading {path.name}, {math.prod(reader.GetSize()) * 2 / 2**20:.0f} MiB", None)
    image = _read(path, reader)
    values = simpleitk().GetArrayFromImage(image)
    if format_name == "nifti":
        not_finite = nifti_not_finite(path, metadata)
        if not_finite.any():
            # which of the two it was makes no difference further on
            values[not_finite.reshape(values.shape)] = np.nan
    known = _orientation_known(path, metadata, format_name)
    return RawScan(
        values=values,
        spacing=image.GetSpacing(),
        origin=image.GetOrigin(),
        direction=orthonormal(str(path), np.reshape(image.GetDirection(), (3, 3))),
        name=_stem(path),
        orientation_known=known,
        file_scale=_file_scale(metadata),
        warnings=[],
    )


@dataclass(frozen=True)
class ImageHeader:
    """What is known of an image file before its voxels are read."""

    size: tuple[int, int, int]
    """Voxels along x, y, z."""
    spacing: tuple[float, float, float]
    """[mm]."""
    kind: str
    """Of its numbers, as ITK calls it, such as "8-bit unsigned integer"."""


def header_of(path: Path, *, max_voxels: int = 1024**3) -> ImageHeader:
    """Returns what a file's header tells.

    Raises:
        VolumeFormatError: The file is no volume, or has too many voxels.
    """
    reader, _ = _open(path)
    _check_pixels(path, reader)
    check_shape(str(path), reader.GetSize(), max_voxels)
    x, y, z = reader.GetSize()[:3]
    across, down, along = reader.GetSpacing()[:3]
    kind = simpleitk().GetPixelIDValueAsString(reader.GetPixelIDValue())
    return ImageHeader((x, y, z), (across, down, along), kind)


def middle_of(path: Path) -> NDArray[Any]:
    """Returns the values of the middle slice along z, shape [y, x].

    Raises:
        VolumeFormatError: The file cannot be read.
    """
    reader, _ = _open(path)
    size = list(reader.GetSize())
    reader.SetExtractIndex([0, 0, size[2] // 2] + [0] * (len(size) - 3))
    reader.SetExtractSize([size[0], size[1], 1] + [0] * (len(size) - 3))
    values: NDArray[Any] = simpleitk().GetArrayFromImage(_executed(path, reader))[0]
    return values


def _open(path: Path) -> tuple[Reader, str]:
    """Returns a reader that has read the header, and the name of the format."""
    name = path.name.lower()
    endings = ((key, io) for key, (io, ends) in FORMATS.items() if name.endswith(ends))
    format_name, image_io = next(endings, ("", ""))
    if path.is_file() and path.stat().st_size == 0:
        raise VolumeFormatError(f"{path} is empty; allowed: {ALLOWED}")
    check_header(path)
    reader = simpleitk().ImageFileReader()
    reader.SetFileName(str(path))
    reader.SetImageIO(image_io)
    try:
        reader.ReadImageInformation()
    except RuntimeError as error:
        if "orthonormal" in str(error):
            raise VolumeFormatError(
                f"{path} has sheared axes; allowed: perpendicular axes, so resample it first"
            ) from None
        what = f"no readable {format_name} file ({reason_of(error)})" if format_name else "no image"
        raise VolumeFormatError(f"{path} is {what}; allowed: {ALLOWED}") from None
    if not format_name:
        # something that ITK knows: say what, for it may be a picture of a scan
        _check_pixels(path, reader)
        check_shape(str(path), reader.GetSize(), max_voxels=1 << 62)
        raise VolumeFormatError(f"{path} is an image of another format; allowed: {ALLOWED}")
    return reader, format_name


def _check_pixels(path: Path, reader: Reader) -> None:
    components = reader.GetNumberOfComponents()
    kind = simpleitk().GetPixelIDValueAsString(reader.GetPixelIDValue())
    if components != 1 or "complex" in kind or "vector" in kind:
        raise VolumeFormatError(
            f"{path} has {components} numbers per voxel ({kind}), as colour images have; "
            "allowed: one intensity per voxel"
        )


def _read(path: Path, reader: Reader) -> Image:
    # axes beyond the third have one voxel: they are dropped
    size = list(reader.GetSize())
    reader.SetExtractSize(size[:3] + [0] * (len(size) - 3))
    return _executed(path, reader)


def _executed(path: Path, reader: Reader) -> Image:
    try:
        return reader.Execute()
    except RuntimeError as error:
        raise VolumeFormatError(
            f"{path} cannot be read: {reason_of(error)}; "
            "allowed: complete, undamaged files without shear"
        ) from None


def _orientation_known(path: Path, metadata: Mapping[str, str], format_name: str) -> bool:
    """Says whether a file tells how its axes lie in the patient."""
    if format_name == "nifti":
        return any(int(metadata.get(f"{form}_code", "0")) > 0 for form in ("qform", "sform"))
    if format_name == "nrrd":
        return metadata.get("NRRD_space", "") in (
            "left-posterior-superior",
            "right-anterior-superior",
            "left-anterior-superior",
        )
    if format_name == "minc":
        return True
    fields, _ = metaimage_header(path)
    return bool({"TransformMatrix", "Orientation", "Rotation"} & fields.keys())


def _file_scale(metadata: Mapping[str, str]) -> Scale | None:
    slope = float(metadata.get("scl_slope", "0"))
    intercept = float(metadata.get("scl_inter", "0"))
    return Scale(slope, intercept) if np.isfinite(slope) and slope != 0.0 else None


def _stem(path: Path) -> str:
    return path.name.removesuffix(".gz").rpartition(".")[0] or path.name
