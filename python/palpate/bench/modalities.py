"""``palpate bench register``: registration of CT and MR by mutual information.

There is no such pair among the data sets, so a stand-in for MR is made from a CT of a head: its
values go through a map that is not monotonic (air and bone are dark, fat is bright, soft tissue
lies between), are blurred, multiplied by an uneven field and get noise, on a grid of their own that
is rotated, shifted and, for an affine transform, scaled and sheared. The true transform is known,
so the error is that of the eight corners of the fixed scan, from several starts with a given error
of translation and rotation. Correlation, which assumes a linear relation of values, is compared.

Frames: LPS [mm]; a matrix maps points of the CT to the stand-in, shape [4, 4].
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from palpate.base.progress import Progress, silent
from palpate.base.simpleitk import image_on, simpleitk
from palpate.bench.goals.registration import METRICS, MODALITY_ROWS, STARTS, modality_case
from palpate.bench.report import Row, row_of
from palpate.io.reading import read
from palpate.registration.options import Kind, Metric, RegistrationError, SearchOptions
from palpate.registration.registration import register
from palpate.volumes.volume import Volume, VolumeTraits

__all__ = ["Apart", "Pair", "apart_from", "coarser", "head_of", "like_mr", "measure_modalities"]

Points = NDArray[np.float64]

TISSUES = (
    # HU, brightness: air, fat, water, soft tissue, bone
    *((-1000.0, 0.0), (-250.0, 20.0), (-120.0, 850.0), (-40.0, 900.0)),
    *((0.0, 350.0), (30.0, 480.0), (70.0, 560.0)),
    *((200.0, 240.0), (500.0, 60.0), (3000.0, 20.0)),
)
BLUR = 0.8
"""Standard deviation [mm]."""
UNEVEN = 0.35
"""Largest deviation of the field from its mean, about."""
NOISE = 30.0
"""Standard deviation of the noise of both channels, of whose vector the length is taken."""
SPACING = (1.9, 1.9, 3.1)
"""Spacing of the stand-in [mm]."""
DIRECTIONS = 4
"""Number of starts with the same error of translation and rotation, in different directions."""


def _turned(degrees: float, axis: Sequence[float]) -> Points:
    """Returns a rotation about an axis, shape [3, 3] (Rodrigues)."""
    x, y, z = np.asarray(axis, np.float64) / np.linalg.norm(axis)
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    angle = np.radians(degrees)
    turn: Points = np.eye(3) + np.sin(angle) * across + (1.0 - np.cos(angle)) * across @ across
    return turn


TURN, SHIFT = _turned(9.0, (1.0, -2.0, 3.0)), np.array([11.0, -7.0, 5.0])
"""Rotation about the middle of the CT, and displacement of that [mm]."""
SCALED = np.array([[1.04, 0.03, 0.0], [0.0, 0.96, 0.02], [0.0, 0.0, 1.03]])

TRUTHS: dict[Kind, Points] = {"rigid": TURN, "affine": TURN @ SCALED}


@dataclass(frozen=True)
class Pair:
    """A CT scan, and a stand-in for MR."""

    fixed: Volume
    moving: Volume
    matrix: Points
    """True transform from the fixed scan to the moving one."""


@dataclass(frozen=True)
class Apart:
    """Largest error of the corners of the fixed scan [mm]."""

    before: float
    after: float


def like_mr(ct: Volume, kind: Kind, *, seed: int = 1) -> Pair:
    """Returns a scan [HU] and a stand-in for MR of the same head, displaced."""
    sitk = simpleitk()
    middle = _middle(ct)
    matrix = _about(middle, TRUTHS[kind], SHIFT)
    values = ct.array.astype(np.float32) * np.float32(ct.slope) + np.float32(ct.intercept)
    smooth = sitk.SmoothingRecursiveGaussian(image_on(ct, values), BLUR)
    hu, brightness = np.transpose(TISSUES)
    seen = np.interp(sitk.GetArrayFromImage(smooth), hu, brightness).astype(np.float32)
    size = np.ceil(np.multiply(ct.dimensions, ct.spacing) / SPACING).astype(int)
    back = sitk.AffineTransform(3)
    inverse = np.linalg.inv(matrix)
    back.SetMatrix(inverse[:3, :3].ravel().tolist())
    back.SetTranslation(inverse[:3, 3].tolist())
    origin = middle + SHIFT - 0.5 * (size - 1) * SPACING
    there = sitk.Resample(
        image_on(ct, seen), size.tolist(), back, sitk.sitkLinear, origin.tolist(), SPACING
    )
    bright = sitk.GetArrayFromImage(there) * _field((size[2], size[1], size[0]))
    random = np.random.default_rng(seed)
    channels = random.normal(0.0, NOISE, (2, *bright.shape))
    noisy = np.hypot(bright + channels[0], channels[1])
    moving = Volume(
        np.rint(noisy).astype(np.int16),
        spacing=SPACING,
        origin=origin.tolist(),
        traits=VolumeTraits(name="like MR", modality="MR"),
    )
    return Pair(ct, moving, matrix)


def apart_from(  # one for each thing that is varied
    pair: Pair,
    *,
    kind: Kind,
    metric: Metric,
    off: tuple[float, float],
    direction: int,
    options: SearchOptions | None = None,
    progress: Progress = silent,
) -> Apart:
    """Registers from a start with an error of translation [mm] and rotation [degrees].

    A registration that fails leaves the moving scan at the start.
    """
    length, degrees = off
    random = np.random.default_rng(direction)
    axis, way = random.normal(size=(2, 3))
    middle = _middle(pair.fixed)
    wrong = _about(middle, _turned(degrees, axis), length * way / np.linalg.norm(way))
    # what is scaled and sheared is not known beforehand
    start = _about(middle, TURN, SHIFT) @ wrong
    corners = _corners(pair.fixed)
    before = _most(corners, start, pair.matrix)
    try:
        found = register(
            pair.fixed,
            pair.moving,
            kind=kind,
            metric=metric,
            start=start,
            options=options,
            progress=progress,
        )
    except RegistrationError:
        return Apart(before, before)
    return Apart(before, _most(corners, found.unbent, pair.matrix))


def head_of(path: Path) -> Volume:
    """Returns the head of CThead [HU] at half the resolution in plane; the file is in HU + 1024."""
    head = read(path)
    fine = Volume(
        head.array,
        spacing=head.spacing,
        slope=head.slope,
        intercept=head.intercept - 1024.0,
        traits=VolumeTraits(name=head.name, modality="CT", unit="HU"),
    )
    return coarser(fine, (2, 2, 1))


def measure_modalities(ct: Volume, progress: Progress = silent) -> list[Row]:
    """Registers a scan [HU] with its stand-in for MR in all ways; returns the errors."""
    reports: dict[str, dict[str, float]] = {}
    for kind in TRUTHS:
        pair = like_mr(ct, kind)
        for metric in METRICS:
            for off in STARTS:
                found = [
                    apart_from(
                        pair, kind=kind, metric=metric, off=off, direction=side, progress=progress
                    )
                    for side in range(DIRECTIONS)
                ]
                reports[modality_case(kind, metric, off)] = _summary(found)
    return [row_of(goal, reports[goal.case]) for goal in MODALITY_ROWS]


def coarser(ct: Volume, factors: tuple[int, int, int]) -> Volume:
    """Returns a scan on a grid that is coarser by so many voxels along x, y, z."""
    sitk = simpleitk()
    image = sitk.BinShrink(image_on(ct, ct.array), list(factors))
    return Volume(
        sitk.GetArrayFromImage(image),
        spacing=image.GetSpacing(),
        origin=image.GetOrigin(),
        direction=ct.direction,
        slope=ct.slope,
        intercept=ct.intercept,
        traits=ct.traits,
    )


def _summary(found: Iterable[Apart]) -> dict[str, float]:
    before, after = np.transpose([(one.before, one.after) for one in found])
    return {"before": float(before.mean()), "mean": float(after.mean()), "most": float(after.max())}


def _field(shape: tuple[int, ...]) -> NDArray[np.float32]:
    """Returns the sensitivity of a coil, about 1, shape [z, y, x]."""
    z, y, x = np.meshgrid(*(np.linspace(-1.0, 1.0, count) for count in shape), indexing="ij")
    field = 1.0 + UNEVEN * (0.6 * x - 0.7 * y * y + 0.5 * z * x + 0.3)
    return field.astype(np.float32)


def _about(middle: Points, turn: Points, shift: Points) -> Points:
    matrix = np.eye(4)
    matrix[:3, :3] = turn
    matrix[:3, 3] = middle + shift - turn @ middle
    return matrix


def _middle(volume: Volume) -> Points:
    middle: Points = _corners(volume).mean(axis=0)
    return middle


def _corners(volume: Volume) -> Points:
    """Returns the corners of a grid, shape [8, 3] [mm]."""
    places = np.stack(np.meshgrid(*((0.0, n) for n in volume.dimensions)), axis=-1).reshape(-1, 3)
    corners: Points = (np.hstack([places, np.ones((8, 1))]) @ volume.patient_from_grid.T)[:, :3]
    return corners


def _most(points: Points, one: Points, other: Points) -> float:
    apart = points @ (one - other)[:3, :3].T + (one - other)[:3, 3]
    return float(np.linalg.norm(apart, axis=1).max())
