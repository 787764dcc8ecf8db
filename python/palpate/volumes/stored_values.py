"""Conversion of scan values to int16: ``value = slope * stored + intercept``.

Integers that span at most 65536 steps are stored exactly, as are multiples of the file's own slope.
All other values are rounded to 65536 steps over their range, and the largest error is reported.

Layout: arrays are [z, y, x]; slices are converted one by one, so that memory stays near that of the
result.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import VolumeFormatError

__all__ = ["Scale", "Stored", "to_stored"]

I16 = np.iinfo(np.int16)
STEPS = int(I16.max) - int(I16.min)
"""Steps between the lowest and the highest int16."""

ROUNDING = 1e-2
"""Fraction of a step that float32 may lose in ``slope * stored + intercept`` (24 bits, 16 used)."""


@dataclass(frozen=True)
class Scale:
    """How stored numbers become values: ``value = slope * stored + intercept``."""

    slope: float
    intercept: float


@dataclass(frozen=True)
class Stored:
    """Values as int16, shape [depth, height, width], and their scale."""

    values: NDArray[np.int16]
    scale: Scale
    error: float
    """Largest difference of a stored value from the file's [unit of the scan]; 0 where all are
    exact."""
    filled: int
    """Number of NaN or infinite values that were replaced."""


@dataclass(frozen=True)
class _Survey:
    """Properties of the values, collected in one pass."""

    low: float
    high: float
    whole: bool
    not_finite: int


def to_stored(
    values: NDArray[Any], *, fill: float | None = None, file_scale: Scale | None = None
) -> Stored:
    """Converts values to int16.

    Args:
        values: Numbers of any real type, shape [depth, height, width].
        fill: Replacement for NaN and infinite values.
        file_scale: The file's own slope and intercept, tried for values that are not integers.

    Raises:
        VolumeFormatError: Values are NaN or infinite and there is no ``fill``.
    """
    # data that are stored already are taken as they are
    if values.dtype == np.int16:
        return Stored(np.ascontiguousarray(values), Scale(1.0, 0.0), 0.0, 0)

    survey = _survey(values, fill)
    if survey.not_finite and fill is None:
        raise VolumeFormatError(
            f"{survey.not_finite} of {values.size} values are NaN or infinite; allowed: finite "
            "values, or a value to put in their place, such as --fill 0"
        )
    for scale, exact in _scales(survey, file_scale):
        stored, error = _convert(values, fill, scale)
        if exact and error > ROUNDING * scale.slope:
            continue
        return Stored(stored, scale, 0.0 if exact else error, survey.not_finite)
    raise AssertionError("the last scale is always taken")


def _scales(survey: _Survey, file_scale: Scale | None) -> Iterator[tuple[Scale, bool]]:
    """Yields the scales to try in order, each with whether it must represent all values exactly."""
    if survey.whole:
        yield from _steps(survey, Scale(1.0, 0.0))
    if file_scale is not None and file_scale.slope != 0.0:
        yield from _steps(survey, Scale(abs(file_scale.slope), file_scale.intercept))
    slope = (survey.high - survey.low) / STEPS or 1.0
    yield Scale(slope, survey.low - slope * I16.min), False


def _steps(survey: _Survey, scale: Scale) -> Iterator[tuple[Scale, bool]]:
    """Yields a scale, shifted by whole steps where int16 needs it, if its range suffices."""
    lowest = round((survey.low - scale.intercept) / scale.slope)
    highest = round((survey.high - scale.intercept) / scale.slope)
    if I16.min <= lowest and highest <= I16.max:
        yield scale, True
    elif highest - lowest <= STEPS:
        yield Scale(scale.slope, scale.intercept + scale.slope * (lowest - I16.min)), True


def _survey(values: NDArray[Any], fill: float | None) -> _Survey:
    low, high, whole, not_finite = np.inf, -np.inf, True, 0
    for slab in values:
        finite = np.isfinite(slab)
        missing = slab.size - int(np.count_nonzero(finite))
        not_finite += missing
        part = slab
        if missing:
            part = slab[finite] if fill is None else np.where(finite, slab, fill)
        if part.size:
            low, high = min(low, float(part.min())), max(high, float(part.max()))
            whole = whole and _is_whole(part)
    return _Survey(low, high, whole, not_finite)


def _is_whole(part: NDArray[Any]) -> bool:
    return part.dtype.kind in "iub" or bool(np.array_equal(part, np.rint(part)))


def _convert(
    values: NDArray[Any], fill: float | None, scale: Scale
) -> tuple[NDArray[np.int16], float]:
    """Rounds to a scale; returns the stored numbers and the largest error."""
    stored = np.empty(values.shape, np.int16)
    largest = 0.0
    for part, target in zip(values, stored, strict=True):
        wanted = part.astype(np.float64)
        if fill is not None:
            wanted[~np.isfinite(wanted)] = fill
        steps = np.rint((wanted - scale.intercept) / scale.slope).clip(I16.min, I16.max)
        target[...] = steps
        largest = max(largest, float(np.abs(scale.slope * steps + scale.intercept - wanted).max()))
    return stored, largest
