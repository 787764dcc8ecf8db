"""Cameras by the names of views, framed as the page frames them (camera.ts)."""

from __future__ import annotations

import math

import msgspec
import numpy as np
from numpy.typing import NDArray

from palpate.pictures.camera import Camera, Point
from palpate.pictures.choices import Size, View
from palpate.pictures.extent import Extent
from palpate.pictures.looks import looks

__all__ = ["camera_of", "framed", "orbited", "turned"]

Vector = NDArray[np.float64]

SIDES: dict[str, tuple[float, float, float]] = {
    "anterior": (0.0, -1.0, 0.0),
    "posterior": (0.0, 1.0, 0.0),
    "left": (1.0, 0.0, 0.0),
    "right": (-1.0, 0.0, 0.0),
    "superior": (0.0, 0.0, 1.0),
    "inferior": (0.0, 0.0, -1.0),
}
"""Directions of the patient, LPS."""


def camera_of(view: View, extent: Extent, size: Size, *, orthographic: bool = False) -> Camera:
    """Returns a camera that shows all of the content from a side."""
    side = "anterior" if view == "first" else view
    up = SIDES["anterior"] if side in {"superior", "inferior"} else SIDES["superior"]
    back = np.array(SIDES[side])
    right = _unit(np.cross(np.array(up), back))
    camera = Camera(
        target=_point(extent.centre),
        distance=1.0,
        right=_point(right),
        up=_point(np.cross(back, right)),
        back=_point(back),
        field=math.radians(looks().framing.field_degrees),
    )
    if view == "first":
        camera = orbited(framed(camera, extent, size), *looks().framing.first_turn)
    camera = framed(camera, extent, size)
    if not orthographic:
        return camera
    # far enough before all content
    apart = float(np.linalg.norm(np.array(camera.target) - extent.centre))
    return _with(camera, parallel=4.0 * extent.radius + apart)


def framed(camera: Camera, extent: Extent, size: Size) -> Camera:
    """Moves a camera, without turning it, so that it just shows the content in its middle."""
    axes = np.array([camera.right, camera.up, camera.back])
    along = extent.outline @ axes.T
    middle = (along.min(axis=0) + along.max(axis=0)) / 2.0 @ axes
    return _with(
        camera, target=_point(middle), distance=_distance(camera, extent.outline - middle, size)
    )


def _distance(camera: Camera, offset: Vector, size: Size) -> float:
    """Returns the distance from which all points are seen, given from the target [mm]."""
    along = offset @ np.array([camera.right, camera.up, camera.back]).T
    vertical = math.tan(camera.field / 2.0) * looks().framing.filled
    horizontal = vertical * size[0] / size[1]
    needed = np.maximum(abs(along[:, 0]) / horizontal, abs(along[:, 1]) / vertical)
    if camera.parallel is None:
        needed = needed + along[:, 2]
    return float(needed.max())


def orbited(camera: Camera, horizontal: float, vertical: float) -> Camera:
    """Turns the picture as if its content were dragged by these angles [rad]."""
    upright = 1.0 if camera.up[2] >= 0.0 else -1.0
    about_body = _rotated(camera, np.array(SIDES["superior"]), -horizontal * upright)
    return _rotated(about_body, np.array(about_body.right), -vertical)


def turned(camera: Camera, extent: Extent, size: Size, *, count: int) -> list[Camera]:
    """Returns cameras once around the body's long axis, all as near as the whole turn allows."""
    around = [orbited(camera, math.tau * i / count, 0.0) for i in range(count)]
    middle = extent.centre
    farthest = max(_distance(each, extent.outline - middle, size) for each in around)
    return [_with(each, target=_point(middle), distance=farthest) for each in around]


def _rotated(camera: Camera, axis: Vector, angle: float) -> Camera:
    right = _unit(_about(np.array(camera.right), axis, angle))
    back = _unit(_about(np.array(camera.back), axis, angle))
    return _with(camera, right=_point(right), up=_point(np.cross(back, right)), back=_point(back))


def _about(vector: Vector, axis: Vector, angle: float) -> Vector:
    """Rotates a vector about a unit axis (Rodrigues)."""
    along = axis * (axis @ vector) * (1.0 - math.cos(angle))
    rotated: Vector = vector * math.cos(angle) + np.cross(axis, vector) * math.sin(angle) + along
    return rotated


def _with(camera: Camera, **changes: object) -> Camera:
    return msgspec.structs.replace(camera, **changes)


def _unit(vector: Vector) -> Vector:
    unit: Vector = vector / np.linalg.norm(vector)
    return unit


def _point(vector: Vector) -> Point:
    x, y, z = (float(number) for number in vector)
    return x, y, z
