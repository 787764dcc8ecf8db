"""Where a body is palpated: lines of places over bone that is near in the middle and far beside it.

Sides are the patient's. Masks have the shape of the volume; points are in the patient [mm].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.volumes.volume import Volume

__all__ = ["SIDES", "PressLine", "line_over"]

Mask = NDArray[np.bool_]

SIDES = {
    "anterior": (0.0, 1.0, 0.0),
    "posterior": (0.0, -1.0, 0.0),
    "left": (-1.0, 0.0, 0.0),
    "right": (1.0, 0.0, 0.0),
}
"""From where a body is pressed, and which way is inward then [patient, LPS]."""

UP = (0.0, 0.0, 1.0)

DEEP = 25.0
"""What is deeper than this is as far as none [mm]."""

STEEP = 0.7
"""Slope of the surface along a line, at most."""

NEAR = (3.0, 10.0)
"""How deep the bone is in the middle of a line, from a press that ends before it to where it is
felt no more [mm]."""

DEEPER = 6.0
"""How much deeper it is at both ends, at least [mm]."""


@dataclass(frozen=True)
class PressLine:
    """Places beside one another, to be pressed."""

    surface: tuple[NDArray[np.float64], ...]
    """Where each way meets the body [mm]."""
    direction: NDArray[np.float64]
    """Inward, of length 1."""
    along: tuple[float, ...]
    """How far each is from the first [mm]."""
    thickness: tuple[float | None, ...]
    """Of what is before the first bone there [mm]; None where there is none."""


@dataclass(frozen=True)
class _View:
    """A scan as it is seen from one side, with lines along one of the other axes."""

    volume: Volume
    inward: int
    """Axis of the arrays along which one looks."""
    along: int
    backward: bool
    """Whether one looks from the upper end of that axis."""

    @property
    def across(self) -> int:
        return 3 - self.inward - self.along

    def of(self, mask: Mask) -> Mask:
        """The mask as [across, inward, along]."""
        turned = np.transpose(mask, (self.across, self.inward, self.along))
        return turned[:, ::-1] if self.backward else turned

    def spacing(self, axis: int) -> float:
        return self.volume.spacing[2 - axis]

    def point(self, across: int, deep: float, along: int) -> NDArray[np.float64]:
        """The point as many voxels deep as given, in the middle of a row of voxels [mm]."""
        grid = np.ones(4)
        count = self.volume.shape[self.inward]
        grid[2 - self.across] = across + 0.5
        grid[2 - self.inward] = count - deep if self.backward else deep
        grid[2 - self.along] = along + 0.5
        return np.asarray((self.volume.patient_from_grid @ grid)[:3])


def line_over(
    volume: Volume,
    soft: Mask,
    bone: Mask,
    *,
    length: float = 40.0,
    count: int = 9,
    sides: Sequence[str] = ("anterior",),
) -> PressLine:
    """Returns places along a line over bone that is near in the middle and far beside it.

    Of all lines around the body and up and down it, that with the largest difference is taken; from
    one side alone, those up and down only where there are no others.

    Args:
        volume: The scan.
        soft: What gives way.
        bone: What does not.
        length: From the first to the last place [mm].
        count: How many, at least 3.
        sides: Where they may be, names of :data:`SIDES`.

    Raises:
        OptionError: There is no such line, or no such side.
    """
    if count < 3:
        raise OptionError(f"{count} places given; allowed: 3 or more")
    for side in sides:
        if side not in SIDES:
            raise OptionError(f"side {side!r} given; allowed: {', '.join(SIDES)}")
    views = [view for side in sides for view in _views(volume, SIDES[side])]
    for group in [[view] for view in views] if len(sides) == 1 else [views]:
        lines = [_best(view, (soft, bone), length=length, count=count) for view in group]
        found = [line for line in lines if line is not None]
        if found:
            return max(found, key=lambda scored: scored[0])[1]
    low, high = NEAR
    raise OptionError(
        f"no line over bone from {', '.join(sides)} given; allowed: bone {low:g} to {high:g} mm "
        f"below the surface, and {DEEPER:g} mm deeper beside it"
    )


def _views(volume: Volume, inward: tuple[float, float, float]) -> list[_View]:
    """The scan as seen that way: lines around the body, and lines up and down it."""
    axes = volume.direction.T @ np.array([inward, UP]).T
    looked, up = (int(np.abs(axes[:, way]).argmax()) for way in (0, 1))
    if looked == up:
        raise OptionError("a scan that lies across the patient given; allowed: one along its axes")
    around = 3 - looked - up
    backward = bool(axes[looked, 0] < 0.0)
    return [
        _View(volume=volume, inward=2 - looked, along=2 - along, backward=backward)
        for along in (around, up)
    ]


def _best(
    view: _View, masks: tuple[Mask, Mask], *, length: float, count: int
) -> tuple[float, PressLine] | None:
    """The line of the largest difference, and that; none where there is none."""
    soft, bone = masks
    deep, wide = view.spacing(view.inward), view.spacing(view.along)
    hard = _first(view.of(bone))
    skin = _first(view.of(soft | bone))
    thickness = np.where(hard >= 0, (hard - skin) * deep, DEEP)
    offsets = np.rint(np.linspace(-0.5, 0.5, count) * length / wide).astype(int)
    if (np.diff(offsets) == 0).any():
        return None
    at = np.arange(skin.shape[1])[:, None] + offsets
    fits = (at >= 2) & (at < skin.shape[1] - 2)
    at = np.where(fits, at, 0)
    # by across, middle and place of a line
    over, there = np.minimum(thickness[:, at], DEEP), skin[:, at]
    slope = np.abs(np.diff(there, axis=2)) * deep / (np.diff(offsets) * wide)
    middle = over[:, :, count // 2]
    ends = np.minimum(over[:, :, 0], over[:, :, -1])
    good = fits.all(axis=1)[None] & (there >= 0).all(axis=2) & (slope.max(axis=2) < STEEP)
    # some soft matter over the bone everywhere, as much as a finger presses in
    good &= (over.min(axis=2) >= NEAR[0]) & (middle <= NEAR[1]) & (ends >= middle + DEEPER)
    score = np.where(good, ends - middle - slope.mean(axis=2), -np.inf)
    score[:2] = score[-2:] = -np.inf
    if not np.isfinite(score).any():
        return None
    across, place = (int(n) for n in np.unravel_index(int(score.argmax()), score.shape))
    columns = place + offsets
    points = [view.point(across, skin[across, column], column) for column in columns]
    inward = view.point(across, 1.0, place) - view.point(across, 0.0, place)
    line = PressLine(
        surface=tuple(points),
        direction=inward / np.linalg.norm(inward),
        along=tuple(float(np.linalg.norm(point - points[0])) for point in points),
        thickness=tuple(
            float((hard[across, column] - skin[across, column]) * deep)
            if hard[across, column] >= 0
            else None
            for column in columns
        ),
    )
    return float(score[across, place]), line


def _first(mask: Mask) -> NDArray[np.int64]:
    """The first voxel that is met, [across, along]; -1 where there is none."""
    return np.where(mask.any(axis=1), mask.argmax(axis=1), -1)
