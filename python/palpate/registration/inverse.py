"""The inverse of a transform: exact where it is linear, else a field of displacements.

The field lies over the linear inverse, so that beyond it points go where that takes them. How far
the inverse is off is measured between the nodes of the field.

Frame: LPS [mm].
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from palpate.base.errors import OptionError
from palpate.base.simpleitk import simpleitk
from palpate.registration.options import Points
from palpate.registration.point_map import (
    CLOSE_ENOUGH,
    linear_part,
    matrix_of,
    points_before,
    points_through,
)
from palpate.volumes.volume import Volume

__all__ = ["Inverse", "inverse_of"]

MOST_NODES = 400_000
"""Of a field: as text it takes some 25 MB."""
PROBES = 4000
"""Places at which the error is measured."""


@dataclass(frozen=True)
class Inverse:
    """An inverse transform, and how far it is off."""

    transform: Any
    """SimpleITK's, from points of the moving scan to those of the fixed one."""
    exact: bool
    error_mean: float = 0.0
    """How far from where they began points end, there and back [mm]."""
    error_most: float = 0.0
    """The largest of 99 in 100 of them [mm]."""
    lost: float = 0.0
    """Share of the places to which the transform takes no point, 0..1."""

    @property
    def report(self) -> dict[str, Any]:
        """How good it is, ready for JSON."""
        return {
            "exact": self.exact,
            "error_mean_mm": self.error_mean,
            "error_of_99_in_100_mm": self.error_most,
            "share_without_a_place": self.lost,
        }

    @property
    def sentence(self) -> str:
        """Says how good it is."""
        if self.exact:
            return "the inverse is exact"
        said = (
            f"the inverse is a field of displacements: there and back points are off by "
            f"{self.error_mean:.2g} mm on average, 99 of 100 by at most {self.error_most:.2g} mm"
        )
        if self.lost < 0.0005:
            return said
        return f"{said}; {self.lost:.1%} of the scan has no place of its own in the other"


def inverse_of(transform: Any, moving: Volume | None) -> Inverse:  # noqa: ANN401  # SimpleITK has no types
    """Returns the inverse of a transform.

    Args:
        transform: SimpleITK's, from points of the fixed scan to those of the moving one [mm].
        moving: The moving scan, over which the inverse of a transform that bends must hold.

    Raises:
        OptionError: The transform flattens, or folds, or bends and there is no moving scan.
    """
    if transform.IsLinear():
        points_before(transform, np.zeros((1, 3)))
        return Inverse(transform.GetInverse(), exact=True)
    if moving is None:
        raise OptionError(
            "the inverse of a transform that bends needs the grid of the moving scan; allowed: "
            "with that (`inverse=True` and `like=MOVING`)"
        )
    sitk = simpleitk()
    there = matrix_of(linear_part(transform))
    random = np.random.default_rng(1)
    probes = _places_in(moving, random.uniform(size=(PROBES, 3)))
    truth, apart = points_before(transform, probes)
    sound = apart <= CLOSE_ENOUGH
    if not sound.any():
        raise OptionError(
            "a transform that folds the scan given; allowed: one that takes no two points to one"
        )
    # one matrix: files hold no transforms within transforms
    back = np.linalg.inv(there)
    linear = sitk.AffineTransform(3)
    linear.SetMatrix(back[:3, :3].ravel().tolist())
    linear.SetTranslation(back[:3, 3].tolist())
    made = sitk.CompositeTransform([_field(transform, there, moving=moving), linear])
    off = np.linalg.norm(points_through(made, probes[sound]) - truth[sound], axis=1)
    return Inverse(
        made,
        exact=False,
        error_mean=float(off.mean()),
        error_most=float(np.percentile(off, 99.0)),
        lost=1.0 - float(sound.mean()),
    )


def _field(transform: Any, there: Points, *, moving: Volume) -> Any:  # noqa: ANN401
    """Returns the displacements that lead from the linear inverse to the true one."""
    sitk = simpleitk()
    corners = np.stack(np.meshgrid(*([0.0, 1.0],) * 3), axis=-1).reshape(-1, 3)
    back = np.linalg.inv(there)
    seen = _places_in(moving, corners) @ back[:3, :3].T + back[:3, 3]
    low, high = seen.min(axis=0), seen.max(axis=0)
    step = max(float(np.prod(high - low) / MOST_NODES) ** (1.0 / 3.0), min(moving.spacing))
    size = np.ceil((high - low) / step).astype(int) + 1
    x, y, z = (low[axis] + step * np.arange(size[axis]) for axis in range(3))
    nodes = np.stack(np.meshgrid(z, y, x, indexing="ij"), axis=-1).reshape(-1, 3)[:, ::-1]
    points, _ = points_before(transform, nodes @ there[:3, :3].T + there[:3, 3])
    shifts = (points - nodes).reshape(*size[::-1], 3)
    field = sitk.GetImageFromArray(shifts, isVector=True)
    field.SetOrigin(low.tolist())
    field.SetSpacing([step] * 3)
    return sitk.DisplacementFieldTransform(field)


def _places_in(volume: Volume, shares: Points) -> Points:
    """Returns places at shares 0..1 of a scan along its axes [mm]."""
    grid = shares * volume.dimensions
    places: Points = grid @ volume.patient_from_grid[:3, :3].T + volume.patient_from_grid[:3, 3]
    return places
