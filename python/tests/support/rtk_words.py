"""Projections and geometry files by the words of RTK's documentation alone, not by the program.

"3D Circular Projection Geometry": the frame is that of IEC 61217 (x to the left of a patient in
supine position, y to the head, z to the front). Source and detector are turned by the gantry about
y, then about x out of the plane, then about z in the plane. In the turned frame the source is at
(SourceOffsetX, SourceOffsetY, SourceToIsocenterDistance), and the detector's origin at
(ProjectionOffsetX, ProjectionOffsetY, SourceToIsocenterDistance - SourceToDetectorDistance).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

__all__ = ["ball_images", "matrix_of", "write_geometry"]

Values = NDArray[np.float64]
Stated = Mapping[str, float]
WATER = 0.0206


def _turned(stated: Stated) -> Values:
    """Axes of the turned frame, in rows.

    All angles are right-handed: clockwise seen along y is from z to x, counter-clockwise seen from
    positive x is from y to z, and counter-clockwise seen from the source is from x to y.
    """
    angles = [stated.get(name, 0.0) for name in ("GantryAngle", "OutOfPlaneAngle", "InPlaneAngle")]
    return np.asarray(Rotation.from_euler("YXZ", angles, degrees=True).as_matrix().T)


def _places(stated: Stated, u: Values, v: Values) -> tuple[Values, Values]:
    """The source, and pixels of the detector, in the fixed frame; parallel beams have no source."""
    near, far = stated["SourceToIsocenterDistance"], stated["SourceToDetectorDistance"]
    axes = _turned(stated)
    source = np.array([stated.get("SourceOffsetX", 0.0), stated.get("SourceOffsetY", 0.0), near])
    across, up = stated.get("ProjectionOffsetX", 0.0) + u, stated.get("ProjectionOffsetY", 0.0) + v
    deep = np.full_like(across, near - far if far else -near)
    return source @ axes, np.stack([across, up, deep], axis=-1) @ axes


def matrix_of(stated: Stated) -> Values:
    """The matrix that takes a point to where its ray meets the detector, times its depth.

    Depth is z of the point less that of the source; columns are steps along x, y, z.
    """
    axes = _turned(stated)
    near, far = stated["SourceToIsocenterDistance"], stated["SourceToDetectorDistance"]
    side = np.array([stated.get("SourceOffsetX", 0.0), stated.get("SourceOffsetY", 0.0)])
    origin = [stated.get("ProjectionOffsetX", 0.0), stated.get("ProjectionOffsetY", 0.0)]

    def met(point: Values) -> Values:
        x, y, z = axes @ point
        if far == 0.0:
            return np.array([x - origin[0], y - origin[1], 1.0])
        share = far / (near - z)
        u, v = side + share * (np.array([x, y]) - side) - origin
        return np.asarray(np.array([u, v, 1.0]) * (z - near))

    start = met(np.zeros(3))
    return np.column_stack([*(met(step) - start for step in np.eye(3)), start])


def ball_images(
    geometry: Sequence[Stated],
    ball: Sequence[float],
    radius: float,
    *,
    pixel: tuple[float, float],
    shape: tuple[int, int],
    middle: tuple[float, float] = (0.0, 0.0),
) -> Values:
    """Line integrals through a ball of water at a place of the patient (LPS) [mm].

    Args:
        geometry: What a file states of each projection.
        ball: Its middle.
        radius: Its radius [mm].
        pixel: Pixel size along u and v [mm].
        shape: Rows and columns.
        middle: u and v of the detector's middle [mm].
    """
    left, back, head = ball
    place = np.array([left, head, -back])
    rows, columns = shape
    u, v = np.meshgrid(
        middle[0] + pixel[0] * (np.arange(columns) - 0.5 * (columns - 1)),
        middle[1] + pixel[1] * (np.arange(rows) - 0.5 * (rows - 1)),
    )
    found = []
    for stated in geometry:
        source, pixels = _places(stated, u, v)
        way = pixels - source
        if stated["SourceToDetectorDistance"] == 0.0:
            way = np.broadcast_to(-_turned(stated)[2], pixels.shape)
        way = way / np.linalg.norm(way, axis=-1, keepdims=True)
        to_ball = place - pixels
        missed = (to_ball**2).sum(-1) - (to_ball * way).sum(-1) ** 2
        found.append(WATER * 2.0 * np.sqrt(np.maximum(radius**2 - missed, 0.0)))
    return np.array(found)


def write_geometry(
    path: Path, geometry: Sequence[Stated], *, version: int = 3, shared: Sequence[str] = ()
) -> Path:
    """Writes a file as RTK does: what is shared once, the rest with each projection."""
    lines = [
        '<?xml version="1.0"?>',
        "<!DOCTYPE RTKGEOMETRY>",
        f'<RTKThreeDCircularGeometry version="{version}">',
        *(f"  <{name}>{geometry[0][name]:.15g}</{name}>" for name in shared),
    ]
    for stated in geometry:
        own = [f"    <{name}>{stated[name]:.15g}</{name}>" for name in stated if name not in shared]
        rows = [
            "      " + " ".join(f"{number:.15g}" for number in row) for row in matrix_of(stated)
        ]
        lines += ["  <Projection>", *own, "    <Matrix>", *rows, "    </Matrix>", "  </Projection>"]
    path.write_text("\n".join([*lines, "</RTKThreeDCircularGeometry>", ""]), "utf-8")
    return path
