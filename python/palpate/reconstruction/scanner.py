"""Geometry of projections: beams, angles, distances; and what they show of the patient.

Frame of the device: y is the axis of rotation; at angle 0 the detector's columns u run along x and
its rows v along y, the source is at +z, and it moves toward +x [mm]. In the patient (LPS), x is
left and y the head; z is the back, or the front where ``zero`` says so.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from palpate.base.errors import OptionError
from palpate.reconstruction.beams import BEAMS, ZEROS, Beam, Zero
from palpate.reconstruction.views import View, seen_by_all

__all__ = ["MOST_VOXELS", "Grid", "Scanner", "fitted_grid"]

LEAST_ANGLES = 8
MOST_VOXELS = 1024**3
USUAL_VOXELS = 512**3
"""Most voxels, where no size is given."""

Size = tuple[int, int, int]
Lengths = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Scanner:
    """Geometry of projections."""

    beam: Beam
    angles: Sequence[float]
    """Angle of the gantry at each projection [degrees], in order and equally spaced, except where
    each has a view."""
    pixel: tuple[float, float]
    """Pixel size of the detector along u and v [mm]."""
    offset: tuple[float, float] = (0.0, 0.0)
    """Offset of the detector's middle from the central ray along u and v [mm]."""
    source_to_axis: float = 0.0
    """Distance from source to axis, for cone beams [mm]."""
    source_to_detector: float = 0.0
    """Distance from source to detector, for cone beams [mm]."""
    zero: Zero = "back"
    """Side of the patient at which the source is at angle 0; "front" is IEC 61217's, as RTK has it
    for a patient in supine position."""
    views: Sequence[View] = ()
    """Where source and detector are at each projection of a cone beam, as a geometry file has it;
    none for those of ``angles`` on one circle, with the distances and offsets above."""

    @property
    def posterior(self) -> float:
        """Direction of the patient's back along z of the device, 1 or -1."""
        return 1.0 if self.zero == "back" else -1.0

    @property
    def arc(self) -> float | None:
        """Arc that equal angles cover [degrees]; None where they are not equal."""
        steps = np.diff(self.angles)
        even = bool(np.allclose(steps, steps[0], rtol=1e-3, atol=1e-6))
        return abs(float(steps[0])) * len(self.angles) if even else None

    def all_views(self) -> Sequence[View]:
        """Returns where source and detector are at each projection of a cone beam."""
        near, far = self.source_to_axis, self.source_to_detector
        return self.views or [
            View(angle=angle, source_to_axis=near, source_to_detector=far) for angle in self.angles
        ]

    def check(self, shape: tuple[int, ...]) -> None:
        """Refuses a geometry that does not fit projections of a shape.

        Raises:
            OptionError: The geometry is not possible.
        """
        if self.beam not in BEAMS:
            raise OptionError(f"beam {self.beam!r} given; allowed: {', '.join(BEAMS)}")
        if self.zero not in ZEROS:
            raise OptionError(f"zero {self.zero!r} given; allowed: {', '.join(ZEROS)}")
        if len(shape) != 3 or min(shape) < 1 or shape[2] < 2:
            raise OptionError(
                f"projections of shape {list(shape)} given; allowed: [angles, rows, columns]"
            )
        if len(self.angles) != shape[0] or shape[0] < LEAST_ANGLES:
            raise OptionError(
                f"{len(self.angles)} angles and {shape[0]} projections given; allowed: as many "
                f"angles as projections, {LEAST_ANGLES} or more"
            )
        numbers = (*self.angles, *self.pixel, *self.offset)
        if not np.isfinite(numbers).all() or min(self.pixel) <= 0.0:
            raise OptionError(f"pixels of {self.pixel} mm given; allowed: lengths above 0")
        if not self.views:
            self._check_circle()

    def _check_circle(self) -> None:
        """Refuses angles that are not on one circle, or distances that are none."""
        arc = self.arc
        if arc is None or not np.isclose(arc, 360.0, rtol=1e-3):
            half = arc is not None and bool(np.isclose(arc, 180.0, rtol=1e-3))
            if not (self.beam == "parallel" and half and self.offset[0] == 0.0):
                arcs = "uneven angles" if arc is None else f"an arc of {arc:g} degrees"
                raise OptionError(
                    f"{arcs} given; allowed: even ones over 360 degrees, or with parallel beams on "
                    "a detector whose middle the central ray meets, over 180"
                )
        near, far = self.source_to_axis, self.source_to_detector
        if self.beam == "cone" and not 0.0 < near < far < np.inf:
            raise OptionError(
                f"source at {near:g} mm from the axis and {far:g} mm from the detector given; "
                "allowed: above 0, the axis nearer than the detector"
            )


@dataclass(frozen=True)
class Grid:
    """Grid of a scan around the axis, along x, y, z of the patient."""

    size: Size
    """Number of voxels."""
    voxel: Lengths
    """Voxel size [mm]."""


def fitted_grid(
    shape: tuple[int, ...],
    scanner: Scanner,
    *,
    size: Size | None = None,
    voxel: Lengths | None = None,
) -> Grid:
    """Returns the grid of all that every projection shows, with voxels as fine as the pixels.

    Args:
        shape: Shape of the projections, [angle, v, u].
        scanner: Geometry of the projections.
        size: Number of voxels along x, y, z, where it is given.
        voxel: Voxel size [mm], where it is given; else larger than the pixels where there would be
            more than ``USUAL_VOXELS``.

    Raises:
        OptionError: The geometry or the grid is not possible.
    """
    scanner.check(shape)
    _check(size, voxel)
    pixel, seen = _seen(shape, scanner)
    if voxel is None and size is not None:
        voxel = _three(length / count for length, count in zip(seen, size, strict=True))
    if voxel is None:
        many = float(np.prod(np.divide(seen, pixel))) / USUAL_VOXELS
        voxel = _three(edge * max(1.0, many ** (1.0 / 3.0)) for edge in pixel)
    if size is None:
        counts = (round(length / edge) for length, edge in zip(seen, voxel, strict=True))
        x, y, z = (max(2, count) for count in counts)
        size = x, y, z
    if int(np.prod(size, dtype=np.int64)) > MOST_VOXELS:
        raise OptionError(f"{size} voxels given; allowed: together {MOST_VOXELS}")
    return Grid(size, voxel)


def _check(size: Size | None, voxel: Lengths | None) -> None:
    if size is not None and min(size) < 2:
        raise OptionError(f"{size} voxels given; allowed: 2 or more along each axis")
    if voxel is not None and (not np.isfinite(voxel).all() or min(voxel) <= 0.0):
        raise OptionError(f"voxels of {voxel} mm given; allowed: lengths above 0")


def _seen(shape: tuple[int, ...], scanner: Scanner) -> tuple[Lengths, Lengths]:
    """Returns the size of a pixel at the axis, and the size of what is seen from all sides [mm]."""
    u, v = scanner.pixel
    if scanner.beam == "cone":
        views = scanner.all_views()
        near = min(view.source_to_axis / view.source_to_detector for view in views)
        radius, high = seen_by_all(views, (shape[2] * u, shape[1] * v), scanner.offset)
        return (u * near, u * near, v * near), (2.0 * radius, 2.0 * radius, high)
    wide = shape[2] * u - 2.0 * abs(scanner.offset[0])
    high = shape[1] * v
    if wide <= 0.0:
        raise OptionError(
            f"offset of {scanner.offset[0]:g} mm given; allowed: less than half of the detector"
        )
    return (u, u, v), (wide, wide, high)


def _three(edges: Iterable[float]) -> Lengths:
    x, y, z = edges
    return x, y, z
