"""Where the slices of a series lie, and whether they make a straight, even stack.

Frame: LPS [mm]. A stack that is tilted (gantry tilt) or unevenly spaced is refused: laid on
an even, upright grid it would be a sheared or stretched picture of the patient.
Source: DICOM PS3.3, C.7.6.2.1.1, equation C.7.6.2.1-1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.errors import VolumeFormatError
from palpate.io_dicom_header import Frame

__all__ = ["Stack", "stack_of"]


@dataclass(frozen=True)
class Stack:
    """The grid that a series fills."""

    order: tuple[int, ...]
    """Frames in the order of rising z of the grid."""
    spacing: tuple[float, float, float]
    origin: tuple[float, float, float]
    direction: NDArray[np.float64]


def stack_of(what: str, frames: Sequence[Frame]) -> Stack | None:
    """Orders frames along their normal; None where the files tell no positions.

    Raises:
        VolumeFormatError: The frames are tilted, uneven, doubled, or differ in their spacing.
    """
    if any(frame.position is None or frame.orientation is None for frame in frames):
        return None
    spacing = _pixel_spacing(what, frames)
    if spacing is None:
        return None
    across, down, normal = _axes(what, frames)

    # order along the normal; a file with its frames from end to start keeps its order
    positions = np.array([frame.position for frame in frames])
    order = np.argsort(positions @ normal, kind="stable")
    step = _even_step(what, positions[order], normal=normal, pixel=min(spacing))
    first = positions[order[0]]
    return Stack(
        order=tuple(int(index) for index in order),
        spacing=(spacing[1], spacing[0], step),
        origin=(float(first[0]), float(first[1]), float(first[2])),
        direction=np.column_stack([across, down, normal]),
    )


def _pixel_spacing(what: str, frames: Sequence[Frame]) -> tuple[float, ...] | None:
    spacings = [frame.pixel_spacing for frame in frames]
    first = spacings[0]
    if first is None or None in spacings:
        return None
    # 1e-3: writers round the same spacing in different ways
    if not np.allclose(np.array(spacings, float), first, rtol=1e-3) or min(first) <= 0.0:
        raise VolumeFormatError(
            f"{what} has slices with differing or impossible pixel spacings; "
            "allowed: one spacing above 0 for all slices"
        )
    return first


def _axes(what: str, frames: Sequence[Frame]) -> tuple[NDArray[np.float64], ...]:
    """Returns unit vectors along rows, along columns, and their normal."""
    cosines = np.array([frame.orientation for frame in frames], float).mean(axis=0)
    across, down = cosines[:3], cosines[3:]
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
    return across, down, np.cross(across, down)


def _even_step(
    what: str,
    positions: NDArray[np.float64],
    *,
    normal: NDArray[np.float64],
    pixel: float,
) -> float:
    """Returns the distance between slices [mm]; refuses a stack that is not even and upright."""
    along = positions @ normal
    if len(along) < 2:
        return 1.0
    steps = np.diff(along)
    step = float(np.median(steps))
    if steps.min() < 1e-3:
        doubled = int(np.count_nonzero(steps < 1e-3))
        raise VolumeFormatError(
            f"{what} has {doubled} slices at the place of another (several phases or times?); "
            "allowed: one slice per place"
        )

    # half a pixel of drift across the stack cannot be seen; a tilt makes tens of pixels
    drift = positions[-1] - positions[0]
    sideways = drift - normal * (drift @ normal)
    if np.linalg.norm(sideways) > 0.5 * pixel:
        tilt = np.degrees(np.arctan2(np.linalg.norm(sideways), drift @ normal))
        uneven = _steps_found(steps, step) if _uneven(along, step) else ""
        raise VolumeFormatError(
            f"{what} has slices tilted by {tilt:.1f} degrees against their stack (gantry tilt)"
            f"{' and ' if uneven else ''}{uneven}; allowed: upright, evenly spaced slices, so "
            "resample it first, e.g. with dcm2niix"
        )
    if _uneven(along, step):
        raise VolumeFormatError(
            f"{what} has {_steps_found(steps, step)}; allowed: evenly spaced slices, so look for "
            "missing files or resample it first, e.g. with dcm2niix"
        )
    return float((along[-1] - along[0]) / (len(along) - 1))


def _uneven(along: NDArray[np.float64], step: float) -> bool:
    """Says whether a slice lies off its place on an even stack by more than a tenth of a step."""
    even = np.linspace(along[0], along[-1], len(along))
    return bool(np.abs(along - even).max() > 0.1 * step)


def _steps_found(steps: NDArray[np.float64], step: float) -> str:
    """Says what the steps are, as a person would look for them."""
    odd = int(np.count_nonzero(np.abs(steps - step) > 0.1 * step))
    return (
        f"uneven steps between slices: {steps.min():.2f} to {steps.max():.2f} mm, "
        f"{odd} of {len(steps)} off the usual {step:.2f} mm"
    )
