"""Where the search for a transform begins: a first guess.

Frame: LPS [mm]; a transform takes points of the fixed image to the moving one. Images and
transforms are SimpleITK's.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from palpate.base.simpleitk import simpleitk
from palpate.registration.options import Points, Start

__all__ = ["affine_of", "first_guess", "guess_of_matrix", "mask_on"]

RIGHT_ANGLED = 1e-3
"""By how much axes may be longer or shorter in a turn that was written with few digits."""

Pair = tuple[Any, Any]
"""Images, or masks, of the fixed and of the moving scan."""


def first_guess(
    images: Pair, *, masks: Pair, start: Start, landmarks: tuple[Points, Points] | None
) -> Any:  # noqa: ANN401  # SimpleITK has no types
    """Returns a first turn and shift; masks are images or None."""
    sitk = simpleitk()
    rigid = sitk.Euler3DTransform()
    if start in ("centre", "moments"):
        by = sitk.CenteredTransformInitializerFilter
        mode = by.GEOMETRY if start == "centre" else by.MOMENTS
        if start == "moments":
            fixed, moving = map(_above_lowest, images, masks)
            images = fixed, moving
        return sitk.Euler3DTransform(sitk.CenteredTransformInitializer(*images, rigid, mode))
    rigid.SetCenter(_middle(images[0]))
    if landmarks is None or start != "landmarks":
        return rigid
    fitted = sitk.VersorRigid3DTransform(
        sitk.LandmarkBasedTransformInitializer(
            sitk.VersorRigid3DTransform(), *(points.ravel().tolist() for points in landmarks)
        )
    )
    _take_over(rigid, np.reshape(fitted.GetMatrix(), (3, 3)), fitted.TransformPoint)
    return rigid


def guess_of_matrix(fixed: Any, matrix: Points, *, rigid: bool) -> Any:  # noqa: ANN401
    """Returns a matrix [4, 4] as a transform: a turn and a shift where it is one, else affine.

    Where it has to be ``rigid``, it is the turn next to the matrix, which takes the middle of the
    fixed image to the same place.
    """
    sitk = simpleitk()
    left, lengths, right = np.linalg.svd(matrix[:3, :3])

    def there(point: Any) -> Points:  # noqa: ANN401
        place: Points = matrix[:3, :3] @ np.asarray(point) + matrix[:3, 3]
        return place

    if rigid or np.abs(lengths - 1.0).max() < RIGHT_ANGLED:
        guess, linear = sitk.Euler3DTransform(), left @ right
    else:
        guess, linear = sitk.AffineTransform(3), matrix[:3, :3]
    guess.SetCenter(_middle(fixed))
    _take_over(guess, linear, there)
    return guess


def affine_of(first: Any) -> Any:  # noqa: ANN401
    """Returns a turn and a shift as an affine transform, or a copy of one."""
    affine = simpleitk().AffineTransform(3)
    affine.SetCenter(first.GetCenter())
    affine.SetMatrix(first.GetMatrix())
    affine.SetTranslation(first.GetTranslation())
    return affine


def mask_on(mask: Any, grid: Any) -> Any:  # noqa: ANN401
    """Returns a mask on the grid of an image."""
    sitk = simpleitk()
    return sitk.Resample(mask, grid, sitk.Transform(), sitk.sitkNearestNeighbor, 0.0)


def _take_over(guess: Any, linear: Points, there: Any) -> None:  # noqa: ANN401
    """Has a transform turn like ``linear``, and take its centre where ``there`` takes it."""
    centre = guess.GetCenter()
    given = linear.ravel().tolist()
    if guess.GetName() == "AffineTransform":
        guess.SetMatrix(given)
    else:
        guess.SetMatrix(given, 1e-6)
    guess.SetTranslation(np.subtract(there(centre), centre).tolist())


def _middle(image: Any) -> tuple[float, ...]:  # noqa: ANN401
    middle: tuple[float, ...] = image.TransformContinuousIndexToPhysicalPoint(
        [(n - 1) / 2.0 for n in image.GetSize()]
    )
    return middle


def _above_lowest(image: Any, mask: Any) -> Any:  # noqa: ANN401
    """Returns values from the lowest on, 0 outside of a mask."""
    sitk = simpleitk()
    lifted = image - float(sitk.GetArrayViewFromImage(image).min())
    return (
        lifted if mask is None else lifted * sitk.Cast(mask_on(mask, image) != 0, sitk.sitkFloat32)
    )
