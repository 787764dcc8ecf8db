"""How stored numbers of DICOM become values: by slope and intercept, or by a table.

Source: DICOM PS3.3, C.11.1 (modality LUT), C.7.6.16.2.9 (pixel value transformation).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

__all__ = [
    "ModalityTable",
    "looked_up",
    "real_world_scale",
    "scale_of",
    "scale_trouble",
    "table_of",
]


@dataclass(frozen=True)
class ModalityTable:
    """Values by stored number (Modality LUT Sequence)."""

    first: int
    """Stored number of the first entry; lower ones have its value."""
    entries: bytes
    """Of 16 bits each, in the machine's order."""
    kind: str
    """What the values are, such as "HU" or "US" (unspecified)."""


def scale_of(holder: Dataset) -> tuple[float, float] | None:
    """Returns slope and intercept, of which a missing one changes nothing; None without both."""
    slope, intercept = _number(holder, "RescaleSlope"), _number(holder, "RescaleIntercept")
    if (slope is None and intercept is None) or scale_trouble(holder) is not None:
        return None
    return 1.0 if slope is None else slope, 0.0 if intercept is None else intercept


def real_world_scale(mapping: Dataset) -> tuple[float, float] | None:
    """Returns slope and intercept of a Real World Value Mapping; None where it has none.

    Source: DICOM PS3.3, C.7.6.16.2.11 (real world value mapping).
    """
    slope = _number(mapping, "RealWorldValueSlope")
    intercept = _number(mapping, "RealWorldValueIntercept")
    if slope is None or not math.isfinite(slope) or slope == 0.0:
        return None
    if intercept is not None and not math.isfinite(intercept):
        return None
    return slope, intercept or 0.0


def scale_trouble(holder: Dataset) -> str | None:
    """Says why slope and intercept give no values; None where they do."""
    slope, intercept = _number(holder, "RescaleSlope"), _number(holder, "RescaleIntercept")
    if slope == 0.0:
        what = "RescaleSlope is 0"
    elif slope is not None and not math.isfinite(slope):
        what = "RescaleSlope is no number"
    elif intercept is not None and not math.isfinite(intercept):
        what = "RescaleIntercept is no number"
    else:
        return None
    return f"{what}, which gives no values: they are taken as they are stored"


def _number(holder: Dataset, name: str) -> float | None:
    """Returns a number; None where it is missing or empty, NaN where it is none."""
    if name not in holder:
        return None
    try:
        value = holder[name].value
        return None if value is None or value == "" else float(value)
    except (TypeError, ValueError):
        return math.nan


def table_of(dataset: Dataset) -> ModalityTable | None:
    """Returns the table of a file; None where it has none.

    Raises:
        ValueError: It has fewer entries than it announces.
    """
    if not dataset.get("ModalityLUTSequence"):
        return None
    item = dataset.ModalityLUTSequence[0]
    count, first, bits = (int(number) for number in item.LUTDescriptor)
    count = count or 1 << 16
    if first >= 1 << 15 and dataset.get("PixelRepresentation"):
        # its sign is lost where the descriptor was read as unsigned
        first -= 1 << 16
    data = item.LUTData
    if isinstance(data, bytes):
        order = "<" if dataset.original_encoding[1] is not False else ">"
        # entries of 8 bits may be packed (PS3.3, C.11.1.1.1)
        packed = bits <= 8 and len(data) < 2 * count
        entries = np.frombuffer(data, np.uint8 if packed else np.dtype(f"{order}u2"))
    else:
        entries = np.atleast_1d(np.asarray(data)) & 0xFFFF
    if len(entries) < count:
        raise ValueError(f"a modality LUT of {count} entries holds {len(entries)}")
    kind = str(item.get("ModalityLUTType") or "")
    return ModalityTable(first, entries[:count].astype(np.uint16).tobytes(), kind)


def looked_up(stored: NDArray[Any], table: ModalityTable) -> NDArray[np.int32]:
    """Returns the values of stored numbers; those beyond the table have its ends'."""
    entries = np.frombuffer(table.entries, np.uint16)
    place = np.clip(stored.astype(np.int64) - table.first, 0, len(entries) - 1)
    return entries[place].astype(np.int32)
