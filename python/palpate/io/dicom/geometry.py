"""Where the slices of a series lie, and the right grid that they become.

A stack is even and upright as it is, or is laid on a right grid by ``resample``: a
tilted gantry shifts its slices sideways, and steps between them differ where a protocol changes
or slices are missing. What was found is told in words.

Frame: LPS [mm]. Source: DICOM PS3.3, C.7.6.2.1.1, equation C.7.6.2.1-1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.base.counted import counted
from palpate.base.errors import VolumeFormatError
from palpate.io.dicom.header import PARALLEL, Frame

__all__ = ["Grid", "Stack", "grid_of", "stack_of"]

SAME_PLACE = 1e-3
"""Slices nearer than this lie at one place [mm]."""
WIDEST_GAP = 3.0, 10.0
"""Gaps wider than so many usual steps and so many mm are not filled: too little is known there."""


@dataclass(frozen=True)
class Stack:
    """Slices in the order of rising normal."""

    order: tuple[int, ...]
    """Which of the frames given comes when."""
    pixel: tuple[float, float]
    """Between columns, between rows [mm]: along x and y."""
    axes: NDArray[np.float64]
    """Unit vectors along rows, along columns and their normal as columns, shape [3, 3]."""
    positions: NDArray[np.float64]
    """Centre of each slice's first pixel, in order, shape [slices, 3]."""
    told: tuple[str, ...] = ()
    """What was assumed, in words."""

    @property
    def local(self) -> NDArray[np.float64]:
        """Positions from the first one, along x, y and the normal [mm], shape [slices, 3]."""
        away: NDArray[np.float64] = (self.positions - self.positions[0]) @ self.axes
        return away


@dataclass(frozen=True)
class Grid:
    """A right grid, even on each axis, that holds all of a stack."""

    size: tuple[int, int, int]
    spacing: tuple[float, float, float]
    origin: tuple[float, float, float]
    direction: NDArray[np.float64]
    resampled: bool
    """Whether the stack's slices are no slices of it as they are."""
    told: tuple[str, ...]
    """What is not as it should be, in words."""


def stack_of(what: str, frames: Sequence[Frame]) -> Stack | None:
    """Orders frames along their normal; None where the files tell no positions.

    Raises:
        VolumeFormatError: Frames are turned against each other, lie at one place, or differ in
            their spacing.
    """
    if any(frame.position is None or frame.orientation is None for frame in frames):
        return None
    spacing, told = _pixel_spacing(what, frames)
    axes = _axes(what, frames)

    # a file with its frames from end to start keeps its order
    positions = np.array([frame.position for frame in frames])
    along = positions @ axes[:, 2]
    order = np.argsort(along, kind="stable")
    doubled = int(np.count_nonzero(np.diff(along[order]) < SAME_PLACE))
    if doubled:
        raise VolumeFormatError(
            f"{what} has {doubled} slices at the place of another (several phases or times?); "
            "allowed: one slice per place"
        )
    return Stack(
        order=tuple(int(index) for index in order),
        pixel=(spacing[1], spacing[0]),
        axes=axes,
        positions=positions[order],
        told=told,
    )


def grid_of(what: str, stack: Stack, *, columns: int, rows: int) -> Grid:
    """Returns the right grid for a stack of slices of such a size.

    It keeps the slices' own axes and pixels, and grows where a tilt shifts them sideways. Its
    step is the one between slices, or where that differs the finest that is usual.

    Raises:
        VolumeFormatError: A gap between slices is too wide to be filled.
    """
    local = stack.local
    step, count, told = _steps(what, local[:, 2], least=0.5 * min(stack.pixel))
    sideways = _sideways(stack)
    low, high = np.zeros(2), np.zeros(2)
    if sideways:
        told = [*sideways, *told]
        # whole pixels from the first slice, so that its own pixels stay what they are
        shifts = local[:, :2] / stack.pixel
        low = np.floor(shifts.min(axis=0) + 1e-6)
        high = np.ceil(shifts.max(axis=0) - 1e-6)
    wide, deep = (high - low).astype(int)
    size = (columns + int(wide), rows + int(deep), count)
    if told:
        told.append(
            f"resampled linearly to {size[0]} x {size[1]} x {size[2]} voxels on a right grid"
        )
    corner = stack.positions[0] + stack.axes[:, :2] @ (low * stack.pixel)
    return Grid(
        size=size,
        spacing=(*stack.pixel, step),
        origin=(float(corner[0]), float(corner[1]), float(corner[2])),
        direction=stack.axes,
        resampled=bool(told),
        told=tuple(told),
    )


def _pixel_spacing(what: str, frames: Sequence[Frame]) -> tuple[tuple[float, ...], tuple[str, ...]]:
    """Returns the spacing of all frames, and what was assumed where some tell none."""
    spacings = [frame.pixel_spacing for frame in frames if frame.pixel_spacing is not None]
    if not spacings:
        return (1.0, 1.0), ("the files tell no pixel spacing: pixels of 1 mm are assumed",)
    first = spacings[0]
    # 1e-3: writers round the same spacing in different ways
    if not np.allclose(np.array(spacings, float), first, rtol=1e-3) or min(first) <= 0.0:
        raise VolumeFormatError(
            f"{what} has slices with differing or impossible pixel spacings; "
            "allowed: one spacing above 0 for all slices"
        )
    missing = len(frames) - len(spacings)
    some = counted(missing, "slices tells", "slices tell", of=len(frames))
    return first, (f"{some} no pixel spacing: that of the others is assumed",) if missing else ()


def _axes(what: str, frames: Sequence[Frame]) -> NDArray[np.float64]:
    """Returns unit vectors along rows, along columns, and their normal, as columns."""
    cosines = np.array([frame.orientation for frame in frames], float)
    mean = cosines.mean(axis=0)
    if np.abs(cosines - cosines[0]).max() > PARALLEL:
        raise VolumeFormatError(
            f"{what} has slices that are turned against each other; "
            "allowed: slices of one orientation, such as one stack of a multi-frame file"
        )
    across, down = mean[:3], mean[3:]
    lengths = np.linalg.norm(across), np.linalg.norm(down)
    # 1e-3: cosines written with four digits
    if abs(lengths[0] - 1) > 1e-3 or abs(lengths[1] - 1) > 1e-3 or abs(across @ down) > 1e-3:
        raise VolumeFormatError(
            f"{what} has rows and columns that are not perpendicular unit vectors; "
            "allowed: valid image orientations"
        )
    across = across / lengths[0]
    down = down - across * (across @ down)
    down = down / np.linalg.norm(down)
    return np.column_stack([across, down, np.cross(across, down)])


def _sideways(stack: Stack) -> list[str]:
    """Says by how much slices are shifted sideways; nothing where it cannot be seen."""
    local = stack.local
    # half a pixel of drift across the stack cannot be seen; a tilt makes tens of pixels
    seen = 0.5 * min(stack.pixel)
    if len(local) < 2 or np.abs(local[:, :2]).max() <= seen:
        return []
    # far ones show it more exactly, neighbours where a part of the stack lies beside the rest
    found = [_drift(local, by) for by in (len(local) // 2, 1)]
    drift, off = min(found, key=lambda each: np.count_nonzero(each[1] > seen))
    shifted = int(np.count_nonzero(off > seen))
    told = []
    tilt = float(np.linalg.norm(drift))
    if tilt * local[-1, 2] > seen:
        angle = np.degrees(np.arctan(tilt))
        told.append(f"slices are tilted by {angle:.1f} degrees against their stack (gantry tilt)")
    if shifted:
        some = counted(shifted, "slices is", "slices are", of=len(local))
        told.append(f"{some} shifted sideways, by up to {off.max():.1f} mm")
    return told or [f"slices drift sideways, by {np.abs(local[:, :2]).max():.1f} mm"]


def _drift(local: NDArray[np.float64], by: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns how far slices shift with height, from those ``by`` apart, and what is left [mm].

    Few that are shifted by themselves do not count in medians.
    """
    apart = local[by:] - local[:-by]
    drift = np.median(apart[:, :2] / apart[:, 2:], axis=0)
    beside = local[:, :2] - drift * local[:, 2:]
    return drift, np.linalg.norm(beside - np.median(beside, axis=0), axis=1)


def _steps(what: str, along: NDArray[np.float64], *, least: float) -> tuple[float, int, list[str]]:
    """Returns the grid's step [mm] and slices, and what is uneven about the stack's own."""
    if len(along) == 1:
        return 1.0, 1, []
    steps = np.diff(along)
    usual = float(np.median(steps))
    length = float(along[-1] - along[0])
    even = np.linspace(along[0], along[-1], len(along))
    # a slice off its place by more than a tenth of a step shows
    if np.abs(along - even).max() <= 0.1 * usual:
        return length / (len(along) - 1), len(along), []

    widest = float(steps.max())
    if widest > WIDEST_GAP[0] * usual and widest > WIDEST_GAP[1]:
        raise VolumeFormatError(
            f"{what} has a gap of {widest:.1f} mm between slices {usual:.2f} mm apart; allowed: "
            f"gaps of at most {WIDEST_GAP[0]:g} steps or {WIDEST_GAP[1]:g} mm, so look for missing "
            "files"
        )
    # a step that at least a tenth of all are no finer than; no finer than the pixels need
    wanted = max(float(np.quantile(steps, 0.1, method="higher")), least)
    count = round(length / wanted) + 1
    return length / (count - 1), count, [_told(steps, usual)]


def _told(steps: NDArray[np.float64], usual: float) -> str:
    """Says what the steps are, as a person would look for them."""
    off = np.abs(steps - usual) > 0.1 * usual
    missing = np.rint(steps / usual) - 1
    if np.all(np.abs(steps - (missing + 1) * usual) <= 0.1 * usual) and np.all(missing >= 0):
        places = ", ".join(str(int(index) + 1) for index in np.flatnonzero(missing)[:5])
        some = counted(int(missing.sum()), "slice is", "slices are")
        return f"{some} missing, after number {places}: filled in between their neighbours"
    return (
        f"steps between slices are uneven: {steps.min():.2f} to {steps.max():.2f} mm, "
        f"{int(np.count_nonzero(off))} of {len(steps)} off the usual {usual:.2f} mm"
    )
