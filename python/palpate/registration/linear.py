"""The search for a rigid or an affine transform by SimpleITK, from coarse to fine grids."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import numpy as np

from palpate.base.simpleitk import reason_of, simpleitk
from palpate.registration.image_pair import Compared
from palpate.registration.options import Kind, Level, SearchOptions
from palpate.registration.search_history import SearchHistory
from palpate.registration.start import affine_of

__all__ = ["search_linear"]

SHRINKS = (4, 2, 1)
"""How many times coarser each level is than the scan."""
LAST_STEP = 0.005
"""Step at which a search ends, as a share of the first, which is a voxel of the level."""


def search_linear(
    compared: Compared,
    first: Any,  # noqa: ANN401  # SimpleITK has no types
    stage: Kind,
    *,
    options: SearchOptions,
    history: SearchHistory,
    share: Callable[[float], float],
) -> Any:  # noqa: ANN401
    """Returns the best transform of a stage near a first one.

    ``share`` maps the share of this stage that is done to that of the whole search, both 0..1.

    Raises:
        RegistrationError: The scans do not overlap.
    """
    sitk = simpleitk()
    transform = sitk.Euler3DTransform(first) if stage == "rigid" else affine_of(first)
    most = options.iterations
    shrinks = compared.shrinks(SHRINKS)
    for number, shrink in enumerate(shrinks):
        voxels = float(np.prod(compared.level(shrink)[0].GetSize()))
        level = history.begin(stage, shrink, options.samples / voxels)
        method = compared.method()
        method.SetMetricSamplingStrategy(method.RANDOM)
        method.SetMetricSamplingPercentagePerLevel([level.sampled], options.seed)
        method.SetInitialTransform(transform, inPlace=True)
        step = shrink * min(compared.images[0].GetSpacing())
        method.SetOptimizerAsRegularStepGradientDescent(
            learningRate=step,
            minStep=LAST_STEP * step,
            numberOfIterations=most,
            gradientMagnitudeTolerance=1e-8,
        )
        method.SetOptimizerScalesFromPhysicalShift()

        def done(steps: int, number: int = number) -> float:
            return share((number + steps / most) / len(shrinks))

        _execute(method, compared, level, history=history, share=done)
    return transform


def _execute(
    method: Any,  # noqa: ANN401
    compared: Compared,
    level: Level,
    *,
    history: SearchHistory,
    share: Callable[[int], float],
) -> None:
    """Runs a method on the grids of a level; ``share`` maps steps to the share that is done."""
    raised: list[BaseException] = []

    def step() -> None:
        try:
            history.step(level, float(method.GetMetricValue()), share(len(level.values) + 1))
        except BaseException as error:
            raised.append(error)
            # the optimizer ends with what is raised; ITK would print it
            sys.excepthook = lambda *_: None
            raise

    method.AddCommand(simpleitk().sitkIterationEvent, step)
    shown = sys.excepthook
    try:
        method.Execute(*compared.level(level.shrink))
    except RuntimeError as error:
        if raised:
            raise raised[0] from None
        raise history.no_overlap(reason_of(error)) from None
    finally:
        sys.excepthook = shown
