"""Conversion of scan values to int16: ``value = slope * stored + intercept``.

Integers that span at most 65536 steps are stored exactly, as are multiples of the file's own slope.
All other values are kept as they are beside stored ones, which touch and the picture use: those are
rounded to 65536 steps over their range.

Voxels without a value (NaN, infinite) are NaN among the kept values, and stored a step below all
others.

Layout: arrays are [z, y, x]; slices are converted one by one, so that memory stays near that of the
result.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate.base.errors import VolumeFormatError

__all__ = ["Scale", "Stored", "to_stored"]

I16 = np.iinfo(np.int16)
STEPS = int(I16.max) - int(I16.min)
"""Steps between the lowest and the highest int16."""

ROUNDING = 1e-2
"""Largest fraction of a step by which an exact value may be off."""
FLOAT_ERROR = 4.0 * float(np.finfo(np.float32).eps)
"""Error of ``slope * stored + intercept`` as float32, relative to its parts."""
WHOLE_FLOAT32 = 2.0**24
"""Up to which float32 holds every whole number."""
WHOLE_FLOAT64 = 2.0**53
"""Up to which float64 does."""
SINGLE_BYTES = 4
"""Of a float32."""
SINGLE_ROUNDING = 2.0**-24
"""By how much float32 rounds, relative to the value."""
LEAST_SINGLE_STEPS = 2.0**16
"""Steps of float32 over the range of values that it is to keep."""

LEAST_STEPS = 256
"""Steps over most values, outliers apart, that touch and the picture need."""
MOST = (0.1, 99.9)
"""Percentiles that most values lie between."""
SAMPLED = 1 << 20
"""Values that percentiles are taken from."""


@dataclass(frozen=True)
class Scale:
    """How stored numbers become values: ``value = slope * stored + intercept``."""

    slope: float
    intercept: float

    def rounding(self, values: ArrayLike) -> NDArray[np.float64]:
        """Returns by how much ``slope * stored + intercept`` may be off by rounding to float32."""
        error = FLOAT_ERROR * (np.abs(values) + abs(self.intercept))
        return np.minimum(error, ROUNDING * abs(self.slope))


@dataclass(frozen=True)
class Stored:
    """Values as int16, shape [depth, height, width], and their scale."""

    values: NDArray[np.int16]
    scale: Scale
    exact: NDArray[Any] | None
    """The values as they were given, NaN where there is none; None where int16 holds them all."""
    missing: int
    """Number of voxels without a value."""
    filled: int
    """Number of NaN or infinite values that were replaced."""
    off: float = 0.0
    """Largest difference to values given in 64 bits, where that shows in their range."""


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
    """Converts values to int16, and keeps them beside it where that does not hold them.

    Floats beyond single precision are kept in it, except where they leave its range.

    Args:
        values: Numbers of any real type, shape [depth, height, width].
        fill: Replacement for NaN and infinite values; without it these are no values.
        file_scale: The file's own slope and intercept, tried for values that are not integers.

    Raises:
        VolumeFormatError: There is no finite value.
    """
    # data that are stored already are taken as they are
    if values.dtype == np.int16:
        return Stored(np.ascontiguousarray(values), Scale(1.0, 0.0), None, 0, 0)

    survey = _survey(values, fill)
    missing = survey.not_finite if fill is None else 0
    if missing == values.size:
        raise VolumeFormatError(
            f"all {values.size} values are NaN or infinite; allowed: values, or one to put in "
            "their place (fill)"
        )
    filled = survey.not_finite - missing
    made = _stored(values, survey, file_scale, fill=fill)
    return replace(made, missing=missing, filled=filled, off=_off(values, made, survey))


def _stored(
    values: NDArray[Any], survey: _Survey, file_scale: Scale | None, *, fill: float | None
) -> Stored:
    missing = survey.not_finite > 0 and fill is None
    for scale in _exact_scales(survey, file_scale, spare=1 if missing else 0):
        stored, same = _convert(values, survey, scale, fill=fill, exactly=True)
        if same:
            exact = _kept(values, survey, fill) if missing else None
            return Stored(stored, scale, exact, 0, 0)
    scale = _rounding_scale(values, survey)
    stored, _ = _convert(values, survey, scale, fill=fill, exactly=False)
    return Stored(stored, scale, _kept(values, survey, fill), 0, 0)


def _off(values: NDArray[Any], made: Stored, survey: _Survey) -> float:
    """Returns the largest difference to values in 64 bits; 0 where their range does not show it."""
    if values.dtype.kind != "f" or values.itemsize <= SINGLE_BYTES:
        return 0.0
    largest = 0.0
    for given, stored, exact in zip(
        values, made.values, made.values if made.exact is None else made.exact, strict=True
    ):
        kept = made.scale.slope * stored + made.scale.intercept if made.exact is None else exact
        with np.errstate(invalid="ignore"):
            off = np.abs(kept.astype(np.float32 if made.exact is None else kept.dtype) - given)
        largest = max(largest, float(off.max(initial=0.0, where=np.isfinite(off))))
    return largest if largest > SINGLE_ROUNDING * (survey.high - survey.low) else 0.0


def _exact_scales(survey: _Survey, file_scale: Scale | None, *, spare: int) -> Iterator[Scale]:
    """Yields the scales that may represent all values exactly, in the order to try them."""
    if survey.whole and max(abs(survey.low), abs(survey.high)) > WHOLE_FLOAT64:
        # a scale in floats would round them
        return
    if survey.whole:
        yield from _steps(survey, Scale(1.0, 0.0), spare=spare)
    if file_scale is not None and file_scale.slope != 0.0:
        own = Scale(abs(file_scale.slope), file_scale.intercept)
        yield from _steps(survey, own, spare=spare)
    if survey.low == survey.high:
        yield Scale(1.0, survey.low)


def _steps(survey: _Survey, scale: Scale, *, spare: int) -> Iterator[Scale]:
    """Yields a scale, shifted by whole steps where int16 needs it, if its range suffices."""
    lowest = round((survey.low - scale.intercept) / scale.slope) - spare
    highest = round((survey.high - scale.intercept) / scale.slope)
    if I16.min <= lowest and highest <= I16.max:
        yield scale
    elif highest - lowest <= STEPS:
        yield Scale(scale.slope, scale.intercept + scale.slope * (lowest - I16.min))


def _rounding_scale(values: NDArray[Any], survey: _Survey) -> Scale:
    """Returns a scale over all values, or where outliers would leave few steps, over most."""
    low, high = survey.low, survey.high
    ends = _most(values)
    room = (ends[1] - ends[0]) * STEPS / LEAST_STEPS
    if high - low > room > 0.0:
        low = max(low, ends[0] - 0.5 * room)
        high = min(high, ends[1] + 0.5 * room)
    # integers that are one in floats are kept apart beside it
    slope = (high - low) / STEPS or 1.0
    if survey.not_finite:
        # the lowest number is that of no value
        slope = (high - low) / (STEPS - 1)
        low -= slope
    return Scale(slope, low - slope * I16.min)


def _most(values: NDArray[Any]) -> tuple[float, float]:
    """Returns ends that most values lie between, apart from the one that all the others have."""
    by = max(1, int(np.ceil((values.size / SAMPLED) ** (1.0 / 3.0))))
    sample = values[::by, ::by, ::by].astype(np.float64).ravel()
    sample = sample[np.isfinite(sample)]
    for _ in range(2):
        if not sample.size:
            break
        low, high = np.percentile(sample, MOST)
        if low < high:
            return float(low), float(high)
        sample = sample[sample != low]
    return 0.0, 0.0


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
    values: NDArray[Any], survey: _Survey, scale: Scale, *, fill: float | None, exactly: bool
) -> tuple[NDArray[np.int16], bool]:
    """Rounds to a scale; says whether values must be the same and are, and ends where not."""
    stored = np.empty(values.shape, np.int16)
    # a step below all others
    nothing = round((survey.low - scale.intercept) / scale.slope) - 1
    # whole numbers and whole steps: always the same
    certain = survey.whole and scale.slope == 1.0 and float(scale.intercept).is_integer()
    for part, target in zip(values, stored, strict=True):
        wanted = part.astype(np.float64)
        bad = ~np.isfinite(wanted) if survey.not_finite else None
        if bad is not None:
            wanted[bad] = survey.low if fill is None else fill
        steps = np.rint((wanted - scale.intercept) / scale.slope)
        if exactly and not certain and not _is_same(scale, steps, wanted):
            return stored, False
        if bad is not None and fill is None:
            steps[bad] = nothing
        target[...] = steps.clip(I16.min, I16.max)
    return stored, exactly


def _is_same(scale: Scale, steps: NDArray[np.float64], wanted: NDArray[np.float64]) -> bool:
    off = np.abs(scale.slope * steps + scale.intercept - wanted)
    return bool((off <= scale.rounding(wanted)).all())


def _kept(values: NDArray[Any], survey: _Survey, fill: float | None) -> NDArray[Any]:
    """Returns values as they are, with NaN or ``fill`` for those that are none."""
    if values.dtype.kind != "f":
        return np.ascontiguousarray(values, values.dtype.newbyteorder("="))
    largest = max(abs(survey.low), abs(survey.high))
    single = np.finfo(np.float32)
    fits = largest <= (WHOLE_FLOAT32 if survey.whole else single.max)
    if fits and values.itemsize > SINGLE_BYTES:
        fits = not ((np.abs(values) < single.tiny) & (values != 0.0)).any()
        # small differences of large values
        fits &= largest * float(single.eps) <= (survey.high - survey.low) / LEAST_SINGLE_STEPS
    kind = np.float32 if fits or values.itemsize <= 4 else np.float64
    kept = np.array(values, kind, order="C", copy=True if survey.not_finite else None)
    if survey.not_finite:
        kept[~np.isfinite(kept)] = np.nan if fill is None else fill
    return kept
