"""Filtered back-projection of parallel beams, for where no library for it is installed.

Each row of a projection is filtered by a ramp and back-projected along its rays over the slices
(Ramachandran and Lakshminarayanan, PNAS 68(9), 1971; Kak and Slaney, Principles of Computerized
Tomographic Imaging, 1988, 3.3.3). RTK does the same many times as fast.

Frames: that of ``palpate.reconstruction.scanner``, and the patient's (LPS): x, y, z of the patient
are x, z, y of the device, or x, -z, y where the source begins in front.
Layout: projections are [angle, v, u], scans [z, y, x].
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from palpate.base.progress import Progress
from palpate.reconstruction.scanner import Grid, Scanner

__all__ = ["back_projected"]

AT_ONCE = 8
"""Projections between two reports of progress."""
MOST_VALUES = 1 << 22
"""Most values that are back-projected at a time, which limits memory."""

Values = NDArray[np.float32]


def back_projected(
    projections: Values, scanner: Scanner, grid: Grid, *, hann: float, progress: Progress
) -> Values:
    """Returns attenuation [1/mm] in the patient frame, shape [z, y, x].

    Args:
        projections: Line integrals [1], shape [angle, v, u].
        scanner: Geometry: equal angles over 180 or 360 degrees.
        grid: Grid of the scan around the axis.
        hann: Cut-off of the Hann window, as a fraction of the highest frequency; 0 for no window.
        progress: Takes the progress.
    """
    count = len(projections)
    x, y, z = (
        edge * np.arange(0.5 * (1 - size), 0.5 * size, dtype=np.float64)
        for size, edge in zip(grid.size, grid.voxel, strict=True)
    )
    ramp = _ramp(projections.shape[2], scanner.pixel[0], hann)
    found = np.zeros((len(z), len(y) * len(x)), np.float32)
    slices = max(1, MOST_VALUES // found.shape[1])
    for number, (image, angle) in enumerate(zip(projections, scanner.angles, strict=True)):
        if number % AT_ONCE == 0:
            progress(f"reconstructing from {count} projections", number / count)
        rows = _filtered(_at_heights(image, z, scanner), ramp)
        turn = math.radians(angle)
        deep = scanner.posterior * y[:, None]
        across = (x * math.cos(turn) - deep * math.sin(turn) - scanner.offset[0]).ravel()
        left, share = _between(across / scanner.pixel[0], rows.shape[1])
        for first in range(0, len(z), slices):
            some = rows[first : first + slices]
            here = found[first : first + slices]
            here += some[:, left] * (1.0 - share)
            here += some[:, left + 1] * share
    # the mean over half a turn; over a whole one each ray comes twice
    return (found * np.float32(math.pi / count)).reshape(len(z), len(y), len(x))


def _ramp(columns: int, pixel: float, hann: float) -> NDArray[np.float64]:
    """Returns the filter of padded rows in the frequency domain [1/mm]."""
    length = 1 << (2 * columns - 1).bit_length()
    # the ramp as it is between samples: its Fourier transform would have a wrong mean
    offsets = np.minimum(np.arange(length), length - np.arange(length))
    kernel = np.zeros(length)
    kernel[0] = 0.25
    odd = offsets % 2 == 1
    kernel[odd] = -1.0 / (math.pi * offsets[odd]) ** 2
    ramp = np.fft.rfft(kernel).real / pixel
    if hann > 0.0:
        share = np.linspace(0.0, 1.0, len(ramp)) / hann
        ramp *= np.where(share < 1.0, 0.5 * (1.0 + np.cos(math.pi * np.minimum(share, 1.0))), 0.0)
    return ramp


def _filtered(rows: Values, ramp: NDArray[np.float64]) -> Values:
    """Returns filtered rows, with a 0 before and after each."""
    columns = rows.shape[1]
    length = 2 * (len(ramp) - 1)
    sharp = np.fft.irfft(np.fft.rfft(rows, length, axis=1) * ramp, length, axis=1)[:, :columns]
    return np.pad(sharp, ((0, 0), (1, 1))).astype(np.float32)


def _at_heights(image: Values, z: NDArray[np.float64], scanner: Scanner) -> Values:
    """Returns rows of the detector at these heights [mm]; 0 beyond the detector."""
    below, share = _between((z - scanner.offset[1]) / scanner.pixel[1], len(image) + 2)
    padded = np.pad(image, ((1, 1), (0, 0)))
    found: Values = padded[below] * (1.0 - share)[:, None] + padded[below + 1] * share[:, None]
    return found


def _between(
    place: NDArray[np.float64], count: int
) -> tuple[NDArray[np.intp], NDArray[np.float32]]:
    """Returns the sample before each place, and the weight of the next one.

    Args:
        place: Distance from the middle of all samples, in steps between them.
        count: Number of samples, with a 0 at either end.
    """
    index = np.clip(place + 0.5 * (count - 1), 0.0, count - 1.0 - 1e-6)
    before = np.floor(index).astype(np.intp)
    return before, (index - before).astype(np.float32)
