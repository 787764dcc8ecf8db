"""What headers of NIfTI and Analyze files mean: size, numbers, scale and place.

Which of the two transforms holds: the sform where its code is above 0, else the qform, as nibabel,
FSL and AFNI have it. Sources: NIfTI-1 header (R. Cox et al. 2004), NIfTI-2 header (2011).

Frame: the file's transforms lead to RAS in its own unit; here they become LPS [mm].
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import VolumeFormatError
from palpate.base.nibabel import nibabel
from palpate.io.packed_file import unpacked_file
from palpate.io.stored_image import Place, StoredImage
from palpate.volumes.orientation import letters_of
from palpate.volumes.stored_values import Scale

__all__ = ["LPS_FROM_RAS", "checked", "open_nifti"]

LPS_FROM_RAS = np.diag([-1.0, -1.0, 1.0, 1.0])
LARGEST_HEADER = 540
MILLIMETRES = {1: 1000.0, 2: 1.0, 3: 0.001}
"""In units of length by their codes; others tell none."""
PATIENT = 10.0, 3000.0
"""How long scans of patients, their parts and animals are [mm]."""
VECTORS = {1004, 1005, 1006, 1007, 2003, 2004}
"""Intents whose fifth axis counts the numbers of one voxel: matrices, vectors, colours."""
SURFACES = range(3000, 3100)
"""Intents of CIFTI-2, whose voxels and vertices are listed."""
NEAR = 0.1
"""Transforms that differ by more are told of [mm]."""
MAGIC = {
    b"n+1\0": ("Nifti1Image", True), b"ni1\0": ("Nifti1Pair", False),
    b"n+2\0": ("Nifti2Image", True), b"ni2\0": ("Nifti2Pair", False),
}  # fmt: skip
"""What marks a header: its class in nibabel, and whether the voxels follow in the same file."""
ALLOWED = "headers of NIfTI-1, NIfTI-2 or Analyze 7.5, compressed by gzip or not"
ROUNDED = 1e-3
"""By how much rounding may make a quaternion longer than 1."""


def open_nifti(path: Path) -> StoredImage:
    """Reads the header of a NIfTI or Analyze file, or of the pair that it belongs to.

    Raises:
        VolumeFormatError: It is no such file, or tells a size, numbers or a place that cannot be.
    """
    named = _beside(path, ".hdr") if _ending(path) == ".img" else path
    with unpacked_file(named) as file:
        block = file.read(LARGEST_HEADER)
    header, single = _header(path, block)
    module = nibabel()
    try:
        number = _number(header)
        slope, intercept = header.get_slope_inter()
        start = _start(header)
    except (module.spatialimages.HeaderDataError, ValueError, OverflowError) as error:
        raise VolumeFormatError(
            f"{path} has a header that cannot be right ({error}); allowed: headers as NIfTI "
            "has them"
        ) from None
    intent = int(header["intent_code"]) if "intent_code" in header else 0
    if intent in SURFACES:
        raise VolumeFormatError(
            f"{path} holds values on surfaces and connections (CIFTI-2); allowed: volumes"
        )
    size = _size(path, header["dim"])
    return StoredImage(
        path=path,
        voxels=named if single else _beside(named, ".img"),
        size=size,
        number=number,
        # behind the header and the four bytes that tell of extensions
        start=max(start, len(bytes(header.binaryblock)) + 4) if single else start,
        scale=_scale(slope, intercept),
        place=_with_unit(_place(path, header, size, told=_scale_told(header)), header, size),
        vectors=intent in VECTORS and len(size) > 4 and size[4] > 1,
    )


def checked(path: Path, affine: NDArray[np.float64], what: str = "its header") -> None:
    """Refuses a place in space that no grid has.

    Raises:
        VolumeFormatError: Numbers are not finite, or voxels have no length or none that can be.
    """
    lengths = np.linalg.norm(affine[:3, :3], axis=0)
    # a tenth of a micrometre to ten metres; an origin within a kilometre
    fits = np.isfinite(affine).all() and bool(np.all((lengths > 1e-7) & (lengths < 1e4)))
    flat = fits and abs(np.linalg.det(affine[:3, :3] / lengths)) < 1e-3
    if not fits or flat or np.abs(affine[:3, 3]).max() > 1e6:
        shown = " x ".join(f"{length:.4g}" for length in lengths)
        raise VolumeFormatError(
            f"{path} has voxels of {shown} mm by {what}, or axes that span no volume; allowed: "
            "headers with the size and the place of voxels"
        )


def _header(path: Path, block: bytes) -> tuple[Any, bool]:
    """Returns a header of nibabel, as it stands in the file, and whether voxels follow in it."""
    module = nibabel()
    magic = next((one for one in (block[344:348], block[4:8]) if one in MAGIC), b"")
    is_analyze = (348).to_bytes(4, "little") == block[:4] or (348).to_bytes(4, "big") == block[:4]
    name, single = MAGIC.get(magic, ("Spm2AnalyzeImage", False))
    kind = getattr(module, name).header_class
    length = kind.template_dtype.itemsize
    if (not magic and not is_analyze) or len(block) < length:
        raise VolumeFormatError(f"{path} is no readable NIfTI file; allowed: {ALLOWED}")
    return kind(block[:length], check=False), single


def _size(path: Path, dim: NDArray[Any]) -> tuple[int, ...]:
    axes = int(dim[0])
    size = [int(length) for length in dim[1 : 1 + axes]] if 1 <= axes <= 7 else []
    # axes beyond the third are often left at 0
    size = size[:3] + [max(1, length) for length in size[3:]]
    if not size or min(size) < 1:
        shown = " ".join(str(int(length)) for length in dim)
        raise VolumeFormatError(
            f"{path} has the sizes (dim) {shown}; allowed: the number of axes, 1 to 7, and 1 or "
            "more voxels along each"
        )
    return tuple(size)


def _number(header: Any) -> np.dtype[Any]:  # noqa: ANN401  # nibabel's
    """Returns the type of the numbers; colours have fields.

    Raises:
        ValueError: There is no such type, or it is none of numbers.
    """
    code = int(header["datatype"])
    number: np.dtype[Any]
    try:
        number = np.dtype(header.get_data_dtype())
    except LookupError:
        raise ValueError(f"numbers of datatype {code}") from None
    if number.kind == "V" and number.names is None:
        raise ValueError(f"numbers of datatype {code}")
    return number


def _start(header: Any) -> int:  # noqa: ANN401  # nibabel's
    """Returns the byte at which voxels begin.

    Raises:
        ValueError: It is before the file or beyond any.
    """
    offset = float(header["vox_offset"])
    if not 0.0 <= offset < 1e15:
        raise ValueError(f"voxels from byte {offset:g} on")
    return int(offset)


def _scale(slope: float | None, intercept: float | None) -> Scale | None:
    if slope is None or (slope, intercept or 0.0) == (1.0, 0.0):
        return None
    return Scale(float(slope), float(intercept or 0.0))


def _scale_told(header: Any) -> tuple[str, ...]:  # noqa: ANN401  # nibabel's
    """Says so where a slope is no number; nibabel takes values as they stand, as for 0."""
    slope = float(header["scl_slope"]) if "scl_slope" in header else 0.0
    return (f"the slope of the values is {slope:g}: they are as stored",) if np.isinf(slope) else ()


def _ending(path: Path) -> str:
    return path.name.lower().removesuffix(".gz")[-4:]


def _beside(path: Path, ending: str) -> Path:
    """Returns the other file of a pair, whatever the case of its ending."""
    stem = path.name[: -len(".gz")] if path.name.lower().endswith(".gz") else path.name
    wanted = (stem[:-4].lower() + ending, stem[:-4].lower() + ending + ".gz")
    found = [one for one in path.parent.iterdir() if one.name.lower() in wanted]
    same = [one for one in found if one.name.startswith(stem[:-4])]
    return next(iter(sorted(same or found)), path.with_name(stem[:-4] + ending))


# --- place --------------------------------------------------------------------------------


def _place(
    path: Path,
    header: Any,  # noqa: ANN401  # nibabel's
    size: tuple[int, ...],
    *,
    told: tuple[str, ...],
) -> Place:
    """Returns where the grid lies: by the sform, else the qform, else unknown."""
    pixels = np.abs(np.float64(header["pixdim"][1:4]))
    if "sform_code" not in header:
        return _unplaced(path, pixels, told)
    units = int(header["xyzt_units"]) & 7
    scale = np.diag([*[MILLIMETRES.get(units, 1.0)] * 3, 1.0])
    forms: list[tuple[str, NDArray[np.float64]]] = []
    broken: list[str] = []
    for form, matrix_of in (("sform", _sform), ("qform", _qform)):
        code = int(header[f"{form}_code"])
        if code <= 0:
            continue
        name = f"{form} (code {code})"
        try:
            # numbers that are none are looked for in what comes out
            with np.errstate(all="ignore"):
                affine = scale @ LPS_FROM_RAS @ matrix_of(path, header)
            checked(path, affine, f"its {name}")
            forms.append((name, affine))
        except VolumeFormatError as error:
            broken.append(str(error))
    if broken and not forms:
        raise VolumeFormatError(broken[0])
    if not forms:
        return _unplaced(path, pixels * scale[0, 0], told)
    told += tuple(f"{forms[0][0]} is used, since {one}" for one in broken)
    return Place(affine=forms[0][1], told=told + _disagreement(forms, size))


def _with_unit(
    place: Place,
    header: Any,  # noqa: ANN401  # nibabel's
    size: tuple[int, ...],
) -> Place:
    """Says that lengths are assumed to be in mm where the file tells no unit of NIfTI's.

    That is common, and no warning where the scan has the size of a patient in mm: in metres or
    micrometres, which are the others, it would be none.
    """
    if "xyzt_units" not in header or int(header["xyzt_units"]) & 7 in MILLIMETRES:
        return place
    longest = max(step * length for step, length in zip(place.spacing, size, strict=False))
    said = "the file tells no unit of length: mm are assumed"
    if PATIENT[0] <= longest <= PATIENT[1]:
        return replace(place, notes=(*place.notes, said))
    return replace(place, told=(*place.told, f"{said}, so the scan is {longest:.3g} mm long"))


def _unplaced(path: Path, pixels: NDArray[np.float64], told: tuple[str, ...]) -> Place:
    affine = np.diag([*pixels, 1.0])
    checked(path, affine)
    return Place(affine=affine, known=False, told=told)


def _sform(_: Path, header: Any) -> NDArray[np.float64]:  # noqa: ANN401  # nibabel's
    affine: NDArray[np.float64] = header.get_sform()
    return affine


def _qform(path: Path, header: Any) -> NDArray[np.float64]:  # noqa: ANN401  # nibabel's
    parts = ("quatern_b", "quatern_c", "quatern_d")
    length = float(np.linalg.norm([np.float64(header[part]) for part in parts]))
    if not length <= 1.0 + ROUNDED:
        raise VolumeFormatError(
            f"{path} has a qform whose quaternion has the length {length:.4g}; allowed: 1 or less"
        )
    if length > 1.0:
        for part in parts:
            header[part] /= length
    # as the format has it: any other number than -1 means 1
    header["pixdim"][0] = -1.0 if header["pixdim"][0] < 0.0 else 1.0
    header["pixdim"][1:4] = np.abs(header["pixdim"][1:4])
    affine: NDArray[np.float64] = header.get_qform()
    return affine


def _disagreement(
    forms: list[tuple[str, NDArray[np.float64]]], size: tuple[int, ...]
) -> tuple[str, ...]:
    """Says by how much two transforms differ at the corners of the grid, where there are two."""
    if len(forms) < 2:
        return ()
    (first, sform), (second, qform) = forms
    lengths = (*size[:3], 1, 1)[:3]
    ends = np.array(np.meshgrid(*([-0.5, length - 0.5] for length in lengths))).reshape(3, -1)
    apart = (sform - qform)[:3, :3] @ ends + (sform - qform)[:3, 3:]
    off = float(np.linalg.norm(apart, axis=0).max())
    if off <= NEAR:
        return ()
    flipped = np.linalg.det(sform[:3, :3]) * np.linalg.det(qform[:3, :3]) < 0.0
    both = dict.fromkeys((_letters(sform), _letters(qform)))
    sides = " and ".join(both) if len(both) > 1 else f"{next(iter(both))} in both"
    swapped = "; one mirrors the other, so left and right may be swapped" if flipped else ""
    told = f"{first} and {second} of the file disagree by up to {off:.3g} mm, axes toward {sides}"
    return (f"{told}{swapped}: the sform is used",)


def _letters(affine: NDArray[np.float64]) -> str:
    lengths = np.linalg.norm(affine[:3, :3], axis=0)
    return letters_of(affine[:3, :3] / np.where(lengths > 0.0, lengths, 1.0))
