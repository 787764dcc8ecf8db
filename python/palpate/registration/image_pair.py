"""Two images that are compared: on which grids, by which metric, and how alike they are.

Frame: LPS [mm]; a transform takes points of the fixed image to the moving one. Images, masks and
transforms are SimpleITK's. The metric is as ITK has it: made small (minus the mutual information,
minus the squared correlation, mean squares).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from palpate.base.errors import OptionError
from palpate.base.simpleitk import reason_of, simpleitk
from palpate.registration.options import STARTS, Metric, RegistrationError
from palpate.registration.search_history import SearchHistory
from palpate.registration.start import mask_on

__all__ = ["Compared", "Measured", "check_content", "coarser"]

LEAST_AT_LEVEL = 8
"""Voxels along each axis of a level, where the scan has so many."""
BLUR = 0.5
"""Standard deviation of the smoothing of a coarser level, per step of its grid."""
MEASURED_VOXELS = 1_000_000
"""About how many voxels the metric before and after is computed from."""
WORSE = 1e-2
"""Share of the metric, or of the values' variance, by which an end may be worse: scans may lie
right already."""
USUAL_OVERLAP = 0.5
"""Share of the overlap at the start that is left in most cases; less must be borne out."""
LEAST_OVERLAP = 0.15
"""Share that must be left in any case: with less, the search ran away."""
LEAST_CONTRAST = 0.5
"""Variance of the part that is covered, as a share of the whole scan's: it shows something."""
LEAST_GAIN = 0.1
"""Share of the metric by which an end must be better where little of the overlap is left."""
LEAST_ALIKE = 0.01
"""Squared correlation, or mutual information [nat], below which nothing of scans is alike."""
BESIDE = 2.0
"""How far beside a place it is looked whether another is better, in voxels of the fixed scan."""


def check_content(images: tuple[Any, Any], masks: tuple[Any, Any]) -> None:
    """Refuses scans that show nothing by which they could be compared; masks are images or None.

    Raises:
        OptionError: A mask has no voxel in its scan, or a scan has one value, there or everywhere.
    """
    sitk = simpleitk()
    for which, image, mask in zip(("fixed", "moving"), images, masks, strict=True):
        values = sitk.GetArrayViewFromImage(image)
        if mask is not None:
            values = values[sitk.GetArrayFromImage(mask_on(mask, image)) != 0]
        if not values.size:
            raise OptionError(
                f"the mask of the {which} scan has no voxel in it; allowed: one with voxels"
            )
        low, high = float(values.min()), float(values.max())
        if low == high:
            where = "everywhere" if mask is None else "within its mask"
            raise OptionError(
                f"the {which} scan has one value, {low:g}, {where}, so nothing tells where it "
                "lies; allowed: scans whose values differ"
            )


@dataclass(frozen=True)
class Measured:
    """How alike two scans are under a transform."""

    metric: float
    overlap: float
    """Share of the fixed scan, or of its mask, that the moving one covers."""
    contrast: float = 1.0
    """Variance of the fixed scan where it is covered, as a share of the whole's."""


@dataclass(frozen=True, eq=False)
class Compared:
    """A fixed and a moving image, with masks or None."""

    images: tuple[Any, Any]
    masks: tuple[Any, Any]
    metric: Metric
    bins: int

    def shrinks(self, wanted: tuple[int, ...]) -> tuple[int, ...]:
        """Returns how many times coarser levels are, as far as the fixed image has the voxels."""
        shortest = min(self.images[0].GetSize())
        return tuple(n for n in wanted if n == 1 or shortest >= n * LEAST_AT_LEVEL)

    @lru_cache(maxsize=2)  # noqa: B019  # two stages go through the same levels
    def level(self, shrink: int) -> tuple[Any, Any]:
        """Returns both images on coarser grids."""
        fixed, moving = self.images
        return (
            coarser(fixed, _factors(fixed.GetSize(), shrink)),
            coarser(moving, _factors(moving.GetSize(), shrink)),
        )

    def method(self) -> Any:  # noqa: ANN401
        """Returns a method on the grids as they are given, with metric and masks."""
        method = simpleitk().ImageRegistrationMethod()
        if self.metric == "mutual-information":
            method.SetMetricAsMattesMutualInformation(self.bins)
        elif self.metric == "correlation":
            method.SetMetricAsCorrelation()
        else:
            method.SetMetricAsMeanSquares()
        fixed_mask, moving_mask = self.masks
        if fixed_mask is not None:
            method.SetMetricFixedMask(fixed_mask)
        if moving_mask is not None:
            method.SetMetricMovingMask(moving_mask)
        # gradients where they are asked for take less memory than gradients everywhere
        method.MetricUseFixedImageGradientFilterOff()
        method.MetricUseMovingImageGradientFilterOff()
        method.SetInterpolator(simpleitk().sitkLinear)
        return method

    def measure(self, transform: Any, history: SearchHistory) -> Measured:  # noqa: ANN401
        """Returns how alike the scans are under a transform, by all voxels of a coarser grid.

        Raises:
            RegistrationError: They do not overlap.
        """
        sitk = simpleitk()
        size = self.images[0].GetSize()
        coarser = max(1, round((float(np.prod(size)) / MEASURED_VOXELS) ** (1.0 / 3.0)))
        fixed, moving = sitk.Shrink(self.images[0], _factors(size, coarser)), self.images[1]
        method = self.method()
        method.SetInitialTransform(sitk.Transform(transform), inPlace=False)
        try:
            metric = float(method.MetricEvaluate(fixed, moving))
        except RuntimeError as error:
            raise history.no_overlap(reason_of(error)) from None
        there = sitk.Image(moving.GetSize(), sitk.sitkUInt8) + 1
        there.CopyInformation(moving)
        covered = sitk.Resample(there, fixed, transform, sitk.sitkNearestNeighbor, 0.0)
        inside = sitk.GetArrayFromImage(covered) != 0
        values = sitk.GetArrayViewFromImage(fixed)
        if self.masks[0] is not None:
            there = sitk.GetArrayFromImage(mask_on(self.masks[0], fixed)) != 0
            inside, values = inside[there], values[there]
        if not inside.any():
            # mean squares of nothing are no error to ITK
            raise history.no_overlap("no voxel of one lies in the other")
        whole = float(np.var(values))
        contrast = float(np.var(values[inside])) / whole if whole > 0.0 else 0.0
        return Measured(metric, float(inside.mean()), contrast)

    def is_best_near(
        self,
        transform: Any,  # noqa: ANN401
        measured: Measured,
        history: SearchHistory,
    ) -> bool:
        """Says whether the scans are less alike in all places a little beside one.

        Raises:
            RegistrationError: They do not overlap there.
        """
        sitk = simpleitk()
        far = BESIDE * max(self.images[0].GetSpacing())
        for step in np.vstack([far * np.eye(3), -far * np.eye(3)]).tolist():
            beside = sitk.CompositeTransform([sitk.TranslationTransform(3, step), transform])
            if not self.measure(beside, history).metric > measured.metric:
                return False
        return True

    def check(self, before: Measured, after: Measured, history: SearchHistory) -> None:
        """Refuses an end that is worse than its start.

        Raises:
            RegistrationError: It is; the error has the curve.
        """
        scale = abs(before.metric)
        if self.metric == "mean-squares":
            scale = float(np.var(simpleitk().GetArrayViewFromImage(self.images[0])))
        if not after.metric <= before.metric + WORSE * scale:
            why = "the scans did not become more alike"
        elif _is_away(before, after, scale):
            why = "the scans were moved apart"
        elif self.metric != "mean-squares" and -after.metric < LEAST_ALIKE:
            why = "nothing in the scans is alike, at the start nor in the end"
        else:
            return
        raise self.refusal(why, (before, after), history)

    def refusal(
        self, why: str, measured: tuple[Measured, Measured], history: SearchHistory
    ) -> RegistrationError:
        """Returns the error of a search whose end is no answer; ``measured`` are start and end."""
        before, after = measured
        return RegistrationError(
            f"{why} ({self.metric} {before.metric:.4g} before, {after.metric:.4g} after, less is "
            f"better; {before.overlap:.0%} and {after.overlap:.0%} covered; on the way: "
            f"{history.summary()}); nothing was changed; allowed: scans of the same part, another "
            f"start ({', '.join(STARTS)}), masks, or a simpler kind",
            history.curve,
        )


def _is_away(before: Measured, after: Measured, scale: float) -> bool:
    """Says whether a search ran away, rather than found scans that share a part only."""
    left = after.overlap / before.overlap
    borne_out = (
        after.contrast >= LEAST_CONTRAST and after.metric <= before.metric - LEAST_GAIN * scale
    )
    return left < (LEAST_OVERLAP if borne_out else USUAL_OVERLAP)


def _factors(size: tuple[int, ...], shrink: int) -> list[int]:
    return [max(1, min(shrink, length // LEAST_AT_LEVEL)) for length in size]


def coarser(image: Any, factors: Sequence[int]) -> Any:  # noqa: ANN401
    """Returns an image smoothed and on a grid that is coarser by a factor for each axis."""
    if max(factors) == 1:
        return image
    sitk = simpleitk()
    widths = [
        BLUR * factor * step for factor, step in zip(factors, image.GetSpacing(), strict=True)
    ]
    return sitk.Shrink(sitk.SmoothingRecursiveGaussian(image, widths), list(factors))
