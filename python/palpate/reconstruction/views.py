"""Where source and detector are at one projection: RTK's nine parameters, and its matrix of them.

Frame: that of ``palpate.reconstruction.scanner``, which is RTK's. The rotated frame is that of the
detector, around the axis: x runs along its columns u, y along its rows v, z from it to the source.
Source: RTK's documentation, "3D Circular Projection Geometry", and IEC 61217.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError

__all__ = ["View", "largest_gap", "seen_by_all"]

ASIDE = 0.12
"""Difference between the sides of a detector, as a share of it, from which on it counts as one that
stands aside; RTK completes its projections from 0.1 on."""
AROUND = np.radians(np.arange(0.0, 360.0, 3.0))
"""Places on a circle that are projected to find whether all of it is seen."""
HALVINGS = 20
"""Steps to the radius that is seen, to a micrometre."""

Values = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class View:
    """Source and detector at one projection of a cone beam, or the detector of a parallel one."""

    angle: float
    """Of the gantry: rotation about y [degrees]."""
    out_of_plane: float = 0.0
    """Rotation about x after that of the gantry [degrees]."""
    in_plane: float = 0.0
    """Rotation about z after both [degrees]."""
    source_to_axis: float = 0.0
    """z of the source in the rotated frame [mm]."""
    source_to_detector: float = 0.0
    """[mm]; 0 for parallel beams."""
    source_offset: tuple[float, float] = (0.0, 0.0)
    """x and y of the source in the rotated frame [mm]."""
    detector_offset: tuple[float, float] = (0.0, 0.0)
    """x and y of the detector's origin in the rotated frame [mm]."""

    @property
    def rotation(self) -> Values:
        """The rotated frame from the device's, shape [3, 3]."""
        gantry, out, inside = -np.radians([self.angle, self.out_of_plane, self.in_plane])
        about_y = [
            [np.cos(gantry), 0.0, np.sin(gantry)],
            [0.0, 1.0, 0.0],
            [-np.sin(gantry), 0.0, np.cos(gantry)],
        ]
        about_x = [
            [1.0, 0.0, 0.0],
            [0.0, np.cos(out), -np.sin(out)],
            [0.0, np.sin(out), np.cos(out)],
        ]
        about_z = [
            [np.cos(inside), -np.sin(inside), 0.0],
            [np.sin(inside), np.cos(inside), 0.0],
            [0.0, 0.0, 1.0],
        ]
        return np.array(about_z) @ np.array(about_x) @ np.array(about_y)

    @property
    def matrix(self) -> Values:
        """Homogeneous u and v of the detector [mm] from points of the device, shape [3, 4]."""
        (u, v), (x, y) = self.detector_offset, self.source_offset
        near, far = self.source_to_axis, self.source_to_detector
        if far == 0.0:
            flat = np.array([[1.0, 0.0, 0.0, -u], [0.0, 1.0, 0.0, -v], [0.0, 0.0, 0.0, 1.0]])
        else:
            shift = np.array([[1.0, 0.0, x - u], [0.0, 1.0, y - v], [0.0, 0.0, 1.0]])
            enlarged = [[-far, 0.0, 0.0, 0.0], [0.0, -far, 0.0, 0.0], [0.0, 0.0, 1.0, -near]]
            from_source = np.eye(4)
            from_source[:2, 3] = -x, -y
            flat = shift @ np.array(enlarged) @ from_source
        turned = np.eye(4)
        turned[:3, :3] = self.rotation
        return flat @ turned

    @property
    def source(self) -> Values:
        """Place of the source [mm]."""
        place: Values = self.rotation.T @ np.array([*self.source_offset, self.source_to_axis])
        return place


def largest_gap(views: Sequence[View]) -> float:
    """Returns the largest angle around the axis without a source [degrees]."""
    places = np.array([view.source for view in views])
    angles = np.sort(np.degrees(np.arctan2(places[:, 0], places[:, 2])))
    return float(np.diff(angles, append=angles[0] + 360.0).max())


def seen_by_all(
    views: Sequence[View], size: tuple[float, float], middle: tuple[float, float]
) -> tuple[float, float]:
    """Returns the radius and the height around the axis that all views see [mm].

    A detector that stands aside (half-fan) shows one side of the axis farther than the other. Each
    point is on that side for about half of the views, which is enough (Wang, Med. Phys. 29(7),
    2002).

    Args:
        views: Views of a cone beam.
        size: Lengths of the detector along u and v [mm].
        middle: u and v of its middle [mm].

    Raises:
        OptionError: A view does not see the middle of the axis.
    """
    matrices = np.array([view.matrix for view in views])

    def met(points: Values) -> Values:
        """Returns u and v from the detector's middle, as shares of its half, [2, view, point]."""
        u, v, scale = np.moveaxis(matrices[:, :, :3] @ points + matrices[:, :, 3:], 1, 0)
        # what lies behind the source is nowhere
        scale = np.where(scale < 0.0, scale, np.nan)
        places = u / scale - middle[0], v / scale - middle[1]
        return np.asarray(np.array(places) / (0.5 * np.reshape(size, (2, 1, 1))))

    axis = met(np.zeros((3, 1)))
    hidden = ~(np.abs(axis) <= 1.0).all(axis=(0, 2))
    if hidden.any():
        raise OptionError(
            f"projection {np.argmax(hidden) + 1} does not show the middle of the rotation axis; "
            "allowed: a detector that the ray through it meets"
        )
    less, more = 1.0 + axis[0].min(), 1.0 - axis[0].max()
    begin = axis[0] if abs(more - less) >= ASIDE * (less + more) else np.zeros_like(axis[0])

    def sees(points: Values) -> bool:
        u, v = met(points)
        return bool(((np.abs(u - begin) <= 1.0 + np.abs(begin)) & (np.abs(v) <= 1.0)).all())

    most = min(view.source_to_axis for view in views)
    circle = np.array([np.sin(AROUND), np.zeros(len(AROUND)), np.cos(AROUND)])
    ends = np.array([[0.0, 0.0], [1.0, -1.0], [0.0, 0.0]])
    radius = _largest(lambda by: sees(by * circle), most)
    half = _largest(lambda by: sees(by * ends), most)
    return radius, 2.0 * half


def _largest(holds: Callable[[float], bool], most: float) -> float:
    """Returns the largest number up to another that something holds for, as for all below it."""
    low, high = 0.0, most
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low
