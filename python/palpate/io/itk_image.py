"""MetaImage, NRRD and MINC 2 by SimpleITK.

Frame: SimpleITK turns what each format says into LPS [mm], but for the unit of length, which it
passes over.
"""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import VolumeFormatError
from palpate.base.progress import Progress
from palpate.base.simpleitk import Image, Reader, reason_of, simpleitk
from palpate.io.nifti_file import checked
from palpate.io.payload import check_payload, metaimage_header, nrrd_header
from palpate.io.raw_scan import RawScan, refuse_components
from palpate.io.stored_image import Place
from palpate.volumes.orientation import direction_of, letters_of

__all__ = ["ItkImage", "unit_of"]

IMAGE_IO = {"": "", "metaimage": "MetaImageIO", "nrrd": "NrrdImageIO", "minc": "MINCImageIO"}
"""Each format's reader in ITK; "" lets it look for one."""
MILLIMETRES = {
    "mm": 1.0, "millimeter": 1.0, "millimeters": 1.0, "millimetre": 1.0, "millimetres": 1.0,
    "um": 1e-3, "\u00b5m": 1e-3, "\u03bcm": 1e-3, "micron": 1e-3, "microns": 1e-3,
    "micrometer": 1e-3, "micrometers": 1e-3, "micrometre": 1e-3, "micrometres": 1e-3,
    "nm": 1e-6, "nanometer": 1e-6, "nanometers": 1e-6,
    "cm": 10.0, "centimeter": 10.0, "centimeters": 10.0, "centimetre": 10.0,
    "m": 1e3, "meter": 1e3, "meters": 1e3, "metre": 1e3, "metres": 1e3,
    "in": 25.4, "inch": 25.4, "inches": 25.4,
}  # fmt: skip
"""In units of length by the names that NRRD and MetaImage files have for them."""
ALLOWED = "complete, undamaged image files, or a DICOM folder"
SPACE_AXES = 3
VOLUMES = ("list", "point")
"""Kinds of NRRD axes whose samples are volumes; those of others make one voxel together."""


class ItkImage:
    """An image file by its header; see ``palpate.io.open_image.OpenImage``."""

    def __init__(self, path: Path, format_name: str) -> None:
        """Reads the header.

        Raises:
            VolumeFormatError: It is none.
        """
        self.path = path
        self.format_name = format_name
        self.reader: Reader = _opened(path, format_name)
        components = self.reader.GetNumberOfComponents()
        self.kind: str = simpleitk().GetPixelIDValueAsString(self.reader.GetPixelIDValue())
        self.kind = self.kind.removeprefix("vector of ")
        # samples of an axis beside those of space
        self.listed = components > 1 and _is_list(path, format_name, self.reader)
        self.size = (*self.reader.GetSize(), *([components] if self.listed else []))
        self.scale, told = unit_of(path, format_name)
        self.told = (*told, *_assumed(path, format_name))
        across, down, *along = (length * self.scale for length in self.reader.GetSpacing())
        self.spacing = (across, down, *along[:1])

    def check(self) -> None:
        """Refuses numbers that are no intensities."""
        components = self.reader.GetNumberOfComponents()
        if "complex" in self.kind:
            refuse_components(self.path, 2, "complex numbers")
        if components != 1 and not self.listed:
            refuse_components(self.path, components, f"{self.kind}, as colour images have")

    def scan(self, frame: int, progress: Progress) -> RawScan:
        """Reads one of its volumes, counted from 0."""
        # taken by ITK without a word where they are incomplete
        if self.format_name != "minc":
            progress(f"checking {self.path.name}", None)
            check_payload(self.path, self.format_name)
        volume = math.prod(self.size[:3]) * 2 / 2**20
        progress(f"reading {self.path.name}, {volume:.0f} MiB", None)
        image = self._image(frame, slice(0, self.size[2]))
        affine = np.eye(4)
        affine[:3, :3] = np.reshape(image.GetDirection(), (3, 3)) * image.GetSpacing() * self.scale
        affine[:3, 3] = np.multiply(image.GetOrigin(), self.scale)
        checked(self.path, affine)
        known = _orientation_known(self.path, self.format_name)
        told = self.told
        letters = "" if self.format_name != "metaimage" else anatomical_sides(self.path)
        if letters and not known:
            affine[:3, :3] = direction_of(letters) * self.spacing[:3]
            known = True
            told = (*told, f"axes lie toward {letters}, as AnatomicalOrientation tells alone")
        elif letters and letters != (lie := letters_of(affine[:3, :3])):
            unused = f"AnatomicalOrientation, which tells {letters}, is not used"
            told = (*told, f"axes lie toward {lie}, as TransformMatrix tells: {unused}")
        place = Place(affine=affine, known=known, told=told)
        return place.scan(self._array(image, frame), self.path)

    def middle(self, frame: int) -> NDArray[Any]:
        """Returns the values of a volume's middle slice along z, shape [y, x]."""
        middle = self.size[2] // 2
        image = self._image(frame, slice(middle, middle + 1))
        values: NDArray[Any] = self._array(image, frame).reshape(self.size[1::-1])
        return values

    def _image(self, frame: int, depth: slice) -> Image:
        """Reads some slices of a volume."""
        size = list(self.reader.GetSize())
        beyond = np.unravel_index(0 if self.listed else frame, size[3:], order="F")
        self.reader.SetExtractIndex([0, 0, depth.start, *(int(one) for one in beyond)])
        length = depth.stop - depth.start
        self.reader.SetExtractSize([*size[:2], length] + [0] * (len(size) - 3))
        try:
            return self.reader.Execute()
        except RuntimeError as error:
            raise VolumeFormatError(
                f"{self.path} cannot be read: {reason_of(error)}; "
                "allowed: complete, undamaged files"
            ) from None

    def _array(self, image: Image, frame: int) -> NDArray[Any]:
        values: NDArray[Any] = simpleitk().GetArrayFromImage(image)
        return np.ascontiguousarray(values[..., frame]) if self.listed else values


def _opened(path: Path, format_name: str) -> Reader:
    reader = simpleitk().ImageFileReader()
    reader.SetFileName(str(path))
    reader.SetImageIO(IMAGE_IO[format_name])
    try:
        reader.ReadImageInformation()
    except RuntimeError as error:
        what = f"no readable {format_name} file ({reason_of(error)})" if format_name else "no image"
        raise VolumeFormatError(f"{path} is {what}; allowed: {ALLOWED}") from None
    opened: Reader = reader
    return opened


def _is_list(path: Path, format_name: str, reader: Reader) -> bool:
    """Says whether what ITK takes for numbers of one voxel are volumes, such as times."""
    if format_name == "minc" and "dimension_order" in reader.GetMetaDataKeys():
        order = reader.GetMetaData("dimension_order")
        return "T" in order and "V" not in order
    if format_name != "nrrd":
        return False
    fields, _ = nrrd_header(path)
    kinds = [kind for kind in fields.get("kinds", "").lower().split() if kind not in SPACE]
    return len(kinds) == 1 and kinds[0] in VOLUMES


SPACE = ("domain", "space")
"""Kinds of NRRD axes along which voxels lie."""


def unit_of(path: Path, format_name: str) -> tuple[float, tuple[str, ...]]:
    """Returns how many millimetres a file's unit of length is, and what to tell of it."""
    units: list[str] = []
    if format_name == "nrrd":
        fields, _ = nrrd_header(path)
        told = fields.get("space units", "")
        units = re.findall(r'"([^"]*)"', told) or told.split()
        if not units:
            # of each axis, where there is no space: those of others are no lengths
            each = re.findall(r'"([^"]*)"', fields.get("units", ""))
            units = [unit for unit in each if unit.strip().lower() in MILLIMETRES]
    if format_name == "metaimage":
        units = [metaimage_header(path)[0].get("DistanceUnits", "")]
    named = sorted({unit.strip() for unit in units if unit.strip() not in ("", "?", "none", "???")})
    if len(named) > 1:
        raise VolumeFormatError(
            f"{path} has axes in different units, {', '.join(named)}; allowed: one for all"
        )
    if not named:
        return 1.0, ()
    scale = MILLIMETRES.get(named[0].lower())
    if scale is None:
        return 1.0, (f"the unit of length {named[0][:40]!r} is unknown: mm are assumed",)
    return scale, ()


def _assumed(path: Path, format_name: str) -> tuple[str, ...]:
    """Says what ITK takes without a word, since the file does not tell it.

    Raises:
        VolumeFormatError: A spacing is no number.
    """
    told = []
    if format_name == "nrrd":
        fields, _ = nrrd_header(path)
        spacings = fields.get("spacings", "").lower().split()
        axes = sum(spacing not in ("nan", "-nan") for spacing in spacings)
        if "space directions" not in fields:
            if spacings and axes < SPACE_AXES:
                raise VolumeFormatError(
                    f"{path} has spacings of {' '.join(spacings)}; allowed: numbers along three "
                    "axes"
                )
            told += [] if spacings else ["the file tells no size of voxels: 1 mm is assumed"]
    if format_name == "metaimage":
        fields, _ = metaimage_header(path)
        if not {"ElementSpacing", "ElementSize"} & fields.keys():
            told.append("the file tells no size of voxels: 1 mm is assumed")
        scale = (
            fields.get("ElementToIntensityFunctionSlope", "1"),
            fields.get("ElementToIntensityFunctionOffset", "0"),
        )
        if [float(part) for part in scale] != [1.0, 0.0]:
            told.append(
                f"slope {scale[0]} and offset {scale[1]} (ElementToIntensityFunction) are not "
                "applied, as in ITK: values are as stored"
            )
    return tuple(told)


def _orientation_known(path: Path, format_name: str) -> bool:
    """Says whether a file tells how its axes lie in the patient."""
    if format_name == "minc":
        return True
    if format_name == "nrrd":
        return nrrd_header(path)[0].get("space", "").lower() in SPACES
    fields, _ = metaimage_header(path)
    return bool({"TransformMatrix", "Orientation", "Rotation"} & fields.keys())


FROM = "RLAPIS"
"""Sides by their letters, each beside its opposite."""


def anatomical_sides(path: Path) -> str:
    """Returns the sides toward which axes of a MetaImage run, such as "LPS"; "" if it tells none.

    MetaIO names the sides that they come from.
    """
    told = metaimage_header(path)[0].get("AnatomicalOrientation", "").strip().upper()
    if len(told) != SPACE_AXES or {FROM.find(side) // 2 for side in told} != {0, 1, 2}:
        return ""
    return "".join(FROM[FROM.index(side) ^ 1] for side in told)


SPACES = (
    "left-posterior-superior", "right-anterior-superior", "left-anterior-superior",
    "lps", "ras", "las",
)  # fmt: skip
