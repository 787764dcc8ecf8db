"""What belongs to one scan, carried to the other one through a transform.

A transform takes points of the fixed scan to those of the moving one. So what lies in the moving
scan is carried to the fixed one by drawing images through the transform as it is (each voxel of the
fixed grid asks where it comes from), and by taking points the other way, through its inverse. What
lies in the **fixed** scan goes to the moving one by the opposite of both.

Frame: LPS [mm].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

from palpate.base.errors import OptionError
from palpate.base.interpolation import Interpolation, InterpolationChoice
from palpate.base.simpleitk import Transform
from palpate.registration.inverse import Inverse, inverse_of
from palpate.registration.options import Points
from palpate.registration.point_map import (
    CLOSE_ENOUGH,
    linear_part,
    matrix_of,
    points_before,
    points_through,
)
from palpate.volumes.mesh_read import MeshFile, with_vertices
from palpate.volumes.resampled import check_interpolation, on_grid, resampled
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume

__all__ = ["Carrier", "Toward"]

Toward = Literal["fixed", "moving"]
"""The scan to which things are carried."""
LEAST_TOLD = 0.0005
"""Share of a segment that is told when it is lost."""
MOST_CHANGE = 0.05
"""Share of a segment's volume by which voxels may change it untold."""
MOST_PROBES = 20_000
"""Voxels of a segment by which the share is told that falls outside."""


@dataclass(frozen=True)
class Carrier:
    """Carries scans, segments, meshes and points through a transform."""

    transform: Transform
    """From points of the fixed scan to those of the moving one."""
    toward: Toward = "fixed"
    grid: Volume | None = None
    """Where images are drawn: the scan to which they are carried."""
    interpolation: InterpolationChoice = "automatic"

    def __post_init__(self) -> None:
        """Refuses what no scan can be carried through.

        Raises:
            OptionError: The transform is not of three dimensions, or the interpolation not known.
        """
        check_interpolation(self.interpolation)
        if self.transform.GetDimension() != 3:
            dimension = self.transform.GetDimension()
            raise OptionError(f"a transform of {dimension} dimensions given; allowed: of 3")

    @property
    def sentence(self) -> str:
        """Says which way it goes."""
        other = "moving" if self.toward == "fixed" else "fixed"
        return f"carried from the {other} scan to the {self.toward} one"

    @cached_property
    def inverse(self) -> Inverse:
        """The inverse of the transform; where that bends, over the grid of the moving scan.

        Raises:
            OptionError: There is none, or the grid is not that of the moving scan.
        """
        return inverse_of(self.transform, self.grid if self.toward == "moving" else None)

    def scan(self, volume: Volume, *, interpolation: InterpolationChoice | None = None) -> Volume:
        """Returns a scan on the grid; beyond it, its lowest value.

        Raises:
            OptionError: No voxel of the grid lies in it.
        """
        grid = self.require_grid()
        whole = np.ones(volume.shape, np.uint8)
        if not on_grid(volume, grid, self._pull, array=whole, outside=0.0, by="nearest").any():
            raise OptionError(f"nothing of {volume.name} reaches {self._elsewhere}")
        by = interpolation or self.interpolation
        return resampled(volume, grid, self._pull, interpolation=by)

    def segments(self, segments: Sequence[Segment]) -> tuple[list[Segment | None], list[str]]:
        """Returns segments on the grid, and sentences on what of them is lost.

        None stands for a segment of which nothing is left.

        Raises:
            OptionError: Nothing of any is left.
        """
        carried: list[Segment | None] = []
        told = []
        for one in segments:
            made = self._segment(one)
            lost = 1.0 if made is None else self._share_outside(one)
            carried.append(made)
            if made is None:
                told.append(f"{one.name} does not reach the grid and is left out")
            elif lost >= LEAST_TOLD:
                told.append(f"{lost:.1%} of {one.name} lies outside of the grid and is lost")
            elif (said := self._volume_told(one, made)) is not None:
                told.append(said)
        if segments and not any(carried):
            raise OptionError(f"none of {len(segments)} segments reaches {self._elsewhere}")
        return carried, told

    def points(self, points: Points) -> Points:
        """Returns where points come to lie, shape [count, 3] [mm].

        Raises:
            OptionError: The transform has no inverse there.
        """
        if self.toward == "moving":
            return points_through(self.transform, points)
        found, apart = points_before(self.transform, points)
        folded = int(np.count_nonzero(~(apart <= CLOSE_ENOUGH)))
        if folded:
            worst = float(np.nanmax(apart))
            raise OptionError(
                f"{folded} of {len(points)} points have no place in the fixed scan: the transform "
                f"folds, or ends, there (the nearest is {worst:.1f} mm off); allowed: points where "
                "it can be turned back"
            )
        return found

    def mesh(self, file: MeshFile) -> MeshFile:
        """Returns a mesh whose vertices are carried.

        Raises:
            OptionError: The transform has no inverse there.
        """
        mirrored = np.linalg.det(matrix_of(linear_part(self.transform))[:3, :3]) < 0.0
        return with_vertices(file, self.points(file.mesh.vertices), mirrored=bool(mirrored))

    def require_grid(self) -> Volume:
        """Returns the grid on which images are drawn.

        Raises:
            OptionError: There is none.
        """
        if self.grid is None:
            raise OptionError(
                "no grid given; allowed: the scan to which images are carried (`like=SCAN`)"
            )
        return self.grid

    @property
    def _pull(self) -> Any:  # noqa: ANN401  # SimpleITK has no types
        """From points of the grid to those of what is drawn there."""
        return self.transform if self.toward == "fixed" else self.inverse.transform

    @property
    def _elsewhere(self) -> str:
        """The end of an error: what is not reached, and why that may be."""
        source = "moving" if self.toward == "fixed" else "fixed"
        return (
            f"{self.require_grid().name} when {self.sentence}; allowed: what belongs to the "
            f"{source} scan of this transform, else the other direction"
        )

    def _segment(self, one: Segment) -> Segment | None:
        """Returns a segment on the grid; None where nothing of it is there."""
        grid = self.require_grid()
        by: Interpolation = "labels" if self.interpolation in ("labels", "linear") else "nearest"
        mask = on_grid(one.volume, grid, self._pull, array=one.mask(), outside=0.0, by=by)
        if not mask.any():
            return None
        made = grid.segment(mask, name=one.name)
        made.number, made.terminology = one.number, one.terminology
        return made

    def _volume_told(self, before: Segment, after: Segment) -> str | None:
        """Says that a segment is not as large as it should be; None where it is, or may bend."""
        if not self.transform.IsLinear():
            return None
        factor = abs(float(np.linalg.det(matrix_of(self.transform)[:3, :3])))
        wanted = before.volume_ml * (factor if self.toward == "moving" else 1.0 / factor)
        if abs(after.volume_ml - wanted) <= MOST_CHANGE * wanted:
            return None
        return (
            f"{before.name} has {1000.0 * after.volume_ml:.4g} mm³ on the grid and should have "
            f"{1000.0 * wanted:.4g} mm³: it is thin for voxels of that size"
        )

    def _share_outside(self, segment: Segment) -> float:
        """Returns the share of a segment's voxels whose middles fall outside of the grid."""
        z, y, x = np.nonzero(segment.mask())
        every = max(1, len(x) // MOST_PROBES)
        index = np.column_stack([x, y, z])[::every] + 0.5
        to_patient = segment.volume.patient_from_grid
        points = index @ to_patient[:3, :3].T + to_patient[:3, 3]
        if self.toward == "moving":
            there = points_through(self.transform, points)
        else:
            there, _ = points_before(self.transform, points)
        to_grid = np.linalg.inv(self.require_grid().patient_from_grid)
        seen = there @ to_grid[:3, :3].T + to_grid[:3, 3]
        inside = np.all((seen >= 0.0) & (seen <= self.require_grid().dimensions), axis=1)
        return 1.0 - float(inside.mean())
