"""Ellipsoids whose line integrals are known exactly: as projections, and in HU."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from palpate.reconstruction.beams import WATER, Beam
from palpate.reconstruction.scanner import Scanner

__all__ = ["SHAPE", "SIZE", "VOXEL", "flat", "projected", "scanner_of", "truth"]

Values = NDArray[np.float64]

BODY = ((0.0, 0.0, 0.0), (42.0, 34.0, 60.0), 1.0)
"""Middle and half axes in the patient [mm], attenuation added to that of air [of water]."""
PARTS = (BODY, ((16.0, -10.0, 8.0), (9.0, 7.0, 8.0), 0.8), ((-18.0, 8.0, -10.0), (8.0,) * 3, -0.5))

SIZE, VOXEL = (48, 44, 24), (2.0, 2.0, 2.0)
SHAPE = (120, 40, 80)
SCANNERS = {
    "cone": ((2.0, 2.5), (600.0, 900.0), 360.0),
    "parallel": ((1.3, 1.6), (0.0, 0.0), 180.0),
}


def scanner_of(beam: Beam) -> Scanner:
    pixel, (near, far), arc = SCANNERS[beam]
    return Scanner(
        beam=beam,
        angles=(arc / SHAPE[0] * np.arange(SHAPE[0])).tolist(),
        pixel=pixel,
        source_to_axis=near,
        source_to_detector=far,
    )


def projected(scanner: Scanner) -> Values:
    """Line integrals through the parts, by where rays meet each ellipsoid."""
    _, rows, columns = SHAPE
    u = scanner.pixel[0] * (np.arange(columns) - 0.5 * (columns - 1))
    v = scanner.pixel[1] * (np.arange(rows) - 0.5 * (rows - 1))
    images = []
    for angle in np.radians(scanner.angles):
        # the device: y is the axis; the source goes from +z toward +x
        toward = np.array([np.sin(angle), 0.0, np.cos(angle)])
        across = np.array([np.cos(angle), 0.0, -np.sin(angle)])
        pixels = u[None, :, None] * across + v[:, None, None] * np.array([0.0, 1.0, 0.0])
        if scanner.beam == "cone":
            start = np.broadcast_to(scanner.source_to_axis * toward, pixels.shape)
            ends = pixels + (scanner.source_to_axis - scanner.source_to_detector) * toward
            way = ends - start
        else:
            start, way = pixels, np.broadcast_to(-toward, pixels.shape)
        way = way / np.linalg.norm(way, axis=-1, keepdims=True)
        seen = (_through(_in_device(part, scanner), start, way) for part in PARTS)
        images.append(sum(seen))
    found: Values = np.array(images)
    return found


Part = tuple[tuple[float, ...], tuple[float, ...], float]


def _in_device(part: Part, scanner: Scanner) -> Part:
    (x, y, z), (a, b, c), density = part
    return (x, z, scanner.posterior * y), (a, c, b), density


def _through(part: Part, start: Values, way: Values) -> Values:
    middle, axes, density = part
    p, d = (start - middle) / np.array(axes), way / np.array(axes)
    dd, pd, pp = (d * d).sum(-1), (p * d).sum(-1), (p * p).sum(-1)
    root = np.maximum(pd * pd - dd * (pp - 1.0), 0.0)
    length: Values = 2.0 * np.sqrt(root) / dd
    return density * WATER * length


def truth() -> Values:
    """HU of the phantom at the middles of voxels."""
    z, y, x = np.indices(SIZE[::-1])
    points = (np.stack([x, y, z], axis=-1) - 0.5 * (np.array(SIZE) - 1)) * VOXEL
    water = np.zeros(points.shape[:-1])
    for middle, axes, density in PARTS:
        water += density * ((((points - middle) / axes) ** 2).sum(-1) <= 1.0)
    values: Values = 1000.0 * (water - 1.0)
    return values


def flat(values: Values) -> NDArray[np.bool_]:
    """Voxels whose neighbours all have the same value: borders are as sharp as voxels are."""
    same = np.ones(values.shape, bool)
    for axis in range(3):
        for step in (-2, -1, 1, 2):
            same &= np.roll(values, step, axis=axis) == values
    same[:4] = same[-4:] = False
    return same
