"""The search for a B-spline transform: adaptive stochastic gradient descent, from coarse to fine.

Each step compares a few points that are drawn anew, so that none of their noise is followed for
long; how long a step is follows from whether steps still agree (Klein, Pluim, Staring and
Viergever, IJCV 81(3), 2009). Each point acts on the 64 control points around it. The bending
energy is kept small.
Frame: LPS [mm]; the B-spline acts on points of the fixed image, before the affine transform.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.simpleitk import simpleitk
from palpate.registration.control_points import ControlPoints, Near
from palpate.registration.image_pair import Compared
from palpate.registration.options import SearchOptions
from palpate.registration.samples import Alike, Sampled
from palpate.registration.search_history import SearchHistory
from palpate.registration.start import mask_on

__all__ = ["search_bspline"]

Array = NDArray[np.float64]

SHRINKS = (8, 4, 2, 1)
"""How many times coarser each level is than the scan."""
LONGEST_STEP = 1.0
"""How far a first step moves nearly all points, in mean edges of the fixed scan's voxels."""
DECAY = 20.0
"""Steps after which they are half as long, where none agrees with the one before."""
AGREES, DIFFERS = -0.8, 1.0
"""What a step adds to the time that makes the next ones shorter."""
TRIALS = 5
"""Draws of points from which the length of the first step is computed."""
LEAST_LASTING = 0.1
"""Share of a first step that is made in any case."""
LEAST_REACH = 1e-12
"""Displacement [mm] below which a gradient counts as zero."""
AVERAGED = 0.3
"""Share of the last steps whose mean is the end of a level: that takes noise out."""
LEAST_POINTS = 0.02
"""Share of the points that must fall into the moving image."""


class TooFewPointsError(Exception):
    """The images do not overlap."""


def search_bspline(
    compared: Compared,
    first: Any,  # noqa: ANN401  # SimpleITK has no types
    *,
    options: SearchOptions,
    history: SearchHistory,
    share: Callable[[float], float],
) -> Any:  # noqa: ANN401
    """Returns a B-spline before an affine transform; its control points get denser on each level.

    ``share`` maps the share of this stage that is done to that of the whole search, both 0..1.

    Raises:
        RegistrationError: The scans do not overlap.
    """
    fixed, steps = compared.images[0], options.bent_iterations
    shrinks = compared.shrinks(SHRINKS)
    reach = np.multiply(fixed.GetSize(), fixed.GetSpacing())
    across, down, deep = np.maximum(np.rint(reach / options.knots / 2 ** (len(shrinks) - 1)), 1)
    control_points = ControlPoints(fixed, (int(across), int(down), int(deep)))
    coefficients = np.zeros((control_points.count, 3))
    for number, shrink in enumerate(shrinks):
        if number > 0:
            control_points, coefficients = control_points.finer(coefficients)
        search = BSplineLevel(compared, shrink, first, bending=options.bending)
        voxels = float(np.prod(search.fixed.size))
        level = history.begin("bspline", shrink, options.bent_samples / voxels)
        draw = np.random.default_rng([options.seed, number])
        try:
            for value, found in search.descend(
                control_points, coefficients, steps=steps, points=options.bent_samples, draw=draw
            ):
                coefficients = found
                done = len(level.values) + 1
                history.step(level, value, share((number + done / steps) / len(shrinks)))
        except TooFewPointsError:
            raise history.no_overlap("hardly a point of one lies in the other") from None
    # what was added last is applied first
    return simpleitk().CompositeTransform([first, control_points.transform(coefficients)])


class BSplineLevel:
    """The search on one level."""

    def __init__(
        self,
        compared: Compared,
        shrink: int,
        first: Any,  # noqa: ANN401
        *,
        bending: float,
    ) -> None:
        """Begins with an affine transform; ``bending`` weights the bending energy [mm²]."""
        fixed, moving = compared.level(shrink)
        self.fixed, self._moving = Sampled(fixed), Sampled(moving)
        self._alike = Alike(
            compared.metric, compared.bins, self.fixed.values_range, self._moving.values_range
        )
        self._bending = bending
        corners = np.vstack([np.zeros(3), np.eye(3)])
        origin, *ends = (np.array(first.TransformPoint(corner)) for corner in corners.tolist())
        self._linear, self._shift = (np.array(ends) - origin).T, origin
        still, other = compared.masks
        self._mask = None if still is None else _places(mask_on(still, fixed))
        self._moving_mask = None if other is None else Sampled(other)
        self._longest = LONGEST_STEP * float(np.mean(compared.images[0].GetSpacing()))

    def descend(
        self,
        control_points: ControlPoints,
        coefficients: Array,
        *,
        steps: int,
        points: int,
        draw: np.random.Generator,
    ) -> Iterator[tuple[float, Array]]:
        """Yields the metric and the coefficients after each step; the last are the end.

        Raises:
            TooFewPointsError: The images do not overlap.
        """
        first_step = self._first_step(control_points, coefficients, draw, points=points)
        when, before = 0.0, np.zeros_like(coefficients)
        mean, averaged = np.zeros_like(coefficients), max(1, round(AVERAGED * steps))
        for number in range(steps):
            value, slope, near = self._slope(
                control_points, coefficients, self._drawn(draw, points)
            )
            agrees = float((slope * before).sum()) > 0.0
            when = max(0.0, when + (AGREES if agrees else DIFFERS))
            # where the way began nearly level, slopes that come later may be far steeper
            step = min(first_step, self._longest / max(_reach(near, slope), LEAST_REACH))
            coefficients = coefficients - step / (1.0 + when / DECAY) * slope
            before = slope
            if number >= steps - averaged:
                mean += coefficients / averaged
            yield value, mean if number == steps - 1 else coefficients

    def _first_step(
        self,
        control_points: ControlPoints,
        coefficients: Array,
        draw: np.random.Generator,
        *,
        points: int,
    ) -> float:
        """Returns the factor with which a step moves nearly all points by less than the longest.

        The share of the slope that other points would not change makes it shorter: near the end
        of the way there is little but noise.
        """
        lengths, slopes = [], []
        for _ in range(TRIALS):
            _, slope, near = self._slope(control_points, coefficients, self._drawn(draw, points))
            lengths.append(_reach(near, slope))
            slopes.append(slope)
        length, square = float(np.mean(lengths)), float(np.mean([np.sum(s * s) for s in slopes]))
        if length <= LEAST_REACH:
            return 0.0
        of_mean = float(np.sum(np.mean(slopes, axis=0) ** 2))
        lasting = (TRIALS * of_mean - square) / ((TRIALS - 1) * square)
        factor: float = max(LEAST_LASTING, lasting) * self._longest / length
        return factor

    def _drawn(self, draw: np.random.Generator, count: int) -> Array:
        """Returns points of the fixed image, as indices of its voxels."""
        size = self.fixed.size
        if self._mask is None:
            anywhere: Array = draw.random((count, 3)) * (size - 1)
            return anywhere
        chosen = self._mask[draw.integers(len(self._mask), size=count)]
        points: Array = np.clip(chosen + draw.random((count, 3)) - 0.5, 0.0, size - 1)
        return points

    def _slope(
        self, control_points: ControlPoints, coefficients: Array, drawn: Array
    ) -> tuple[float, Array, Near]:
        """Returns the metric, its slope by the coefficients, and what the points depend on."""
        points = self.fixed.points(drawn)
        near = control_points.near(points)
        places = (points + near.moved(coefficients)) @ self._linear.T + self._shift
        index = self._moving.index(places)
        counts = self._moving.inside(index)
        if self._moving_mask is not None:
            counts &= _in_mask(self._moving_mask, places)
        if counts.sum() < LEAST_POINTS * len(drawn):
            raise TooFewPointsError
        still, _ = self.fixed.read(drawn[counts])
        other, uphill = self._moving.read(index[counts])
        value, slopes = self._alike.at(still, other)
        pulls = np.zeros_like(points)
        pulls[counts] = slopes[:, None] * (uphill @ self._linear)
        energy, unbend = control_points.bending(coefficients)
        slope = near.gathered(pulls, control_points.count) + self._bending * unbend
        return value + self._bending * energy, slope, near


def _reach(near: Near, slope: Array) -> float:
    """Returns how far a slope moves nearly all points that are near control points."""
    moved = np.linalg.norm(near.moved(slope), axis=1)
    return float(moved.mean() + 2.0 * moved.std())


def _places(mask: Any) -> Array:  # noqa: ANN401
    """Returns the voxels of a mask as indices x, y, z."""
    there = np.argwhere(Sampled(mask).values != 0)
    if len(there) == 0:
        raise TooFewPointsError
    places: Array = there[:, ::-1].astype(np.float64)
    return places


def _in_mask(mask: Sampled, points: Array) -> NDArray[np.bool_]:
    index = np.rint(mask.index(points)).astype(np.intp)
    there: NDArray[np.bool_] = np.all((index >= 0) & (index < mask.size), axis=1)
    x, y, z = np.where(there[:, None], index, 0).T
    inside: NDArray[np.bool_] = there & (mask.values[z, y, x] != 0)
    return inside
