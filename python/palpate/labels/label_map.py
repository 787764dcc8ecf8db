"""Label maps: images whose values say which structure a voxel belongs to.

Names and colours come from the table that TotalSegmentator and others write into NIfTI files
(``LabelTable`` of the CIFTI extension), or from a ``.csv`` beside the file with the columns
``id`` and ``structure``, and ``red``, ``green`` and ``blue`` where it has them.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError, SeriesChoiceError
from palpate.base.files_read import note_read
from palpate.base.progress import Progress, silent
from palpate.base.reader_process import apart
from palpate.io.image_file import is_beside
from palpate.io.packed_file import unpacked_file
from palpate.io.raw_scan import RawScan
from palpate.io.scan_at import stored_scan_at
from palpate.labels.grid import (
    Colour,
    Label,
    Labels,
    Placement,
    Resampling,
    patient_from_grid,
    placement,
    told_of,
)
from palpate.labels.label_values import label_codes, label_values
from palpate.labels.name_table import ENDINGS, NAMES, NUMBERS, tables_beside
from palpate.labels.segments_told import SegmentsTold
from palpate.volumes.anatomical_colour import colour_of_name
from palpate.volumes.label_like import MOST_LABELS
from palpate.volumes.volume import Volume

__all__ = ["ENDINGS", "read_label_map", "read_mask_folder"]

LARGEST_TABLE = 1 << 20
"""Of a NIfTI file [bytes]."""
COLOURS = ("red", "green", "blue")
"""Each 0..1."""


def read_label_map(
    path: Path, volume: Volume, *, resample: bool = False, progress: Progress
) -> Labels:
    """Reads an image of labels.

    Raises:
        VolumeFormatError: It cannot be read.
        OptionError: It lies on another grid than the scan, or holds no labels.
    """
    given = _image_of(path, progress)
    values = label_values(path, given.values, most=MOST_LABELS)
    coded = label_codes(given.values, values)
    laid, lost, said = _on_grid(path, given, coded, volume=volume, resample=resample)
    size, whole = (" x ".join(map(str, one.shape[::-1])) for one in (given.values, laid.array))
    if size != whole:
        said.insert(0, f"the map has {size} voxels, the scan {whole}")
    names = _names_of(path)
    there, held, outside = (
        np.bincount(codes.ravel(), minlength=len(values) + 1) for codes in (laid.array, coded, lost)
    )
    made = []
    told = SegmentsTold()
    for code, value in enumerate(values, 1):
        progress(f"making {len(values)} segments", code / len(values))
        number = str(value) if isinstance(value, int) else f"{value:g}"
        name, colour, original = names.get(value, (f"label {number}", None, None))
        told.add(name, voxels=int(held[code]), outside=int(outside[code]), there=bool(there[code]))
        if there[code]:
            part = laid.threshold(code, code).part_of(volume, name=name)
            if isinstance(value, int):
                part.number = value if original is None else original
            made.append(Label(part, colour or colour_of_name(name)))
    return Labels(tuple(made), (*told.sentences(), *said))


def read_mask_folder(
    folder: Path, volume: Volume, *, resample: bool = False, progress: Progress
) -> Labels:
    """Reads a folder with one mask for each structure, as TotalSegmentator writes it.

    Raises:
        VolumeFormatError: A mask cannot be read.
        OptionError: There is none, or one lies on another grid than the scan.
    """
    files = sorted(
        path
        for path in folder.iterdir()
        if path.name.lower().endswith(ENDINGS) and not is_beside(path.name)
    )
    if not files:
        raise OptionError(
            f"{folder} holds no masks; allowed: a folder with a NIfTI, NRRD or MetaImage file for "
            "each structure"
        )
    made, placed = [], set[str]()
    told = SegmentsTold()
    for done, path in enumerate(files):
        progress(f"reading {len(files)} masks", done / len(files))
        given = _image_of(path, silent)
        # anything above 0, whatever number a program writes
        mask = (given.values > 0).astype(np.int16)
        ending = next(ending for ending in ENDINGS if path.name.lower().endswith(ending))
        name = path.name[: -len(ending)]
        voxels = int(np.count_nonzero(mask))
        if not voxels:
            told.add(name, voxels=0, outside=0, there=False)
            continue
        laid, lost, said = _on_grid(path, given, mask, volume=volume, resample=resample)
        placed.update(said)
        there = bool(laid.array.any())
        told.add(name, voxels=voxels, outside=len(lost), there=there)
        if there:
            part = laid.threshold(1.0).part_of(volume, name=name)
            made.append(Label(part, colour_of_name(name)))
    return Labels(tuple(made), (*told.sentences(), *sorted(placed)))


def _image_of(path: Path, progress: Progress) -> RawScan:
    """Reads an image as it stands in its file, for labels are no values to be rounded."""
    try:
        return apart(stored_scan_at, path, path=path, progress=progress)
    except SeriesChoiceError:
        raise OptionError(f"{path} holds several volumes; allowed: one of labels") from None


def _on_grid(
    path: Path, given: RawScan, codes: NDArray[np.int16], *, volume: Volume, resample: bool
) -> tuple[Volume, NDArray[np.int16], list[str]]:
    """Returns codes on the grid of the scan, those outside of it, and what to say of the grids."""
    place = placement(
        f"label map {path}",
        patient_from_grid(given.spacing, given.origin, given.direction),
        codes.shape,
        volume=volume,
        resample=resample,
    )
    laid, lost = codes, codes[:0]
    if isinstance(place, Resampling) or not _is_same(place, codes.shape, volume.shape):
        laid = np.zeros(volume.shape, np.int16)
        lost = place.lay(codes, laid)
    on_grid = Volume(laid, spacing=volume.spacing, origin=volume.origin, direction=volume.direction)
    return on_grid, lost, told_of([place])


def _is_same(place: Placement, shape: Sequence[int], scan: Sequence[int]) -> bool:
    return place.order == (0, 1, 2) and not place.turned and tuple(shape) == tuple(scan)


# --- names --------------------------------------------------------------------------------

Names = dict[float, tuple[str, Colour | None, int | None]]
"""By the number of the label: name, colour, and the label's number before it was written here."""


def _names_of(path: Path) -> Names:
    if ".nii" in path.name.lower() and (names := _nifti_table(path)):
        return names
    for beside in tables_beside(path):
        if beside.is_file() and (names := _csv_table(beside)):
            return names
    return {}


def _nifti_table(path: Path) -> Names:
    """Reads the label table of a NIfTI file's extension, if it has one."""
    with unpacked_file(path) as file:
        # what precedes the voxels: a header of 348 bytes and its extensions
        text = file.read(LARGEST_TABLE).split(b"</LabelTable>")[0]
    entry = re.compile(rb"<Label ([^>]*)>\s*(?:<!\[CDATA\[(.*?)\]\]>|([^<]*))\s*</Label>")
    names: Names = {}
    for attributes, quoted, plain in entry.findall(text):
        told = dict(re.findall(rb'(\w+)="([^"]*)"', attributes))
        try:
            red, green, blue = (
                min(1.0, max(0.0, float(told[key]))) for key in (b"Red", b"Green", b"Blue")
            )
            number = int(told[b"Key"])
        except (KeyError, ValueError):
            continue
        name = (quoted or plain).decode("utf-8", "replace").strip()
        names[number] = (name or f"label {number}", (red, green, blue), None)
    return names


def _csv_table(path: Path) -> Names:
    note_read(path)
    with path.open(encoding="utf-8-sig", errors="replace", newline="") as file:
        try:
            rows = list(csv.DictReader(file))
        except csv.Error:
            return {}
    # a row with more cells than there are columns has some without a name
    columns = [str(name).strip().lower() for name in (rows[0] if rows else {})]
    number = next((column for column in NUMBERS if column in columns), None)
    named = next((column for column in NAMES if column in columns), None)
    names: Names = {}
    if number is None or named is None:
        return names
    for row in rows:
        told = {str(key).strip().lower(): str(value).strip() for key, value in row.items()}
        if told[number].isdecimal() and told[named]:
            before = told.get("original", "").removeprefix("-")
            original = int(told["original"]) if before.isdecimal() else None
            names[int(told[number])] = (told[named], _csv_colour(told), original)
    return names


def _csv_colour(told: dict[str, str]) -> Colour | None:
    try:
        red, green, blue = (min(1.0, max(0.0, float(told[part]))) for part in COLOURS)
    except (KeyError, ValueError):
        return None
    return red, green, blue
