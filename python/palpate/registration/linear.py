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

__all__ = ["SHRINKS", "search_linear", "step_limit"]

SHRINKS = (4, 2, 1)
"""How many times coarser each level is than the scan."""
STEEP = np.radians(50.0)
"""Angle about x from which on another order of turns is used."""
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
    near: bool = False,
) -> Any:  # noqa: ANN401
    """Returns the best transform of a stage near a first one.

    Where the first one is ``near`` its place, no step moves points farther than a voxel. ``share``
    maps the share of this stage that is done to that of the whole search, both 0..1.

    Raises:
        RegistrationError: The scans do not overlap.
    """
    transform = _by_angles(first) if stage == "rigid" else affine_of(first)
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
            **(step_limit(method, step) if near else {}),
        )
        method.SetOptimizerScalesFromPhysicalShift()

        def done(steps: int, number: int = number) -> float:
            return share((number + steps / most) / len(shrinks))

        _execute(method, compared, level, history=history, share=done)
    return _in_usual_order(transform) if stage == "rigid" else transform


def step_limit(method: Any, longest: float) -> dict[str, Any]:  # noqa: ANN401
    """Returns what keeps steps of the optimizer short, by how far they move points [mm].

    Else the first one is as long in the units of the angles, and may leave a good place.
    """
    return {
        "estimateLearningRate": method.EachIteration,
        "maximumStepSizeInPhysicalUnits": longest,
    }


def _by_angles(first: Any) -> Any:  # noqa: ANN401
    """Returns a rigid transform by angles about the axes, in an order that does not lock here.

    In ITK's usual order two of them turn about one axis where the first is a right angle.
    """
    transform = simpleitk().Euler3DTransform(first)
    if abs(transform.GetAngleX()) <= STEEP:
        return transform
    return _reordered(transform, z_y_x=True)


def _in_usual_order(transform: Any) -> Any:  # noqa: ANN401
    return _reordered(transform, z_y_x=False) if transform.GetComputeZYX() else transform


def _reordered(transform: Any, *, z_y_x: bool) -> Any:  # noqa: ANN401
    other = simpleitk().Euler3DTransform()
    other.SetComputeZYX(z_y_x)
    other.SetCenter(transform.GetCenter())
    other.SetMatrix(transform.GetMatrix(), 1e-6)
    other.SetTranslation(transform.GetTranslation())
    return other


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
