"""Segments grown from seeds until they meet where values change most.

Source: S. Beucher and F. Meyer, "The morphological approach to segmentation: the watershed
transformation", 1993; markers flood the size of the gradient, as ITK computes it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.base.progress import Progress, silent
from palpate.base.simpleitk import simpleitk
from palpate.segmentation.mask_shape import box_of
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume

__all__ = ["MOST_SEEDS", "grown_from_seeds"]

MOST_SEEDS = 50

SMOOTHING = 1.0
"""Standard deviation of the Gaussian under which the gradient is taken [mm]."""

AROUND = 10.0
"""How far beyond the box of all seeds segments may grow [mm]."""


class _Filter(Protocol):
    """What is used of a filter of ITK."""

    def AddCommand(self, event: int, command: object) -> int: ...  # noqa: N802
    def GetProgress(self) -> float: ...  # noqa: N802
    def Abort(self) -> None: ...  # noqa: N802
    def Execute(self, *images: object) -> object: ...  # noqa: N802


def grown_from_seeds(
    volume: Volume,
    seeds: Sequence[Segment],
    *,
    smoothing: float = SMOOTHING,
    around: float = AROUND,
    progress: Progress = silent,
) -> list[Segment]:
    """Returns a segment for each seed: together they fill the box of all seeds.

    One of the seeds is what is around: it keeps the others from growing into it.

    Args:
        volume: The scan.
        seeds: Two or more segments on its grid that share no voxel.
        smoothing: Standard deviation of the Gaussian that takes noise out of the gradient [mm].
        around: How far beyond the box of all seeds segments may grow [mm].
        progress: Told what is being done; what it raises stops the work.

    Raises:
        OptionError: There are too few seeds, they share voxels, or a number is out of range.
    """
    _check_seeds(volume, seeds)
    for name, value, low, high in (
        ("smoothing", smoothing, 0.1, 20.0),
        ("around", around, 0.0, 1000.0),
    ):
        if not low <= value <= high:
            raise OptionError(f"{name} {value:g} mm given; allowed: {low:g} to {high:g} mm")
    markers = np.zeros(volume.shape, np.uint8)
    for number, seed in enumerate(seeds, start=1):
        mask = seed.mask() != 0
        if not mask.any():
            raise OptionError(f"seed {seed.name!r} is empty; allowed: seeds with voxels")
        if markers[mask].any():
            raise OptionError(f"seed {seed.name!r} shares voxels with another; allowed: none")
        markers[mask] = number
    box = box_of(markers != 0, around, volume.spacing)
    sitk = simpleitk()
    values = sitk.GetImageFromArray(volume.intensities(box))
    values.SetSpacing(volume.spacing)
    progress("finding borders", None)
    gradient = sitk.GradientMagnitudeRecursiveGaussianImageFilter()
    gradient.SetSigma(smoothing)
    borders = _told(gradient, (values,), lambda share: progress("finding borders", share))
    started = sitk.GetImageFromArray(markers[box])
    started.SetSpacing(volume.spacing)
    watershed = sitk.MorphologicalWatershedFromMarkersImageFilter()
    watershed.MarkWatershedLineOff()
    flooded = _told(
        watershed, (borders, started), lambda share: progress("growing from seeds", share)
    )
    labels: NDArray[np.uint8] = sitk.GetArrayFromImage(flooded)
    made = []
    for number, seed in enumerate(seeds, start=1):
        mask = np.zeros(volume.shape, bool)
        mask[box] = labels == number
        made.append(volume.segment(mask, name=f"{seed.name[:80]}, grown"))
    return made


def _check_seeds(volume: Volume, seeds: Sequence[Segment]) -> None:
    if not 2 <= len(seeds) <= MOST_SEEDS:
        raise OptionError(f"{len(seeds)} seeds given; allowed: 2 to {MOST_SEEDS}, one is around")
    for seed in seeds:
        if seed.has_own_grid or seed.volume.shape != volume.shape:
            raise OptionError(f"seed {seed.name!r} is on another grid; allowed: that of the scan")


def _told(work: _Filter, images: tuple[object, ...], tell: Callable[[float], None]) -> object:
    """Runs a filter that tells where it is, and stops it where that raises."""
    stopped: list[BaseException] = []

    def listen() -> None:
        try:
            tell(work.GetProgress())
        except BaseException as error:  # noqa: BLE001  # it goes on once the filter has stopped
            stopped.append(error)
            work.Abort()

    work.AddCommand(simpleitk().sitkProgressEvent, listen)
    try:
        result = work.Execute(*images)
    except RuntimeError:
        if not stopped:
            raise
    if stopped:
        raise stopped[0]
    return result
