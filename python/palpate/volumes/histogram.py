"""Where air, soft tissue and bone lie among the values of a scan.

CT values are linear in attenuation, so the peaks of air (-1000 HU) and soft tissue (40 HU) give the
value of 250 HU in a scan without a unit. Other kinds of scan get a threshold in the same way, as a
starting point.

Source of the split between air and tissue: N. Otsu, "A threshold selection method from gray-level
histograms", IEEE Trans. SMC 9 (1979).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Anchors", "Histogram", "anchors"]

SOFT_TISSUE_HU = 40.0
BONE_HU = 250.0
BONE_BEYOND_SOFT = (BONE_HU - SOFT_TISSUE_HU) / (SOFT_TISSUE_HU + 1000.0)
"""Distance of bone from soft tissue, as a fraction of that from air to soft tissue."""

SMOOTHING = 5
"""Bins of the moving mean that suppresses noise."""
PEAK_REACH = 8
"""Bins on each side among which a peak is the highest."""
PEAK_SHARE = 0.5
"""Height from which a peak counts, relative to the tallest on its side of the split. Fat and muscle
both count; contrast medium and bone do not."""
PADDING_SHARE = 0.01
"""A lowest value is padding where the bins beside it hold at most this fraction of its count."""
LEAST_BONE = 5e-4
"""Smallest fraction of voxels that is offered as a segment."""


@dataclass(frozen=True)
class Histogram:
    """Counts in equal bins from ``low`` to ``high`` [unit of the scan], shape [bins]."""

    low: float
    high: float
    counts: NDArray[np.uint64]

    @property
    def centres(self) -> NDArray[np.float64]:
        """Centre of each bin [unit of the scan], shape [bins]."""
        width = (self.high - self.low) / len(self.counts)
        bins = np.arange(len(self.counts), dtype=np.float64)
        return self.low + width * (bins + 0.5)


@dataclass(frozen=True)
class Anchors:
    """Values of soft tissue and of the lower end of bone [unit of the scan]."""

    soft_tissue: float
    bone: float


def anchors(histogram: Histogram, *, unit: str) -> Anchors:
    """Returns the values of soft tissue and bone: fixed for HU, else by the histogram."""
    if unit == "HU":
        return Anchors(SOFT_TISSUE_HU, BONE_HU)
    counts = _without_padding(histogram.counts.astype(np.float64))
    values = histogram.centres
    split = _otsu(counts, values)

    # the last big peak on each side: beyond padding and lung, beyond fat
    peaks = _peaks(np.convolve(counts, np.full(SMOOTHING, 1.0 / SMOOTHING), "same"))
    air = _last_big(peaks, range(split + 1), default=0)
    soft = _last_big(peaks, range(split + 1, len(counts)), default=split)
    bone = values[soft] + BONE_BEYOND_SOFT * (values[soft] - values[air])
    highest = _upper_value(counts, values)
    width = float(values[1] - values[0])
    return Anchors(_tidy(float(values[soft]), width), _tidy(min(float(bone), highest), width))


def _tidy(value: float, width: float) -> float:
    """Rounds a value to the power of ten below the width of a bin, for display."""
    # a scan of one value has bins without width
    return round(value, -math.floor(math.log10(width))) if width > 0.0 else value


def _without_padding(counts: NDArray[np.float64]) -> NDArray[np.float64]:
    """Removes a lowest value that stands alone: padding outside the scanner's field of view."""
    near = counts[1 : PEAK_REACH + 1].sum()
    if near > PADDING_SHARE * counts[0] or counts[PEAK_REACH + 1 :].sum() == 0.0:
        return counts
    kept = counts.copy()
    kept[: PEAK_REACH + 1] = 0.0
    return kept


def _otsu(counts: NDArray[np.float64], values: NDArray[np.float64]) -> int:
    """Returns the last bin of the lower class of Otsu's split (1979)."""
    below = np.cumsum(counts)
    moment = np.cumsum(counts * values)
    above = below[-1] - below
    apart = moment[-1] * below / below[-1] - moment
    with np.errstate(divide="ignore", invalid="ignore"):
        between = np.where((below > 0) & (above > 0), apart**2 / (below * above), -1.0)
    return int(np.argmax(between))


def _peaks(smooth: NDArray[np.float64]) -> dict[int, float]:
    """Maps the bins that are local maxima to their height."""
    reach = range(len(smooth))
    highest = (smooth[max(0, i - PEAK_REACH) : i + PEAK_REACH + 1].max() for i in reach)
    return {
        i: float(smooth[i])
        for i, top in zip(reach, highest, strict=True)
        if smooth[i] == top and top > 0
    }


def _last_big(peaks: dict[int, float], bins: range, *, default: int) -> int:
    inside = {i: height for i, height in peaks.items() if i in bins}
    if not inside:
        return default
    least = PEAK_SHARE * max(inside.values())
    return max(i for i, height in inside.items() if height >= least)


def _upper_value(counts: NDArray[np.float64], values: NDArray[np.float64]) -> float:
    """Returns a value with enough voxels above it for touch."""
    share_above = 1.0 - np.cumsum(counts) / counts.sum()
    return float(values[int(np.argmax(share_above < LEAST_BONE))])
