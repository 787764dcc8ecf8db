"""The search for a transform: stages of more and more freedom, each from coarse to fine grids.

Frame: LPS [mm]; a transform takes points of the fixed image to the moving one. The metric is as
ITK has it: made small (minus the mutual information, minus the squared correlation, mean squares).
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from palpate.progress import Progress
from palpate.registration_options import (
    STARTS,
    Kind,
    Level,
    Metric,
    RegistrationError,
    SearchOptions,
    Watch,
    unwatched,
)
from palpate.registration_start import affine_of, mask_on
from palpate.simpleitk import reason_of, simpleitk

__all__ = ["Measured", "Search"]

SHRINKS = (4, 2, 1)
"""How many times coarser each level is than the scan."""
LEAST_AT_LEVEL = 8
"""Voxels along each axis of a level, where the scan has so many."""
BLUR = 0.5
"""Standard deviation of the smoothing of a coarser level, per step of its grid."""
LAST_STEP = 0.005
"""Of the first step, which is as long as a voxel of the level: a search ends with it."""
MORE_SAMPLES = 4
"""Times as many for a bent transform on a level than on the next finer one."""
MEASURED_VOXELS = 1_000_000
"""About how many tell the metric before and after."""
WORSE = 1e-2
"""Share of the metric, or of the values' variance, by which an end may be worse: scans may lie
right already."""
LEAST_OVERLAP = 0.5
"""Of the overlap at the start: where less of it is left, the search ran away."""

STAGES: dict[Kind, tuple[Kind, ...]] = {
    "rigid": ("rigid",),
    "affine": ("rigid", "affine"),
    "bspline": ("rigid", "affine", "bspline"),
}


@dataclass(frozen=True)
class Measured:
    """How alike two scans are under a transform."""

    metric: float
    overlap: float
    """Share of the fixed scan, or of its mask, that the moving one covers."""


class Search:
    """Stages of one registration, and how far they are."""

    def __init__(
        self,
        images: tuple[Any, Any],
        *,
        masks: tuple[Any, Any],
        metric: Metric,
        options: SearchOptions,
        progress: Progress,
        watch: Watch = unwatched,
    ) -> None:
        """Takes the fixed and the moving image, and their masks or None.

        Raises:
            OptionError: An option is out of range.
        """
        options.check()
        self._images = images
        self._masks = masks
        self._metric = metric
        self._options = options
        self._progress = progress
        self._watch = watch
        self._sitk = simpleitk()
        shortest = min(images[0].GetSize())
        self._shrinks = tuple(n for n in SHRINKS if n == 1 or shortest >= n * LEAST_AT_LEVEL)
        self._level_of = cache(lambda shrink: [_coarser(image, shrink) for image in images])
        self.curve: list[Level] = []

    # --- how alike the scans are ------------------------------------------------------------

    def measure(self, transform: Any) -> Measured:  # noqa: ANN401
        """Returns how alike the scans are under a transform, by all voxels of a coarser grid.

        Raises:
            RegistrationError: They do not overlap.
        """
        sitk = self._sitk
        size = self._images[0].GetSize()
        coarser = max(1, round((float(np.prod(size)) / MEASURED_VOXELS) ** (1.0 / 3.0)))
        fixed = sitk.Shrink(self._images[0], _factors(size, coarser))
        moving = self._images[1]
        method = self._method()
        method.SetInitialTransform(sitk.Transform(transform), inPlace=False)
        try:
            metric = float(method.MetricEvaluate(fixed, moving))
        except RuntimeError as error:
            raise self._apart(reason_of(error)) from None
        there = sitk.Image(moving.GetSize(), sitk.sitkUInt8) + 1
        there.CopyInformation(moving)
        covered = sitk.Resample(there, fixed, transform, sitk.sitkNearestNeighbor, 0.0)
        inside = sitk.GetArrayFromImage(covered) != 0
        if self._masks[0] is not None:
            inside = inside[sitk.GetArrayFromImage(mask_on(self._masks[0], fixed)) != 0]
        if not inside.any():
            # mean squares of nothing are no error to ITK
            raise self._apart("no voxel of one lies in the other")
        return Measured(metric, float(inside.mean()))

    def check(self, before: Measured, after: Measured) -> None:
        """Refuses an end that is worse than its start.

        Raises:
            RegistrationError: It is; the error has the curve.
        """
        scale = abs(before.metric)
        if self._metric == "mean-squares":
            scale = float(np.var(self._sitk.GetArrayViewFromImage(self._images[0])))
        worse = not after.metric <= before.metric + WORSE * scale
        away = after.overlap < LEAST_OVERLAP * before.overlap
        if not (worse or away):
            return
        why = "the scans did not become more alike" if worse else "the scans were moved apart"
        raise RegistrationError(
            f"{why} ({self._metric} {before.metric:.4g} before, {after.metric:.4g} after, less is "
            f"better; {before.overlap:.0%} and {after.overlap:.0%} covered; on the way: "
            f"{self._told()}); nothing was changed; allowed: scans of the same part, another start "
            f"({', '.join(STARTS)}), masks, or a simpler kind",
            self.curve,
        )

    def _apart(self, reason: str) -> RegistrationError:
        told = f"; on the way: {self._told()}" if self.curve else ""
        return RegistrationError(
            f"the scans do not overlap enough ({reason}{told}); nothing was changed; "
            f"allowed: scans of the same part, or another start ({', '.join(STARTS)})",
            self.curve,
        )

    def _told(self) -> str:
        """Returns the first, middle and last value of each level."""
        return "; ".join(
            f"{level.stage} /{level.shrink}: "
            + ", ".join(f"{value:.4g}" for value in _ends(level.values))
            for level in self.curve
        )

    # --- the search -------------------------------------------------------------------------

    def run(self, first: Any, kind: Kind) -> Any:  # noqa: ANN401
        """Returns the best transform of a kind near a first one, which may be affine already.

        Raises:
            RegistrationError: The scans do not overlap.
        """
        stages = STAGES[kind]
        if first.GetName() == "AffineTransform":
            # what it scales and shears would be lost
            stages = stages[1:]
        found = first
        for number, stage in enumerate(stages):
            search = self._bent if stage == "bspline" else self._straight
            found = search(found, stage, lambda done: (number + done) / len(stages))  # noqa: B023
        return found

    def _straight(self, first: Any, stage: Kind, share: Callable[[float], float]) -> Any:  # noqa: ANN401
        transform = self._sitk.Euler3DTransform(first) if stage == "rigid" else affine_of(first)
        most = self._options.iterations
        for number, shrink in enumerate(self._shrinks):
            level = self._level(stage, shrink, self._options.samples)
            method = self._sampled(level, self._options.seed)
            method.SetInitialTransform(transform, inPlace=True)
            step = shrink * min(self._images[0].GetSpacing())
            method.SetOptimizerAsRegularStepGradientDescent(
                learningRate=step,
                minStep=LAST_STEP * step,
                numberOfIterations=most,
                gradientMagnitudeTolerance=1e-8,
            )
            method.SetOptimizerScalesFromPhysicalShift()
            self._execute(
                method,
                level,
                lambda done: share((number + done / most) / len(self._shrinks)),  # noqa: B023
            )
        return transform

    def _bent(self, first: Any, stage: Kind, share: Callable[[float], float]) -> Any:  # noqa: ANN401
        """Returns an affine transform after one that bends; its knots get denser on each level."""
        sitk, options = self._sitk, self._options
        fixed, most = self._images[0], self._options.bent_iterations
        reach = np.multiply(fixed.GetSize(), fixed.GetSpacing())
        coarsest = options.knots * 2 ** (len(self._shrinks) - 1)
        bent = sitk.BSplineTransformInitializer(
            fixed, [max(1, round(length / coarsest)) for length in reach]
        )
        for number, shrink in enumerate(self._shrinks):
            # fewer knots leave time for more samples, and a search that begins well strays less
            finer = len(self._shrinks) - 1 - number
            level = self._level(stage, shrink, options.bent_samples * MORE_SAMPLES**finer)
            method = self._sampled(level, options.seed)
            method.SetMovingInitialTransform(first)
            denser = 2 if number > 0 else 1
            method.SetInitialTransformAsBSpline(bent, inPlace=True, scaleFactors=[denser])
            # its accuracy is relative to the parameters, which are lengths: the steps are counted
            method.SetOptimizerAsLBFGS2(solutionAccuracy=1e-9, numberOfIterations=most)
            self._execute(
                method,
                level,
                lambda done: share((number + done / most) / len(self._shrinks)),  # noqa: B023
            )
        # what was added last is applied first
        return sitk.CompositeTransform([first, bent])

    def _execute(self, method: Any, level: Level, share: Callable[[int], float]) -> None:  # noqa: ANN401
        """Runs a method on the grids of a level; ``share`` tells what is done after some steps."""
        raised: list[BaseException] = []
        name = f"{level.stage}, {level.shrink} times coarser" if level.shrink > 1 else level.stage

        def step() -> None:
            level.values.append(float(method.GetMetricValue()))
            try:
                self._watch(self.curve)
                self._progress(name, min(1.0, share(len(level.values))))
            except BaseException as error:
                raised.append(error)
                # not every optimizer can be stopped, but each ends with what is raised; ITK would
                # print it
                sys.excepthook = lambda *_: None
                raise

        method.AddCommand(self._sitk.sitkIterationEvent, step)
        shown = sys.excepthook
        try:
            method.Execute(*self._level_of(level.shrink))
        except RuntimeError as error:
            if raised:
                raise raised[0] from None
            raise self._apart(reason_of(error)) from None
        finally:
            sys.excepthook = shown

    def _level(self, stage: Kind, shrink: int, samples: int) -> Level:
        voxels = float(np.prod(self._level_of(shrink)[0].GetSize()))
        level = Level(stage, shrink, min(1.0, samples / voxels))
        self.curve.append(level)
        return level

    def _sampled(self, level: Level, seed: int) -> Any:  # noqa: ANN401
        method = self._method()
        method.SetMetricSamplingStrategy(method.RANDOM)
        method.SetMetricSamplingPercentagePerLevel([level.sampled], seed)
        return method

    def _method(self) -> Any:  # noqa: ANN401
        """Returns a method on the grids as they are given, with metric and masks."""
        method = self._sitk.ImageRegistrationMethod()
        if self._metric == "mutual-information":
            method.SetMetricAsMattesMutualInformation(self._options.bins)
        elif self._metric == "correlation":
            method.SetMetricAsCorrelation()
        else:
            method.SetMetricAsMeanSquares()
        fixed_mask, moving_mask = self._masks
        if fixed_mask is not None:
            method.SetMetricFixedMask(fixed_mask)
        if moving_mask is not None:
            method.SetMetricMovingMask(moving_mask)
        # gradients where they are asked for take less memory than gradients everywhere
        method.MetricUseFixedImageGradientFilterOff()
        method.MetricUseMovingImageGradientFilterOff()
        method.SetInterpolator(self._sitk.sitkLinear)
        return method


def _factors(size: tuple[int, ...], shrink: int) -> list[int]:
    return [max(1, min(shrink, length // LEAST_AT_LEVEL)) for length in size]


def _coarser(image: Any, shrink: int) -> Any:  # noqa: ANN401
    """Returns an image smoothed and on a coarser grid."""
    if shrink == 1:
        return image
    sitk = simpleitk()
    factors = _factors(image.GetSize(), shrink)
    widths = [
        BLUR * factor * step for factor, step in zip(factors, image.GetSpacing(), strict=True)
    ]
    return sitk.Shrink(sitk.SmoothingRecursiveGaussian(image, widths), factors)


def _ends(values: list[float]) -> list[float]:
    places = sorted({0, len(values) // 2, len(values) - 1}) if values else []
    return [values[place] for place in places]
