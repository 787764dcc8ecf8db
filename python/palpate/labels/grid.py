"""Masks on grids of their own, laid on the grid of a scan voxel by voxel.

The two must be the same grid but for its extent, and for axes that run the other way or come in
another order: then nothing is interpolated and nothing lost. Else each voxel of the scan takes the
value at its centre, where a person has asked for that.

Frames: see ``volumes/volume.py``; arrays are [z, y, x].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate.base.errors import OptionError
from palpate.volumes.appearance import Colour
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume

__all__ = [
    "RESAMPLED",
    "Colour",
    "Label",
    "Labels",
    "Place",
    "Placement",
    "Resampling",
    "patient_from_grid",
    "placement",
    "told_of",
]

"""sRGB, each 0..1."""

OFF = 0.25
"""By how much of a voxel a corner may lie off the scan's grid, and be moved onto it."""
ROUNDED = 0.01
"""Up to which part of a voxel that is not told: headers are rounded."""

RESAMPLED = "it lies on another grid: each voxel of the scan takes what is at its centre"
"""Said where it is so."""
MOVED = "its voxels lie up to {:.2g} mm off those of the scan: they were moved onto them"
"""Said where they lie farther off than headers are rounded."""


@dataclass(frozen=True)
class Label:
    """A segment that a file holds, under its name there."""

    segment: Segment
    colour: Colour | None = None


@dataclass(frozen=True)
class Labels:
    """All segments of a file or folder."""

    labels: tuple[Label, ...]
    warnings: tuple[str, ...] = ()
    """Sentences on what was changed or left out."""


@dataclass(frozen=True)
class Placement:
    """How an array [z, y, x] comes to lie in the scan's."""

    order: tuple[int, int, int]
    """Axes of the array that become the scan's z, y, x."""
    turned: tuple[int, ...]
    """Of those, the ones that run the other way."""
    start: tuple[int, int, int]
    """Where it begins in the scan, along z, y, x."""
    moved: float = 0.0
    """How far its corners come to lie from where its file has them, at most [mm]; 0 where that is
    rounding."""

    def lay(self, values: NDArray[Any], scan: NDArray[Any]) -> NDArray[Any]:
        """Adds values to an array of the scan's shape where they are not 0.

        Returns those of them that lie outside the scan, in a row.
        """
        laid = np.flip(values.transpose(self.order), self.turned)
        ends = [begin + length for begin, length in zip(self.start, laid.shape, strict=True)]
        inside = tuple(
            slice(max(0, -begin), max(0, length - max(0, end - room)))
            for begin, end, length, room in zip(
                self.start, ends, laid.shape, scan.shape, strict=True
            )
        )
        there = tuple(
            slice(max(0, begin), max(0, min(end, room)))
            for begin, end, room in zip(self.start, ends, scan.shape, strict=True)
        )
        kept = laid[inside]
        np.copyto(scan[there], kept, where=kept != 0)
        if kept.shape == laid.shape:
            return laid[:0].ravel()
        beyond = laid != 0
        beyond[inside] = False
        lost: NDArray[Any] = laid[beyond]
        return lost


@dataclass(frozen=True)
class Resampling:
    """How an array [z, y, x] on any grid comes to lie in the scan's: nearest neighbours."""

    mask_from_scan: NDArray[Any]
    """From the scan's grid to the array's, edges of voxels at whole numbers, shape [4, 4]."""

    def lay(self, values: NDArray[Any], scan: NDArray[Any]) -> NDArray[Any]:
        """Adds values to an array of the scan's shape where they are not 0.

        Returns those of them that have their centres outside the scan, in a row.
        """
        boxes = self._boxes(values.shape, scan.shape)
        x, y = (np.arange(box.start, box.stop) + 0.5 for box in boxes[:2])
        for z in range(boxes[2].start, boxes[2].stop):
            centres = _affine(self.mask_from_scan, x[None, :], y[:, None], z + 0.5)
            there, index = _inside(centres, values.shape)
            found = values[index]
            slab = scan[z, boxes[1], boxes[0]]
            slab[there] = np.where(found != 0, found, slab[there])
        return self._outside(values, scan.shape)

    def _boxes(self, shape: Sequence[int], scan: Sequence[int]) -> list[slice]:
        """Returns where the array reaches in the scan, along x, y, z."""
        ends = np.meshgrid(*([0.0, float(length)] for length in shape[::-1]))
        lies = _affine(np.linalg.inv(self.mask_from_scan), *ends)
        return [
            slice(*(int(end) for end in np.clip((axis.min() - 1, axis.max() + 1), 0, length)))
            for axis, length in zip(lies, scan[::-1], strict=True)
        ]

    def _outside(self, values: NDArray[Any], scan: Sequence[int]) -> NDArray[Any]:
        scan_from_mask = np.linalg.inv(self.mask_from_scan)
        lost = []
        for z, slab in enumerate(values):
            y, x = np.nonzero(slab)
            centres = _affine(scan_from_mask, x + 0.5, y + 0.5, z + 0.5)
            lost.append(slab[y, x][~_inside(centres, scan)[0]])
        return np.concatenate(lost)


Place = Placement | Resampling


def _affine(matrix: NDArray[Any], *point: NDArray[Any] | float) -> list[NDArray[np.float64]]:
    """Returns the coordinates of points, each an array of its own, after a matrix [4, 4]."""
    return [
        np.asarray(sum(part * axis for part, axis in zip(row[:3], point, strict=True)) + row[3])
        for row in matrix[:3]
    ]


def _inside(
    point: Sequence[NDArray[Any]], shape: Sequence[int]
) -> tuple[NDArray[np.bool_], tuple[NDArray[np.intp], ...]]:
    """Says which points x, y, z lie in an array [z, y, x], and in which of its voxels those do."""
    voxel = [np.floor(axis).astype(np.intp) for axis in point[::-1]]
    there = np.logical_and.reduce(
        [(axis >= 0) & (axis < length) for axis, length in zip(voxel, shape, strict=True)]
    )
    return there, tuple(axis[there] for axis in voxel)


def told_of(places: Sequence[Place]) -> list[str]:
    """Returns what is to be said of how arrays were laid on the scan's grid."""
    if any(isinstance(place, Resampling) for place in places):
        return [RESAMPLED]
    moved = max((place.moved for place in places if isinstance(place, Placement)), default=0.0)
    return [MOVED.format(moved)] if moved > 0.0 else []


def patient_from_grid(
    spacing: ArrayLike, origin: ArrayLike, direction: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Returns the matrix of a grid whose first voxel's centre is the origin, shape [4, 4]."""
    matrix = np.eye(4)
    matrix[:3, :3] = direction * np.asarray(spacing)
    matrix[:3, 3] = np.asarray(origin) - matrix[:3, :3] @ (0.5, 0.5, 0.5)
    return matrix


def placement(
    what: str,
    patient_from_mask: NDArray[np.float64],
    shape: Sequence[int],
    *,
    volume: Volume,
    resample: bool = False,
) -> Place:
    """Finds how an array on a grid lies in a scan.

    Args:
        what: What it is, for the message.
        patient_from_mask: Of its grid, shape [4, 4] [mm].
        shape: Of the array, [z, y, x].
        volume: The scan.
        resample: Whether it may lie on any grid.

    Raises:
        OptionError: It does not lie voxel on voxel, and is not to be resampled.
    """
    scan_from_mask = np.linalg.inv(volume.patient_from_grid) @ patient_from_mask
    turn = np.rint(scan_from_mask[:3, :3])
    is_turn = np.array_equal(np.abs(turn) @ np.ones(3), np.ones(3)) and np.array_equal(
        np.ones(3) @ np.abs(turn), np.ones(3)
    )
    shift = np.rint(scan_from_mask[:3, 3])
    ends = np.array(np.meshgrid(*([0.0, length] for length in shape[::-1]))).reshape(3, -1)
    meant = turn @ ends + shift[:, None]
    lies = scan_from_mask[:3, :3] @ ends + scan_from_mask[:3, 3:]
    off = meant - lies
    if not is_turn or np.abs(off).max() > OFF:
        if resample:
            return Resampling(np.linalg.inv(scan_from_mask))
        size = " x ".join(map(str, volume.dimensions))
        raise OptionError(
            f"{what} lies on another grid than the scan; allowed: the scan's {size} voxels, or "
            "others with `resample=True`"
        )
    # from x, y, z to the order of arrays
    axes = [int(np.flatnonzero(row)[0]) for row in turn[::-1]]
    turned = tuple(axis for axis, row in enumerate(turn[::-1]) if row.sum() < 0.0)
    start = meant.min(axis=1)[::-1].astype(int)
    far = np.linalg.norm(off * np.array(volume.spacing)[:, None], axis=0).max()
    return Placement(
        order=(2 - axes[0], 2 - axes[1], 2 - axes[2]),
        turned=turned,
        start=(int(start[0]), int(start[1]), int(start[2])),
        moved=float(far) if np.abs(off).max() > ROUNDED else 0.0,
    )
