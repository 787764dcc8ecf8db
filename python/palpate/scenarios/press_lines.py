"""Places to palpate: lines over bone that is near in the middle and deep at both ends, and squares.

Sides are the patient's. Masks have the shape of the volume; points are in the patient, LPS [mm].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.volumes.volume import Volume

__all__ = ["SIDES", "PressLine", "line_over", "square_on"]

Mask = NDArray[np.bool_]

SIDES = {
    "anterior": (0.0, 1.0, 0.0),
    "posterior": (0.0, -1.0, 0.0),
    "left": (-1.0, 0.0, 0.0),
    "right": (1.0, 0.0, 0.0),
}
"""Sides from which a body is pressed, and the inward direction of each [patient, LPS]."""

UP = (0.0, 0.0, 1.0)

DEEP = 25.0
"""Depth beyond which bone counts as absent [mm]."""

STEEP = 0.7
"""Largest slope of the surface along a line."""

NEAR = (3.0, 10.0)
"""Depth of the bone in the middle of a line: least, so that a press ends above it, and largest,
where it is still felt [mm]."""

DEEPER = 6.0
"""How much deeper the bone is at both ends, at least [mm]."""


@dataclass(frozen=True)
class PressLine:
    """Neighbouring places to press."""

    surface: tuple[NDArray[np.float64], ...]
    """Points on the surface of the body [mm], shape [count, 3]."""
    direction: NDArray[np.float64]
    """Inward direction, a unit vector."""
    along: tuple[float, ...]
    """Distance of each place from the first [mm]."""
    thickness: tuple[float | None, ...]
    """Thickness of tissue over the first bone at each place [mm]; None where there is no bone."""
    across: tuple[float, ...] = ()
    """Distance of each place from the first across the rows of a square [mm]; empty for a line."""


@dataclass(frozen=True)
class _View:
    """A scan seen from one side, with lines along one of the other axes."""

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
        """Returns the mask as [across, inward, along]."""
        turned = np.transpose(mask, (self.across, self.inward, self.along))
        return turned[:, ::-1] if self.backward else turned

    def spacing(self, axis: int) -> float:
        return self.volume.spacing[2 - axis]

    def point(self, across: int, deep: float, along: int) -> NDArray[np.float64]:
        """Returns the point at a depth in voxels, in the middle of a row of voxels [mm]."""
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
    """Returns places along a line over bone that is near in the middle and deep at both ends.

    Of all lines around the body and along it, the one with the largest difference is taken; from
    one side only, those along the body are taken only where there are no others.

    Args:
        volume: The scan.
        soft: Mask of deformable tissue.
        bone: Mask of bone.
        length: Distance from the first place to the last [mm].
        count: Number of places, at least 3.
        sides: Sides to search, names of :data:`SIDES`.

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


def square_on(
    volume: Volume, mask: Mask, *, width: float, count: int, side: str = "anterior"
) -> PressLine:
    """Returns the places of a square, row by row, around the place of a mask nearest to a side.

    Args:
        volume: The scan.
        mask: What is pressed.
        width: Distance from the first place of a row to the last [mm].
        count: Places in a row, and rows.
        side: Side from which it is pressed, a name of :data:`SIDES`.

    Raises:
        OptionError: The mask is too small for the square, or it is steeper than a finger follows.
    """
    if count < 3:
        raise OptionError(f"{count} places in a row given; allowed: 3 or more")
    view = _views(volume, SIDES[side])[0]
    first = _first(view.of(mask))
    if not (first >= 0).any():
        raise OptionError("nothing to press given; allowed: tissue with voxels")
    nearest = np.argwhere(first == first[first >= 0].min())
    middle = nearest[((nearest - nearest.mean(axis=0)) ** 2).sum(axis=1).argmin()]
    steps = [
        np.unique(np.rint(np.linspace(-0.5, 0.5, count) * width / view.spacing(axis)).astype(int))
        for axis in (view.across, view.along)
    ]
    rows, columns = (centre + step for centre, step in zip(middle, steps, strict=True))
    fits = all(
        len(places) == count and places[0] >= 0 and places[-1] < size
        for places, size in zip((rows, columns), first.shape, strict=True)
    )
    there = first[np.ix_(rows, columns)] if fits else np.full((count, count), -1)
    up = (rows - middle[0]) * view.spacing(view.across)
    aside = (columns - middle[1]) * view.spacing(view.along)
    away = np.hypot(up[:, None], aside)
    falls = (there - first[tuple(middle)]) * view.spacing(view.inward)
    # from the middle, so that steps of voxels count little
    steepest = np.max(falls[away > 0.0] / away[away > 0.0])
    if (there < 0).any() or steepest > STEEP:
        raise OptionError(
            f"a square of {width:g} mm given; allowed: one that lies on what is pressed, where it "
            f"is no steeper than {STEEP:g}"
        )
    points = [view.point(row, first[row, column], column) for row in rows for column in columns]
    inward = view.point(rows[0], 1.0, columns[0]) - view.point(rows[0], 0.0, columns[0])
    return PressLine(
        surface=tuple(points),
        direction=inward / np.linalg.norm(inward),
        along=tuple(
            float(n) for n in np.tile(columns - columns[0], count) * view.spacing(view.along)
        ),
        thickness=(None,) * len(points),
        across=tuple(
            float(n) for n in np.repeat(rows - rows[0], count) * view.spacing(view.across)
        ),
    )


def _views(volume: Volume, inward: tuple[float, float, float]) -> list[_View]:
    """Returns the scan seen from a side: with lines around the body, and with lines along it."""
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
    """Returns the line with the largest difference, and that difference; None without a line."""
    soft, bone = masks
    deep, wide = view.spacing(view.inward), view.spacing(view.along)
    bone_at = _first(view.of(bone))
    skin = _first(view.of(soft | bone))
    thickness = np.where(bone_at >= 0, (bone_at - skin) * deep, DEEP)
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
    # some soft tissue over the bone everywhere, as much as a finger presses in
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
            float((bone_at[across, column] - skin[across, column]) * deep)
            if bone_at[across, column] >= 0
            else None
            for column in columns
        ),
    )
    return float(score[across, place]), line


def _first(mask: Mask) -> NDArray[np.int64]:
    """Returns the first voxel from the side, [across, along]; -1 where there is none."""
    return np.where(mask.any(axis=1), mask.argmax(axis=1), -1)
