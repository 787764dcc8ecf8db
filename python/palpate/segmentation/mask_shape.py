"""The shape of a mask: islands, holes, margins, smoothing, shells.

Masks are bool, [z, y, x]; spacing is along x, y, z [mm]. What lies beyond a mask's border counts as
what lies at it, so that a body that the scan cuts off is not rounded or eaten from there. Distances
are between centres of voxels: a margin smaller than a voxel's side changes nothing along that side.
What a ball does is the same everywhere and to all sides: opening and closing done twice do no more.
Work is done in the box of the mask, with as much around it as the change can reach.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.simpleitk import simpleitk
from palpate.segmentation.lengths_in_voxels import nearest_voxels, whole_voxels, within

__all__ = [
    "Mask",
    "box_of",
    "closed",
    "distance_to",
    "drop_small",
    "filled",
    "hollow",
    "island_numbers",
    "islands",
    "keep_largest",
    "margin",
    "median",
    "opened",
    "shares",
    "smooth",
    "squared_distance_to",
    "touches_border",
]

Mask = NDArray[np.bool_]
Box = tuple[slice, slice, slice]

SLAB = 32
"""Layers at least that distances are worked out in at once."""
MOST_THREADS = 8
"""That do so side by side."""

SMALLEST_PART = 0.01
"""Of the weight of a Gaussian that may be cut off."""


def box_of(mask: Mask, around: float = 0.0, spacing: Sequence[float] = (1.0, 1.0, 1.0)) -> Box:
    """Returns the box of a mask with ``around`` [mm] on each side, cut at the border.

    One voxel more is left free, so that what is outside of the mask is seen to be.
    """
    box = []
    for axis, edge in enumerate(reversed(spacing)):
        others = tuple(other for other in range(3) if other != axis)
        solid = np.flatnonzero(mask.any(axis=others))
        if solid.size == 0:
            return slice(0, 0), slice(0, 0), slice(0, 0)
        room = int(np.ceil(around / edge)) + 1
        box.append(slice(max(0, int(solid[0]) - room), int(solid[-1]) + 1 + room))
    return box[0], box[1], box[2]


def squared_distance_to(mask: Mask, spacing: Sequence[float]) -> NDArray[np.float32]:
    """Returns the squares of distances between the centre of each voxel and the nearest in a mask.

    They are 0 in the mask, and infinite everywhere where it is empty [mm²]. Each is made of whole
    steps along the axes, so that it is the same wherever the two voxels lie. Source: Maurer, Qi and
    Raghavan, "A linear time algorithm for computing exact Euclidean distance transforms", 2003, as
    SciPy does it in double precision.
    """
    from scipy.ndimage import distance_transform_edt

    if not mask.any():
        return np.full(mask.shape, np.inf, np.float32)
    sides = tuple(reversed(spacing))
    nearest = distance_transform_edt(
        ~mask, sampling=sides, return_distances=False, return_indices=True
    )
    squared = np.zeros(mask.shape, np.float32)
    places = np.ogrid[tuple(map(slice, mask.shape))]
    for there, here, side in zip(nearest, places, sides, strict=True):
        steps = np.subtract(there, here, out=there)
        squares = (np.arange(here.size) * side) ** 2
        squared += squares.astype(np.float32)[np.abs(steps, out=steps)]
    return squared


def distance_to(mask: Mask, spacing: Sequence[float]) -> NDArray[np.float32]:
    """Returns the distances of which ``squared_distance_to`` returns the squares [mm]."""
    squared = squared_distance_to(mask, spacing)
    return np.sqrt(squared, out=squared)


def margin(mask: Mask, spacing: Sequence[float], by: float) -> Mask:
    """Moves the border of a mask outward by a distance, or inward where it is below 0 [mm]."""
    if by >= 0.0:
        return _in_box(mask, lambda part: _reached(part, spacing, by), around=by, spacing=spacing)
    return _in_box(mask, lambda part: ~_reached(~part, spacing, -by))


def opened(mask: Mask, spacing: Sequence[float], radius: float) -> Mask:
    """Takes away what a ball does not fit into: bridges and horns [mm]."""
    return margin(margin(mask, spacing, -radius), spacing, radius)


def closed(mask: Mask, spacing: Sequence[float], radius: float) -> Mask:
    """Fills what a ball outside does not fit into: gaps and dents [mm]."""

    def work(part: Mask) -> Mask:
        grown = _reached(part, spacing, radius)
        return ~_reached(~grown, spacing, radius)

    return _in_box(mask, work, around=2.0 * radius, spacing=spacing)


def hollow(mask: Mask, spacing: Sequence[float], thickness: float) -> Mask:
    """Returns a shell inside of the mask's border, or outside where it is below 0 [mm].

    It is a voxel thick at least along each axis, so that no way over faces of voxels leads through
    it. Where the mask reaches the border of the grid the shell is open.
    """
    at_most = [min(side, abs(thickness)) for side in spacing]
    moved = margin(mask, at_most, -thickness)
    return mask & ~moved if thickness >= 0.0 else moved & ~mask


def smooth(mask: Mask, spacing: Sequence[float], deviation: float) -> Mask:
    """Keeps what is more than half solid under a Gaussian of a standard deviation [mm]."""

    def work(part: Mask) -> Mask:
        solid: Mask = shares(part, spacing, deviation) > 0.5
        return solid

    return _in_box(mask, work, around=3.0 * deviation, spacing=spacing)


def shares(mask: Mask, spacing: Sequence[float], deviation: float) -> NDArray[np.float32]:
    """Returns how solid each voxel is under a Gaussian of a standard deviation [mm], 0 to 1."""
    sitk = simpleitk()
    blurred: NDArray[np.float32] = _array(
        sitk.DiscreteGaussian(
            sitk.Cast(_image(mask, spacing), sitk.sitkFloat32),
            variance=deviation**2,
            maximumKernelWidth=512,
            maximumError=SMALLEST_PART,
            useImageSpacing=True,
        )
    )
    return blurred


def median(mask: Mask, spacing: Sequence[float], radius: float) -> Mask:
    """Keeps what is more than half solid in the box of a half edge around each voxel [mm].

    That is the median of a mask. The half edge is rounded to whole voxels along each axis.
    """
    voxels = [nearest_voxels(radius, edge) for edge in spacing]

    def work(part: Mask) -> Mask:
        sitk = simpleitk()
        shares = sitk.BoxMean(sitk.Cast(_image(part, spacing), sitk.sitkFloat32), voxels)
        solid: Mask = _array(shares) > 0.5
        return solid

    return _in_box(mask, work, around=radius + max(spacing), spacing=spacing)


def filled(mask: Mask) -> Mask:
    """Fills what the mask encloses, so that no way over faces of voxels leads out."""

    def work(part: Mask) -> Mask:
        sitk = simpleitk()
        solid: Mask = _array(sitk.BinaryFillhole(_image(part), fullyConnected=False)) != 0
        return solid

    return _in_box(mask, work)


def keep_largest(mask: Mask, count: int = 1) -> Mask:
    """Keeps the largest islands: parts that hang together over faces of voxels."""
    return _in_box(mask, lambda part: _islands(part, 0)[0] - 1 < count)


def drop_small(mask: Mask, voxels: int) -> Mask:
    """Keeps islands of so many voxels at least."""
    return _in_box(mask, lambda part: _islands(part, voxels)[1])


def touches_border(mask: Mask) -> bool:
    """Returns whether a mask has voxels at the border of its grid."""
    return any(bool(mask.take(end, axis).any()) for axis in range(3) for end in (0, -1))


def islands(mask: Mask) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Numbers parts that hang together over faces of voxels, the largest first, from 1 on.

    Returns:
        The number of each voxel, 0 outside of the mask, and how many voxels each number has.
    """
    sitk = simpleitk()
    labels = sitk.ConnectedComponent(_image(mask), False)  # noqa: FBT003  # over faces
    numbers = _array(sitk.RelabelComponent(labels)).astype(np.int64)
    return numbers, np.bincount(numbers.ravel())


def island_numbers(mask: Mask) -> tuple[NDArray[np.uint32], NDArray[np.int64]]:
    """Numbers islands as ``islands`` does, in the memory that their box takes beside the answer.

    Returns:
        The number of each voxel, 0 outside of the mask, and how many voxels each island has.
    """
    numbers = np.zeros(mask.shape, np.uint32)
    box = box_of(mask, 0.0, (1.0, 1.0, 1.0))
    if not mask[box].size:
        return numbers, np.zeros(0, np.int64)
    part, there = _islands(mask[box], 0)
    numbers[box] = np.where(there, part, 0)
    return numbers, np.bincount(part[there].ravel())[1:]


def _islands(mask: Mask, least: int) -> tuple[NDArray[np.uint32], Mask]:
    """Numbers islands from 1, the largest first, and says where there is one.

    Outside of all islands the number is the largest possible.
    """
    sitk = simpleitk()
    labels = sitk.ConnectedComponent(_image(mask), False)  # noqa: FBT003  # over faces
    numbers = _array(sitk.RelabelComponent(labels, least)).astype(np.uint32)
    there = numbers != 0
    numbers[~there] = np.iinfo(np.uint32).max
    return numbers, there


def _reached(mask: Mask, spacing: Sequence[float], length: float) -> Mask:
    """Returns which voxels are at most a length from those of a mask [mm].

    Slabs with as much around them as that reaches are worked on side by side, in the memory that
    they take.
    """
    around = whole_voxels(length, spacing[2])
    thick = max(SLAB, 2 * around)
    reached = np.empty_like(mask)

    def work(first: int) -> None:
        low = max(0, first - around)
        slab = mask[low : first + thick + around]
        near = within(squared_distance_to(slab, spacing), length)
        reached[first : first + thick] = near[first - low :][:thick]

    with ThreadPoolExecutor(min(MOST_THREADS, os.cpu_count() or 1)) as pool:
        list(pool.map(work, range(0, len(mask), thick)))
    return reached


def _in_box(
    mask: Mask,
    work: Callable[[Mask], Mask],
    *,
    around: float = 0.0,
    spacing: Sequence[float] = (1.0, 1.0, 1.0),
) -> Mask:
    """Works on the part of a mask that is not empty, with so much around it [mm]."""
    changed = np.zeros_like(mask)
    box = box_of(mask, around, spacing)
    part = mask[box]
    if part.size:
        changed[box] = work(part)
    return changed


def _image(mask: Mask, spacing: Sequence[float] = (1.0, 1.0, 1.0)) -> object:
    image = simpleitk().GetImageFromArray(mask.astype(np.uint8))
    image.SetSpacing([float(edge) for edge in spacing])
    return image


def _array(image: object) -> NDArray[Any]:
    array: NDArray[Any] = simpleitk().GetArrayFromImage(image)
    return array
