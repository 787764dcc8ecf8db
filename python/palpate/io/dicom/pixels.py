"""Values of DICOM slices: decoded, rescaled slice by slice, with air for padding.

Decoded by pydicom, through GDCM and OpenJPEG where they are compressed. Deflated frames and
run lengths of single bits, which neither knows, are unpacked here.

Arrays are [slice, row, column]. Source: DICOM PS3.3, C.7.5.1.1.2 (padding), C.7.6.3.1.2
(MONOCHROME1), C.11.1 (rescaling); PS3.5, annexes G (run lengths) and A.4 (encapsulation).
"""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import VolumeFormatError
from palpate.base.progress import Progress
from palpate.io.dicom.header import Frame, Header, damage_told
from palpate.io.dicom.mark import read_dataset
from palpate.io.dicom.promises import check_deflated, check_encoded, inflated
from palpate.io.dicom.rescale import looked_up

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

__all__ = [
    "AIR_HU",
    "DEFLATED_FRAMES",
    "SlicePixels",
    "file_values",
    "read_slice",
    "read_slices",
    "stored_pixels",
]

AIR_HU = -1000.0
"""What stands where a scanner measured nothing [HU]."""

DEFLATED_FRAMES = "1.2.840.10008.1.2.8.1"
"""Transfer syntax Deflated Image Frame Compression, not yet known to pydicom."""
RUN_LENGTHS = "1.2.840.10008.1.2.5"
MOST_THREADS = 8
READ = "complete, undamaged files, uncompressed or in JPEG, JPEG-LS, JPEG 2000, RLE or deflated"


@dataclass(frozen=True)
class SlicePixels:
    """Values of all slices, in the order of their files."""

    values: NDArray[Any]
    """int16 or int32 where all are whole, else float32; shape [slices, rows, columns]."""
    air: float
    """What stands where nothing was measured [unit of the scan]."""
    failed: tuple[tuple[Header, VolumeFormatError], ...] = ()
    """Files that cannot be decoded, whose slices are left out."""
    padded: int = 0
    """Voxels of padding whose value was another than air."""
    measurable: tuple[float, float] | None = None
    """Values of padding that what was measured may have too, lowest and highest [unit of the scan];
    None where it cannot."""


def read_slices(headers: Sequence[Header], *, progress: Progress) -> SlicePixels:
    """Decodes and rescales the slices of a series, several files at a time.

    Raises:
        VolumeFormatError: No file can be decoded.
    """
    voxels = sum(len(header.frames) * header.rows * header.columns for header in headers)
    said = f"reading {len(headers)} files, {voxels * 2 / 2**20:.0f} MiB"
    parts: list[_Part] = []
    failed: list[tuple[Header, VolumeFormatError]] = []
    # filters of warnings belong to all threads: what each of them sets is undone here
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for header, part in zip(headers, _in_parallel(_part_or_error, headers), strict=True):
            if isinstance(part, VolumeFormatError):
                failed.append((header, part))
            else:
                parts.append(part)
            progress(said, (len(parts) + len(failed)) / len(headers))
    if not parts:
        raise failed[0][1]

    # what was not measured is air, or where that has no known value the lowest that was
    air = AIR_HU if headers[0].unit == "HU" else min(part.lowest for part in parts)
    air = air if np.isfinite(air) else 0.0
    measured = min(part.lowest for part in parts), max(part.highest for part in parts)
    is_hu = headers[0].unit == "HU"
    padded = 0
    unsure: list[float] = []
    for part in parts:
        if part.padded is not None:
            padding = part.values[part.padded]
            padding = padding[padding != air]
            padded += padding.size
            unsure += _measurable(padding, measured, is_hu=is_hu)
            part.values[part.padded] = air
    values = np.concatenate([part.values for part in parts])
    measurable = (min(unsure), max(unsure)) if unsure else None
    return SlicePixels(values, air, tuple(failed), padded, measurable)


def _measurable(
    padding: NDArray[Any], measured: tuple[float, float], *, is_hu: bool
) -> list[float]:
    """Returns the ends of padding's values that may be measured ones; none where none may.

    Such are neither below all that was measured, nor air or less, nor far above.
    """
    lowest, highest = measured
    least = max(lowest, np.nextafter(AIR_HU, 0.0)) if is_hu else lowest
    # a scanner's highest number is next to others: metal may have it
    most = highest + (highest - lowest)
    found = padding[(padding >= least) & (padding <= most)]
    return [float(found.min()), float(found.max())] if found.size else []


def read_slice(header: Header, frame: int) -> NDArray[Any]:
    """Decodes and rescales one slice of a file, padding and all, shape [rows, columns].

    Raises:
        VolumeFormatError: It cannot be decoded.
    """
    alone = replace(header, frames=header.frames[frame : frame + 1])
    values: NDArray[Any] = _values(alone, _stored(header)[frame : frame + 1])[0]
    return values


def _in_parallel(
    work: Callable[[Header], _Part | VolumeFormatError], headers: Sequence[Header]
) -> Iterator[_Part | VolumeFormatError]:
    """Yields results in order; whatever ends the loop also ends the work."""
    threads = min(MOST_THREADS, os.cpu_count() or 1, len(headers))
    with ThreadPoolExecutor(threads) as pool:
        try:
            yield from pool.map(work, headers)
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


# --- one file ---------------------------------------------------------------------------


@dataclass(frozen=True)
class _Part:
    """Values of one file, and which of them are padding."""

    values: NDArray[Any]
    padded: NDArray[np.bool_] | None
    lowest: float
    """Of those that are not padding."""
    highest: float
    """Of the same."""


def _part_or_error(header: Header) -> _Part | VolumeFormatError:
    try:
        return _part(header)
    except VolumeFormatError as error:
        return error


def _part(header: Header) -> _Part:
    stored = _stored(header)
    padded = _padded(stored, header.padding)
    values = _values(header, stored)
    measured = values if padded is None else values[~padded]
    if not measured.size:
        return _Part(values, padded, np.inf, -np.inf)
    return _Part(values, padded, float(measured.min()), float(measured.max()))


def file_values(header: Header) -> NDArray[Any]:
    """Decodes and rescales all slices of a file, shape [frames, rows, columns].

    Raises:
        VolumeFormatError: It cannot be decoded.
    """
    return _values(header, _stored(header))


def _values(header: Header, stored: NDArray[Any]) -> NDArray[Any]:
    """Returns the values of numbers as they are stored, shape [frames, rows, columns]."""
    turned = header.inverted and not header.unit
    if header.table is not None:
        values = looked_up(stored, header.table)
        # over the range of a table of 16 bits
        return _turned(values.astype(np.uint16), 16).astype(np.int32) if turned else values
    if turned:
        # what is meant to be bright is high
        stored = _turned(stored, header.bits)
    frames = zip(stored, header.frames, strict=True)
    return np.stack([_rescaled(pixels, frame) for pixels, frame in frames])


def _stored(header: Header) -> NDArray[Any]:
    """Returns the numbers of the frames that are taken of a file."""
    stored = _plain(header)
    if stored is None:
        stored = stored_pixels(header.path, shape=(-1, header.rows, header.columns))
    return stored if header.taken is None else stored[list(header.taken)]


def _plain(header: Header) -> NDArray[Any] | None:
    """Returns pixels that stand in a file as they are; None where they do not."""
    # of a file of several phases the pixels in between would be counted wrong
    if header.plain is None or header.taken is not None or header.truncated:
        return None
    start, kind = header.plain
    shape = (len(header.frames), header.rows, header.columns)
    pixels = np.fromfile(header.path, np.dtype(kind), math.prod(shape), offset=start)
    return _used_bits(pixels, header.bits).reshape(shape)


def _padded(stored: NDArray[Any], padding: tuple[int, int] | None) -> NDArray[np.bool_] | None:
    if padding is None or stored.dtype.kind not in "iu":
        return None
    # some writers give the number without its sign, or with one too many
    low, high = (np.array(end).astype(stored.dtype) for end in padding)
    found: NDArray[np.bool_] = (stored >= low) & (stored <= high)
    return found if found.any() else None


def _turned(stored: NDArray[Any], bits: int) -> NDArray[Any]:
    """Returns numbers that fall where the given ones rise, over the same range."""
    if stored.dtype.kind == "u":
        turned: NDArray[Any] = np.array((1 << bits) - 1, stored.dtype) - stored
    else:
        turned = ~stored if stored.dtype.kind == "i" else -stored
    return turned


def _rescaled(stored: NDArray[Any], frame: Frame) -> NDArray[Any]:
    """Returns slope * stored + intercept, as whole numbers where it is so."""
    slope, intercept = frame.scale or (1.0, 0.0)
    if stored.dtype.kind == "f" or not (slope.is_integer() and intercept.is_integer()):
        return (stored * np.float64(slope) + intercept).astype(np.float32)
    low, high = sorted(slope * float(end) + intercept for end in (stored.min(), stored.max()))
    ends = np.iinfo(np.int16)
    # in int16 also where its numbers wrap on the way: the result fits
    kind = np.int16 if ends.min <= low and high <= ends.max else np.int32
    with np.errstate(over="ignore"):
        factor, offset = np.array([slope, intercept]).astype(np.int64).astype(kind)
        values: NDArray[Any] = stored.astype(kind)
        if factor != 1:
            values *= factor
        if offset != 0:
            values += offset
    return values


def stored_pixels(path: Path, *, shape: tuple[int, ...]) -> NDArray[Any]:
    """Returns the numbers of a file as they are stored, in the machine's order of bytes.

    Raises:
        VolumeFormatError: They cannot be decoded, or are not as many as announced.
    """
    with damage_told(path, allowed=READ):
        check_deflated(path)
        dataset = read_dataset(path)
        check_encoded(path, dataset)
        pixels = _decoded(dataset)
        native = pixels.astype(pixels.dtype.newbyteorder("="), copy=False)
        return _used_bits(native, int(dataset.get("BitsStored") or 0)).reshape(shape)


def _decoded(dataset: Dataset) -> NDArray[Any]:
    syntax = str(dataset.file_meta.TransferSyntaxUID)
    if syntax == DEFLATED_FRAMES:
        return _inflated(dataset)
    if syntax == RUN_LENGTHS and dataset.BitsAllocated == 1:
        return _bits_of_runs(dataset)
    pixels: NDArray[Any] = dataset.pixel_array
    return pixels


def _inflated(dataset: Dataset) -> NDArray[Any]:
    from pydicom.encaps import generate_frames

    count = int(dataset.get("NumberOfFrames") or 1)
    frames = generate_frames(dataset.PixelData, number_of_frames=count)
    size = dataset.Rows * dataset.Columns
    most = size * -(-dataset.BitsAllocated // 8)
    plain = [inflated(frame, size=most) for frame in frames]
    if dataset.BitsAllocated == 1:
        return np.stack([_bits(np.frombuffer(frame, np.uint8), size) for frame in plain])
    sign = "i" if dataset.PixelRepresentation else "u"
    kind = np.dtype(f"<{sign}{dataset.BitsAllocated // 8}")
    return np.stack([np.frombuffer(frame, kind, size) for frame in plain])


def _bits_of_runs(dataset: Dataset) -> NDArray[Any]:
    """Decodes run lengths of bytes that hold eight pixels each."""
    size = dataset.Rows * dataset.Columns
    dataset.Rows, dataset.Columns = 1, -(-size // 8)
    dataset.BitsAllocated, dataset.BitsStored, dataset.HighBit = 8, 8, 7
    packed = dataset.pixel_array.reshape(-1, dataset.Columns)
    return np.stack([_bits(frame, size) for frame in packed])


def _bits(packed: NDArray[np.uint8], size: int) -> NDArray[np.uint8]:
    return np.unpackbits(packed, count=size, bitorder="little")


def _used_bits(pixels: NDArray[Any], used: int) -> NDArray[Any]:
    """Drops bits above those in use, where old files keep overlays; carries the sign."""
    unused = pixels.dtype.itemsize * 8 - used
    # single bits are bytes by now
    if pixels.dtype.kind not in "iu" or unused <= 0 or used <= 1:
        return pixels
    shifted: NDArray[Any] = pixels << unused
    shifted >>= unused
    return shifted
