"""A scan on the grid of another one.

Scans are linear between voxels, with their lowest value outside, and none where a voxel without
one takes part. Label maps keep their labels: each voxel takes the nearest one, or the one that
most of its surroundings have.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.base.interpolation import INTERPOLATIONS, Interpolation, InterpolationChoice
from palpate.base.simpleitk import Transform, image_on, simpleitk
from palpate.volumes.label_like import MOST_LABELS, are_labels
from palpate.volumes.volume import Volume

__all__ = [
    "check_interpolation",
    "interpolation_for",
    "on_grid",
    "resampled",
]


def check_interpolation(given: str) -> None:
    """Refuses an interpolation that is not known.

    Raises:
        OptionError: It is not.
    """
    if given not in INTERPOLATIONS:
        raise OptionError(f"interpolation {given!r} given; allowed: {', '.join(INTERPOLATIONS)}")


def interpolation_for(moving: Volume, wanted: InterpolationChoice = "automatic") -> Interpolation:
    """Returns how a scan is interpolated: as wanted, or as its values ask for."""
    if wanted == "automatic":
        return "nearest" if are_labels(moving) else "linear"
    return wanted


def resampled(
    moving: Volume,
    fixed: Volume,
    transform: Transform,
    *,
    interpolation: InterpolationChoice = "automatic",
) -> Volume:
    """Returns a scan on the grid of another one.

    Args:
        moving: The scan.
        fixed: The other one.
        transform: From points of ``fixed`` to those of ``moving``, LPS [mm].
        interpolation: Between voxels; by default linear, and nearest for a label map, so that no
            labels appear that it does not have.

    Raises:
        OptionError: The interpolation is not known, or one by labels is asked for intensities.
    """
    check_interpolation(interpolation)
    chosen = interpolation_for(moving, interpolation)
    if chosen != "linear":
        return _with_own_values(moving, fixed, transform, by=chosen)
    if moving.exact is not None:
        low, _ = moving.range
        values = on_grid(moving, fixed, transform, array=moving.intensities(), outside=low)
        if moving.missing:
            none = np.isnan(moving.exact).astype(np.float32)
            values[on_grid(moving, fixed, transform, array=none, outside=0.0) > 0.0] = np.nan
        return _laid(values, fixed, slope=1.0, intercept=0.0, like=moving)
    laid = on_grid(moving, fixed, transform, array=moving.array, outside=_lowest(moving))
    return _laid(laid, fixed, slope=moving.slope, intercept=moving.intercept, like=moving)


def on_grid(
    moving: Volume,
    fixed: Volume,
    transform: Transform,
    *,
    array: NDArray[Any],
    outside: float,
    by: Interpolation = "linear",
) -> NDArray[Any]:
    """Returns an array on the grid of one scan, shape [z, y, x], on that of another one."""
    sitk = simpleitk()
    image, reference = image_on(moving, array), image_on(fixed, fixed.array)
    how = {
        "linear": sitk.sitkLinear,
        "nearest": sitk.sitkNearestNeighbor,
        "labels": sitk.sitkLabelLinear,
    }[by]
    laid = sitk.Resample(image, reference, transform, how, outside, image.GetPixelID())
    values: NDArray[Any] = sitk.GetArrayFromImage(laid)
    return values


def _with_own_values(
    moving: Volume, fixed: Volume, transform: Transform, *, by: Interpolation
) -> Volume:
    """Returns a scan with no values but its own."""
    if by == "labels" and (count := len(np.unique(moving.values()))) > MOST_LABELS + 1:
        raise OptionError(
            f"interpolation by labels of {count} values given; allowed: a label map of at most "
            f"{MOST_LABELS} labels, or linear"
        )
    if moving.exact is not None:
        low, _ = moving.range
        laid = on_grid(moving, fixed, transform, array=moving.exact, outside=low, by=by)
        return _laid(laid, fixed, slope=1.0, intercept=0.0, like=moving)
    laid = on_grid(moving, fixed, transform, array=moving.array, outside=_lowest(moving), by=by)
    return _laid(laid, fixed, slope=moving.slope, intercept=moving.intercept, like=moving)


def _lowest(moving: Volume) -> float:
    """Returns the stored number of the lowest value."""
    return float(moving.array.min() if moving.slope > 0.0 else moving.array.max())


def _laid(
    values: NDArray[Any], fixed: Volume, *, slope: float, intercept: float, like: Volume
) -> Volume:
    return Volume(
        values,
        spacing=fixed.spacing,
        origin=fixed.origin,
        direction=fixed.direction,
        slope=slope,
        intercept=intercept,
        traits=like.traits,
    )
