"""Which numbers a label map holds, and small codes in their place.

Labels are whole numbers of any size, such as the identifiers of an atlas: they are never turned
into others on the way. Floats without a fraction are such numbers too.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError

__all__ = ["label_codes", "label_values"]

MOST_COUNTED = 4096
"""Different values after which counting ends."""
LARGEST_TABLE = 1 << 20
"""Steps between the lowest and the highest label that are looked up in a table."""

Value = int | float
"""A float only where it has a fraction."""


def label_values(path: Path, image: NDArray[Any], *, most: int) -> list[Value]:
    """Lists the different values of an image but 0, the lowest first.

    Args:
        path: The file, for the message.
        image: Numbers of any real type, shape [z, y, x]; what is no number is no label.
        most: Values that are labels still.

    Raises:
        OptionError: There are more.
    """
    found: NDArray[Any] = np.zeros(1, image.dtype)
    for slab in image:
        found = np.union1d(found, _ends(slab))
        if len(found) > MOST_COUNTED:
            break
    finite = found[np.isfinite(found) & (found != 0)]
    if len(finite) > most:
        count = f"more than {MOST_COUNTED}" if len(found) > MOST_COUNTED else str(len(finite))
        raise OptionError(
            f"{path} holds {count} different values, as scans do; allowed: label maps of at most "
            f"{most} labels"
        )
    return [int(value) if value == np.rint(value) else float(value) for value in finite]


def _ends(slab: NDArray[Any]) -> NDArray[Any]:
    """Returns every value that a slab holds, most of them once for each run of equal ones."""
    flat = slab.ravel()
    return np.append(flat[:-1][flat[1:] != flat[:-1]], flat[-1:])


def label_codes(image: NDArray[Any], values: list[Value]) -> NDArray[np.int16]:
    """Returns the number of each voxel's label in a list that starts at 1; 0 where there is none.

    Args:
        image: Shape [z, y, x].
        values: Those of the image but 0, the lowest first.
    """
    codes = np.zeros(image.shape, np.int16)
    known = np.array(values, image.dtype)
    for slab, target in zip(image, codes, strict=True):
        target[...] = _codes(slab, known)
    return codes


def _codes(slab: NDArray[Any], known: NDArray[Any]) -> NDArray[Any]:
    if not len(known):
        return np.zeros(slab.shape, np.int16)
    span = int(known[-1]) - int(known[0])
    if slab.dtype.kind not in "iub" or span >= LARGEST_TABLE:
        place = np.minimum(np.searchsorted(known, slab), len(known) - 1)
        return np.where(known[place] == slab, place + 1, 0)
    # wide enough for differences of all
    wide = np.uint64 if slab.dtype.kind == "u" else np.int64
    lowest = known[0].astype(wide)
    table = np.zeros(span + 1, np.int16)
    table[(known.astype(wide) - lowest).astype(np.intp)] = np.arange(1, len(known) + 1)
    inside = (slab >= known[0]) & (slab <= known[-1])
    steps = np.where(inside, slab, known[0]).astype(wide) - lowest
    found: NDArray[Any] = np.where(inside, table[steps.astype(np.intp)], 0)
    return found
