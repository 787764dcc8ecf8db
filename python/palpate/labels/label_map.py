"""Label maps: images whose values say which structure a voxel belongs to.

Names and colours come from the table that TotalSegmentator and others write into NIfTI files
(``LabelTable`` of the CIFTI extension), or from a ``.csv`` beside the file with the columns
``id`` and ``structure``, and ``red``, ``green`` and ``blue`` where it has them.
"""

from __future__ import annotations

import csv
import gzip
import re
from collections.abc import Sequence
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.base.progress import Progress
from palpate.io.reading import read
from palpate.labels.grid import (
    RESAMPLED,
    Colour,
    Label,
    Labels,
    Placement,
    Resampling,
    placement,
)
from palpate.volumes.anatomical_colour import colour_of_name
from palpate.volumes.volume import Volume

__all__ = ["ENDINGS", "read_label_map", "read_mask_folder"]

MOST_LABELS = 255
"""More values than this are intensities, not labels."""
LARGEST_TABLE = 1 << 20
"""Of a NIfTI file [bytes]."""
NAMES = ("structure", "name", "label", "segment")
NUMBERS = ("id", "value", "index", "number")
COLOURS = ("red", "green", "blue")
"""Each 0..1."""
ENDINGS = (".nii.gz", ".nii", ".nrrd", ".mha", ".mhd", ".mnc")


def read_label_map(
    path: Path, volume: Volume, *, resample: bool = False, progress: Progress
) -> Labels:
    """Reads an image of labels.

    Raises:
        VolumeFormatError: It cannot be read.
        OptionError: It lies on another grid than the scan, or holds no labels.
    """
    given = read(path, progress=progress)
    labels, resampled = _on_grid(path, given, volume, resample=resample)
    size, whole = (" x ".join(map(str, one.dimensions)) for one in (given, volume))
    said = () if size == whole else (f"the map has {size} voxels, the scan {whole}",)
    if resampled:
        said = (*said, RESAMPLED)
    counts = _stored_counts(labels)
    values = {stored: labels.value_of(stored) for stored in counts if labels.value_of(stored)}
    if len(values) > MOST_LABELS:
        raise OptionError(
            f"{path} holds {len(values)} different values, as scans do; allowed: label maps of at "
            f"most {MOST_LABELS} labels"
        )
    names = _names_of(path)
    made = []
    for done, value in enumerate(values.values()):
        progress(f"making {len(values)} segments", done / len(values))
        name, colour = names.get(round(value), (f"label {value:g}", None))
        part = labels.threshold(value, value).part_of(volume, name=name)
        made.append(Label(part, colour or colour_of_name(name)))
    return Labels(tuple(made), said)


def read_mask_folder(
    folder: Path, volume: Volume, *, resample: bool = False, progress: Progress
) -> Labels:
    """Reads a folder with one mask for each structure, as TotalSegmentator writes it.

    Raises:
        VolumeFormatError: A mask cannot be read.
        OptionError: There is none, or one lies on another grid than the scan.
    """
    files = sorted(path for path in folder.iterdir() if path.name.lower().endswith(ENDINGS))
    if not files:
        raise OptionError(
            f"{folder} holds no masks; allowed: a folder with a NIfTI, NRRD or MetaImage file for "
            "each structure"
        )
    made, empty, resampled = [], 0, False
    for done, path in enumerate(files):
        progress(f"reading {len(files)} masks", done / len(files))
        mask, other_grid = _on_grid(path, read(path), volume, resample=resample)
        resampled = resampled or other_grid
        if mask.range[1] <= 0.0:
            empty += 1
            continue
        ending = next(ending for ending in ENDINGS if path.name.lower().endswith(ending))
        name = path.name[: -len(ending)]
        # anything above 0, whatever number a program writes
        part = mask.threshold(max(mask.slope / 2.0, 1e-9)).part_of(volume, name=name)
        made.append(Label(part, colour_of_name(name)))
    said = [f"{empty} masks are empty"] if empty else []
    said += [RESAMPLED] if resampled else []
    return Labels(tuple(made), tuple(said))


def _on_grid(path: Path, labels: Volume, volume: Volume, *, resample: bool) -> tuple[Volume, bool]:
    """Returns labels on the grid of the scan, as they are where that is theirs.

    Also says whether they were resampled.
    """
    place = placement(
        f"label map {path}",
        labels.patient_from_grid,
        labels.shape,
        volume=volume,
        resample=resample,
    )
    resampled = isinstance(place, Resampling)
    if not isinstance(place, Resampling) and _is_same(place, labels.shape, volume.shape):
        return labels, resampled
    nothing = round(-labels.intercept / labels.slope)
    stored = np.zeros(volume.shape, np.int16)
    place.lay((labels.array - np.int16(nothing)).astype(np.int16), stored)
    laid = Volume(
        stored,
        spacing=volume.spacing,
        origin=volume.origin,
        direction=volume.direction,
        slope=labels.slope,
    )
    return laid, resampled


def _is_same(place: Placement, shape: Sequence[int], scan: Sequence[int]) -> bool:
    return place.order == (0, 1, 2) and not place.turned and tuple(shape) == tuple(scan)


def _stored_counts(volume: Volume) -> list[int]:
    """Lists the different stored values of a scan."""
    lowest, highest = int(volume.array.min()), int(volume.array.max())
    counts = np.zeros(highest - lowest + 1, np.int64)
    for slab in volume.array:
        flat: NDArray[np.int64] = slab.ravel().astype(np.int64) - lowest
        counts += np.bincount(flat, minlength=len(counts))
    return [int(lowest + step) for step in np.flatnonzero(counts)]


# --- names --------------------------------------------------------------------------------

Names = dict[int, tuple[str, Colour | None]]


def _names_of(path: Path) -> Names:
    if ".nii" in path.name.lower() and (names := _nifti_table(path)):
        return names
    stem = path.name.split(".")[0]
    for beside in (path.with_name(f"{stem}.csv"), path.with_name("structures.csv")):
        if beside.is_file() and (names := _csv_table(beside)):
            return names
    return {}


def _nifti_table(path: Path) -> Names:
    """Reads the label table of a NIfTI file's extension, if it has one."""
    with _plain(path) as file:
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
        names[number] = (name or f"label {number}", (red, green, blue))
    return names


def _plain(path: Path) -> IO[bytes]:
    if path.name.lower().endswith(".gz"):
        return gzip.open(path, "rb")  # type: ignore[return-value]  # it reads as a file does
    return path.open("rb")


def _csv_table(path: Path) -> Names:
    with path.open(encoding="utf-8-sig", newline="") as file:
        rows = list(csv.DictReader(file))
    columns = [name.strip().lower() for name in (rows[0] if rows else {})]
    number = next((column for column in NUMBERS if column in columns), None)
    named = next((column for column in NAMES if column in columns), None)
    names: Names = {}
    if number is None or named is None:
        return names
    for row in rows:
        told = {str(key).strip().lower(): str(value).strip() for key, value in row.items()}
        if told[number].isdecimal() and told[named]:
            names[int(told[number])] = (told[named], _csv_colour(told))
    return names


def _csv_colour(told: dict[str, str]) -> Colour | None:
    try:
        red, green, blue = (min(1.0, max(0.0, float(told[part]))) for part in COLOURS)
    except (KeyError, ValueError):
        return None
    return red, green, blue
