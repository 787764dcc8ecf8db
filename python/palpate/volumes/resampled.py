"""A scan on the grid of another one.

Linear between voxels, with the scan's lowest value outside of it; none where a voxel without one
takes part.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.simpleitk import Transform, image_on, simpleitk
from palpate.volumes.volume import Volume

__all__ = ["resampled"]


def resampled(moving: Volume, fixed: Volume, transform: Transform) -> Volume:
    """Returns a scan on the grid of another one.

    Args:
        moving: The scan.
        fixed: The other one.
        transform: From points of ``fixed`` to those of ``moving``, LPS [mm].
    """
    if moving.exact is not None:
        low, _ = moving.range
        values = _on_grid(moving, fixed, transform, array=moving.intensities(), outside=low)
        if moving.missing:
            none = np.isnan(moving.exact).astype(np.float32)
            values[_on_grid(moving, fixed, transform, array=none, outside=0.0) > 0.0] = np.nan
        return _laid(values, fixed, slope=1.0, intercept=0.0, like=moving)
    stored = moving.array
    lowest = float(stored.min() if moving.slope > 0.0 else stored.max())
    laid = _on_grid(moving, fixed, transform, array=stored, outside=lowest)
    return _laid(laid, fixed, slope=moving.slope, intercept=moving.intercept, like=moving)


def _on_grid(
    moving: Volume, fixed: Volume, transform: Transform, *, array: NDArray[Any], outside: float
) -> NDArray[Any]:
    sitk = simpleitk()
    image, reference = image_on(moving, array), image_on(fixed, fixed.array)
    kind = image.GetPixelID()
    laid = sitk.Resample(image, reference, transform, sitk.sitkLinear, outside, kind)
    values: NDArray[Any] = sitk.GetArrayFromImage(laid)
    return values


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
