"""Where the body stands in a scan, so that air around it does not make it small in a picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.pictures.looks import looks
from palpate.volumes.volume import Volume

__all__ = ["Extent", "extent_of"]

EDGE = 8
"""Voxels along an edge of a brick."""
DIRECTIONS = 96
"""In which the farthest brick is looked for."""


@dataclass(frozen=True)
class Extent:
    """The space that is shown. Frame: patient, LPS mm."""

    outline: NDArray[np.float64]
    """Points around it, shape [count, 3]."""

    @property
    def centre(self) -> NDArray[np.float64]:
        """Middle of the box around it, shape [3]."""
        middle: NDArray[np.float64] = (self.outline.min(axis=0) + self.outline.max(axis=0)) / 2.0
        return middle

    @property
    def radius(self) -> float:
        """Of the ball about the middle [mm]."""
        return float(np.linalg.norm(self.outline - self.centre, axis=1).max())


def extent_of(volume: Volume) -> Extent:
    """Returns the space of all that is no air, as the page finds it (content_hull.ts)."""
    anchors = volume.anchors
    air = anchors.soft_tissue + looks().framing.air * (anchors.bone - anchors.soft_tissue)
    held = np.argwhere(_filled_bricks(volume, air))[:, ::-1]
    points = _outermost(held, volume) if len(held) else _corners(volume)
    matrix = volume.patient_from_grid
    return Extent(points @ matrix[:3, :3].T + matrix[:3, 3])


def _filled_bricks(volume: Volume, air: float) -> NDArray[np.bool_]:
    """Returns which bricks hold a value above air, with the voxels around them, [z, y, x]."""
    values = volume.array
    limit = (air - volume.intercept) / volume.slope
    layers = []
    for z in range(0, values.shape[0], EDGE):
        slab = values[max(0, z - 1) : z + EDGE + 1]
        held = slab.max(axis=0) >= limit if volume.slope > 0 else slab.min(axis=0) <= limit
        layers.append(_any_nearby(_any_nearby(held).T).T)
    return np.stack(layers)


def _any_nearby(held: NDArray[Any]) -> NDArray[np.bool_]:
    """Returns for each brick of rows whether one of them is held, or one beside them."""
    starts = range(0, len(held), EDGE)
    return np.stack([held[max(0, at - 1) : at + EDGE + 1].any(axis=0) for at in starts])


def _outermost(bricks: NDArray[np.intp], volume: Volume) -> NDArray[np.float64]:
    """Returns the centres of the outermost bricks in many directions [grid]."""
    if (np.ptp(bricks, axis=0) == 0).any():
        # bricks in one layer: their centres would tell no size
        return _corners(volume)
    centres = (bricks + 0.5) * EDGE
    reach = centres * np.asarray(volume.spacing) @ _even_directions().T
    outermost: NDArray[np.float64] = centres[reach.argmax(axis=0)]
    return outermost


def _even_directions() -> NDArray[np.float64]:
    """Returns unit vectors spread over the sphere (Fibonacci lattice; Álvaro González 2010)."""
    numbers = np.arange(DIRECTIONS)
    z = 1.0 - (2.0 * numbers + 1.0) / DIRECTIONS
    angle = np.pi * (3.0 - np.sqrt(5.0)) * numbers
    radius = np.sqrt(1.0 - z * z)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z])


def _corners(volume: Volume) -> NDArray[np.float64]:
    """Returns the corners of the scan [grid]."""
    corners = np.array(list(np.ndindex(2, 2, 2)), np.float64)
    return corners * np.asarray(volume.dimensions, np.float64)
