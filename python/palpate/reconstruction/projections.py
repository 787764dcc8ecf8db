"""Files of projections: stacks of line integrals, or of counts of a detector.

Layout: arrays are [angle, v, u].
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError, VolumeFormatError
from palpate.base.files_read import note_read
from palpate.base.progress import Progress, silent
from palpate.base.reader_process import apart, expect
from palpate.base.simpleitk import reason_of, simpleitk
from palpate.io.header_check import check_header
from palpate.io.image_file import FORMATS, image_files
from palpate.io.raw_voxels import in_order

__all__ = [
    "ProjectionStack",
    "are_projections",
    "integrals_of",
    "read_projections",
    "stack_at",
]

Values = NDArray[np.float32]

TIFFS = (".tif", ".tiff")
IMAGES = tuple(ending for endings in FORMATS.values() for ending in endings)
NAMED = re.compile(
    r"(?i)(?:^|[^a-z])(?:proj(?:ection)?s?|sino(?:gram)?s?|radiographs?)(?:[^a-z]|$)"
)
"""Words in names of files that contain projections."""
ENDING = re.compile(r"(?i)(\.nii|\.nrrd|\.nhdr|\.mha|\.mhd|\.tiff?)(\.gz)?$")
LEAST_IMAGES = 8
"""Least number of TIFFs that count as projections."""
MOST_LISTED = 1000
"""Most files of a folder that are examined."""

ALLOWED = "a stack as NRRD, NIfTI, MetaImage or TIFF, or a folder of TIFFs"


@dataclass(frozen=True)
class ProjectionStack:
    """Properties of a stack of images, known before its values are read."""

    path: Path
    """Path of the file, or of the folder of TIFFs."""
    name: str
    """Name of either, without extension."""
    shape: tuple[int, int, int]
    """[images, rows, columns]."""
    pixel: tuple[float, float]
    """Pixel size along columns and rows, as the files state it [mm]; 1 where they do not."""
    counts: bool
    """Whether values are non-negative integers, like counts of a detector."""
    bits: int
    """Bits of a value."""
    middle: tuple[float, float] | None = None
    """Place of an image's middle along columns and rows, as the files state it [mm]; None where
    they place the first pixel at 0, as files without a place do."""
    turned: bool = False
    """Whether the files state directions in which columns and rows are not those of the image."""

    @property
    def sinograms(self) -> bool:
        """Whether its name says that each image is one row of the detector at all angles."""
        return "sino" in self.path.name.lower()


def are_projections(path: Path) -> bool:
    """Returns whether a path is projections, by its name or that of its TIFFs."""
    tiffs = _tiffs(path)
    if tiffs:
        found = NAMED.search(path.name) or NAMED.search(tiffs[0].name)
        return found is not None and len(tiffs) >= LEAST_IMAGES
    named = _file(path)
    if named is None or NAMED.search(named.name) is None:
        return False
    if named.suffix.lower() in TIFFS:
        return apart(_stack_of, path, [named], path=path).shape[0] >= LEAST_IMAGES
    return named.name.lower().endswith(IMAGES)


def stack_at(path: Path) -> ProjectionStack:
    """Returns the properties of the projections at a path.

    Raises:
        FileNotFoundError: ``path`` does not exist.
        VolumeFormatError: It is not a stack of images.
    """
    files = _files(path)
    return apart(_stack_of, path, files, path=path)


def _stack_of(path: Path, files: list[Path]) -> ProjectionStack:
    reader = _opened(files)
    kind = simpleitk().GetPixelIDValueAsString(reader.GetPixelIDValue())
    u, v = (edge if 0.0 < edge < np.inf else 1.0 for edge in reader.GetSpacing()[:2])
    place = path if len(files) > 1 else files[0]
    origin, size = reader.GetOrigin()[:2], reader.GetSize()[:2]
    axes = np.reshape(reader.GetDirection(), (reader.GetDimension(), -1))[:2, :2]
    x, y = (
        first + 0.5 * (count - 1) * edge
        for first, count, edge in zip(origin, size, (u, v), strict=True)
    )
    return ProjectionStack(
        path=place,
        name=ENDING.sub("", place.name),
        shape=_shape_of(reader, len(files)),
        pixel=(u, v),
        counts="unsigned integer" in kind,
        bits=int(kind.partition("-bit")[0]),
        middle=(x, y) if any(origin) else None,
        turned=not np.allclose(axes, np.eye(2), atol=1e-6),
    )


def read_projections(path: Path, *, sinograms: bool = False, progress: Progress = silent) -> Values:
    """Reads an image with three axes, or a folder of TIFFs in the order of their names.

    Args:
        path: A file that ITK reads (NRRD, NIfTI, MetaImage, multi-page TIFF), or such a folder.
        sinograms: Whether each image is one row of the detector at all angles.
        progress: Takes the progress.

    Raises:
        FileNotFoundError: ``path`` does not exist.
        VolumeFormatError: It is not a stack of images.
    """
    files = _files(path)
    for file in files:
        note_read(file)
    array = apart(_values_of, path, files, path=path, progress=progress)
    stacked = array.transpose(1, 0, 2) if sinograms else array
    return np.ascontiguousarray(stacked, np.float32)


def _values_of(path: Path, files: list[Path], *, progress: Progress) -> NDArray[Any]:
    shape = _shape_of(_opened(files), len(files))
    expect(math.prod(shape))
    progress(f"reading {path.name}", None)
    given: Any = [str(file) for file in files] if len(files) > 1 else str(files[0])
    try:
        array: NDArray[Any] = simpleitk().GetArrayFromImage(simpleitk().ReadImage(given))
    except RuntimeError as error:
        raise _unreadable(path, error) from None
    return array


def integrals_of(counts: Values, unattenuated: float) -> Values:
    """Returns line integrals of attenuation from counts of a detector (Beer and Lambert).

    Raises:
        OptionError: The count without a patient is not positive.
    """
    if not 0.0 < unattenuated < np.inf:
        raise OptionError(f"intensities of {unattenuated:g} given; allowed: above 0")
    # a pixel that counted nothing is taken as one that counted a half
    least = min(0.5, 1e-6 * unattenuated)
    integrals: Values = np.log(unattenuated / np.maximum(counts, least)).astype(np.float32)
    return integrals


# --- files --------------------------------------------------------------------------------


def _files(path: Path) -> list[Path]:
    """Returns the files of a stack: several TIFFs, or one file."""
    if not path.exists():
        raise FileNotFoundError(f"{path} does not exist; allowed: an existing file or folder")
    files = _tiffs(path)
    if files:
        return files
    named = _file(path)
    if named is None:
        raise VolumeFormatError(f"{path} holds no projections; allowed: {ALLOWED}")
    return [named]


def _tiffs(path: Path) -> list[Path]:
    if not path.is_dir():
        return []
    return [file for file in in_order(path.iterdir()) if file.suffix.lower() in TIFFS]


def _file(path: Path) -> Path | None:
    """Returns the only image file of a folder, or the file itself."""
    if path.is_file():
        return path
    images = image_files(path, among=MOST_LISTED) if path.is_dir() else []
    return images[0] if len(images) == 1 else None


def _opened(files: list[Path]) -> Any:  # noqa: ANN401  # SimpleITK has no types
    """Returns a reader that has read the header of the first file."""
    check_header(files[0])
    reader = simpleitk().ImageFileReader()
    reader.SetFileName(str(files[0]))
    try:
        reader.ReadImageInformation()
    except RuntimeError as error:
        raise _unreadable(files[0], error) from None
    return reader


def _shape_of(reader: Any, files: int) -> tuple[int, int, int]:  # noqa: ANN401
    columns, rows, *others = reader.GetSize()
    pages = int(np.prod(others, dtype=np.int64))
    flat = len(others) == 0 or pages == 1
    if reader.GetNumberOfComponents() != 1 or (files > 1 and not flat) or len(others) > 1:
        raise VolumeFormatError(
            f"{reader.GetFileName()} holds an array of shape {list(reader.GetSize())[::-1]} with "
            f"{reader.GetNumberOfComponents()} numbers each; allowed: grey [angles, rows, columns]"
        )
    return (files if files > 1 else pages), rows, columns


def _unreadable(path: Path, error: RuntimeError) -> VolumeFormatError:
    return VolumeFormatError(f"{path} cannot be read ({reason_of(error)}); allowed: {ALLOWED}")
