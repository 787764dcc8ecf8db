"""Cubic B-splines on a grid of control points: how points move that lie between them.

Frames: patient, LPS [mm]; places on the grid of control points are counted in steps of it from the
corner of the fixed image. Coefficients have shape [control points, 3]: the displacement of each
[mm], with x fastest. Source: Rueckert et al., IEEE TMI 18(8), 1999.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.simpleitk import simpleitk

__all__ = ["ControlPoints", "Near"]

Array = NDArray[np.float64]

BEYOND = 3
"""Control points along an axis besides one for each step: a cubic spline reaches so far."""


@dataclass(frozen=True)
class Near:
    """The 64 control points around each point, and their weights; shape [points, 64]."""

    control_points: NDArray[np.intp]
    weights: Array

    def moved(self, coefficients: Array) -> Array:
        """Returns how far the points move, shape [points, 3] [mm]."""
        moved: Array = np.einsum("pk,pkc->pc", self.weights, coefficients[self.control_points])
        return moved

    def gathered(self, pulls: Array, count: int) -> Array:
        """Returns what pulls at points, shape [points, 3], are to ``count`` control points."""
        control_points = self.control_points.ravel()
        columns = [
            np.bincount(control_points, (self.weights * pull[:, None]).ravel(), count)
            for pull in pulls.T
        ]
        return np.stack(columns, axis=1)


class ControlPoints:
    """A grid of control points over an image."""

    def __init__(self, image: Any, steps: tuple[int, int, int]) -> None:  # noqa: ANN401
        """Divides SimpleITK's image into so many steps along x, y, z."""
        self._image = image
        self.steps = steps
        self.axes = np.reshape(image.GetDirection(), (3, 3))
        self.lengths = np.multiply(image.GetSize(), image.GetSpacing())
        """Lengths of the image along its axes [mm]."""
        half = 0.5 * np.array(image.GetSpacing())
        self.corner = np.array(image.GetOrigin()) - self.axes @ half
        self.step = self.lengths / steps
        """Spacing of control points [mm]."""
        self.shape = tuple(count + BEYOND for count in reversed(steps))
        """Control points along z, y, x."""
        self.count = int(np.prod(self.shape))

    def near(self, points: Array) -> Near:
        """Returns the control points around points inside of the image, shape [points, 3] [mm]."""
        places = (points - self.corner) @ self.axes / self.step
        first = np.clip(np.floor(places).astype(np.intp), 0, np.array(self.steps) - 1)
        x, y, z = np.moveaxis(_cubic(places - first), 1, 0)
        weights = z[:, :, None, None] * y[:, None, :, None] * x[:, None, None, :]
        along = np.arange(4)
        _, rows, columns = self.shape
        deep = first[:, 2, None] + along
        down = first[:, 1, None] + along
        across = first[:, 0, None] + along
        control_points = (deep[:, :, None] * rows + down[:, None, :])[..., None] * columns
        control_points = control_points + across[:, None, None, :]
        return Near(control_points.reshape(-1, 64), weights.reshape(-1, 64))

    def finer(self, coefficients: Array) -> tuple[ControlPoints, Array]:
        """Returns control points twice as dense, and coefficients of the same displacements."""
        x, y, z = self.steps
        finer = coefficients.reshape(*self.shape, 3)
        for axis in range(3):
            finer = _halved(finer, axis)
        return ControlPoints(self._image, (2 * x, 2 * y, 2 * z)), finer.reshape(-1, 3)

    def bending(self, coefficients: Array) -> tuple[float, Array]:
        """Returns the mean of the squared second derivatives [1/mm²], and its gradient.

        Derivatives are those of the spline's control points: differences of coefficients.
        """
        grid = coefficients.reshape(*self.shape, 3)
        steps = self.step[::-1]
        energy, gradient = 0.0, np.zeros_like(grid)
        for first in range(3):
            for other in range(first, 3):
                length = steps[first] * steps[other]
                bent, twice = _differences(grid, first, other) / length, 1.0 + (first != other)
                energy += twice * float(np.square(bent).sum())
                _add_back(gradient, 2.0 * twice / length * bent, first=first, other=other)
        return energy / self.count, (gradient / self.count).reshape(-1, 3)

    def transform(self, coefficients: Array) -> Any:  # noqa: ANN401  # SimpleITK has no types
        """Returns SimpleITK's transform with these coefficients."""
        bent = simpleitk().BSplineTransform(3, 3)
        bent.SetTransformDomainOrigin(self.corner.tolist())
        bent.SetTransformDomainDirection(self.axes.ravel().tolist())
        bent.SetTransformDomainPhysicalDimensions(self.lengths.tolist())
        bent.SetTransformDomainMeshSize([int(count) for count in self.steps])
        bent.SetParameters(coefficients.T.ravel().tolist())
        return bent


def _cubic(t: Array) -> Array:
    """Returns the weights of four control points at shares 0..1 of a step, on a new last axis."""
    rest = 1.0 - t
    return (
        np.stack(
            [
                rest**3,
                3.0 * t**3 - 6.0 * t**2 + 4.0,
                3.0 * rest**3 - 6.0 * rest**2 + 4.0,
                t**3,
            ],
            axis=-1,
        )
        / 6.0
    )


def _halved(grid: Array, axis: int) -> Array:
    """Returns coefficients of twice the density (Lane, Riesenfeld, IEEE PAMI 2(1), 1980)."""
    old = np.moveaxis(grid, axis, 0)
    new = np.empty((2 * len(old) - BEYOND, *old.shape[1:]))
    new[0::2] = 0.5 * (old[:-1] + old[1:])
    new[1::2] = 0.125 * old[:-2] + 0.75 * old[1:-1] + 0.125 * old[2:]
    return np.moveaxis(new, 0, axis)


def _differences(grid: Array, first: int, other: int) -> Array:
    if first == other:
        return np.diff(grid, n=2, axis=first)
    return np.diff(np.diff(grid, axis=first), axis=other)


def _add_back(gradient: Array, bent: Array, *, first: int, other: int) -> None:
    """Adds what differences are to their control points: the transpose of ``_differences``."""
    ways = ((0, 1.0), (1, -2.0), (2, 1.0)) if first == other else ((0, -1.0), (1, 1.0))
    for at, sign in ways:
        if first == other:
            _part(gradient, bent.shape, {first: at})[...] += sign * bent
        else:
            for beside, turned in ways:
                _part(gradient, bent.shape, {first: at, other: beside})[...] += sign * turned * bent


def _part(grid: Array, shape: tuple[int, ...], starts: dict[int, int]) -> Array:
    """Returns the part of a grid of a shape that begins so far along some axes."""
    return grid[
        tuple(
            slice(starts.get(axis, 0), starts.get(axis, 0) + length)
            for axis, length in enumerate(shape)
        )
    ]
