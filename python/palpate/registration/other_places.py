"""Other places in which two scans may lie: turned starts, on grids so coarse that it is quick.

A search finds the best place near its start. Turns all over are looked at by a few samples, and the
best of them searched from, on grids of 32 voxels along the longest side. A place that is clearly
more alike there than where the usual start leads shows that the search would end wrongly.

Frame: LPS [mm]; a place is SimpleITK's transform from points of the fixed scan to the moving one.

Source: turns that are spread evenly: Alexa, "Super-Fibonacci spirals: fast, low-discrepancy
sampling of SO(3)", CVPR 2022.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.simpleitk import simpleitk
from palpate.registration.image_pair import Compared, coarser
from palpate.registration.linear import SHRINKS, step_limit
from palpate.registration.options import Points
from palpate.registration.point_map import matrix_of
from palpate.registration.samples import Alike, Sampled
from palpate.registration.start import guess_of_matrix, mask_on

__all__ = ["OtherPlaces", "Place"]

LONGEST = 32
"""Voxels along the longest side of the fixed scan."""
TURNS = 400
"""So that no turn is farther than about 25 degrees from one of them."""
SAMPLES = 2000
"""Voxels by which turns are looked at."""
TRIED = 4
"""Of the best ones, from each of which is searched."""
STEPS = 60
"""Of such a search, at most."""
LAST_STEP = 0.02
"""Step at which it ends, as a share of the first."""
LEAST_SEEN = 0.6
"""Share of what is covered at the start that has to be covered elsewhere too."""
GAIN = 0.2
"""Share of the metric by which another place must be more alike to begin there."""
ALIKE = 0.02
"""Share of the metric by which another place may be less alike, and is told."""
APART = 0.1
"""Share of the longest side by which places are apart that are not the same."""
BINS = 16
"""Of a histogram of so few voxels."""
PSI = 1.533751168755204288118041
"""The second of the two irrational steps of the spiral."""


@dataclass(frozen=True)
class Place:
    """Where a search ended on the coarse grids."""

    transform: Any
    """SimpleITK's."""
    metric: float
    """Made small."""


class OtherPlaces:
    """Two scans on coarse grids, and the places that turned starts lead to."""

    def __init__(self, compared: Compared, *, seed: int) -> None:
        """Takes what is compared, and the seed of the samples."""
        # of the grids that a search goes through the coarsest, which are there for it then
        fixed, moving = compared.level(compared.shrinks(SHRINKS)[0])
        longest = max(np.multiply(fixed.GetSize(), fixed.GetSpacing()))
        self._step = float(longest) / LONGEST
        self._images = _on_step(fixed, self._step), _on_step(moving, self._step)
        self._compared = compared
        self._seed = seed
        self._fixed, self._moving = map(Sampled, self._images)
        self._seen = _inside_mask(compared.masks[1], self._images[1])
        self._points, self._values = self._sampled()
        self._alike = Alike(
            compared.metric, BINS, self._fixed.values_range, self._moving.values_range
        )
        self._places: list[Place] | None = None

    def start(self, first: Any) -> Any:  # noqa: ANN401  # SimpleITK has no types
        """Returns the usual start, or a turned one that leads to where scans are more alike."""
        usual = self._search(first)
        best = min(self.found(first), key=lambda one: one.metric, default=usual)
        clearly = best.metric < usual.metric - GAIN * self._scale(usual.metric)
        return best.transform if clearly else first

    def found(self, first: Any) -> list[Place]:  # noqa: ANN401
        """Returns where searches end that begin at the best turns.

        Args:
            first: The usual start, whose shift is one of those that turns are tried with.
        """
        if self._places is None:
            least = LEAST_SEEN * self._look(matrix_of(first))[1]
            looked = [(*self._look(matrix), matrix) for matrix in self._starts(first)]
            seen = [one for one in looked if one[1] >= least and np.isfinite(one[0])]
            best = sorted(seen, key=lambda one: one[0])[:TRIED]
            ends = [
                self._search(guess_of_matrix(self._images[0], matrix, rigid=True))
                for *_, matrix in best
            ]
            self._places = [end for end in ends if self._look(matrix_of(end.transform))[1] >= least]
        return self._places

    def doubt(self, first: Any, end: Any) -> str | None:  # noqa: ANN401
        """Says that scans are as alike in another place as where a search has ended, if so."""
        here = self._measure(end)
        far = APART * self._step * LONGEST
        moved = self._moved(end)
        others = [
            (place, float(np.linalg.norm(self._moved(place.transform) - moved, axis=1).mean()))
            for place in self.found(first)
            if place.metric < here + ALIKE * self._scale(here)
        ]
        others = [(place, away) for place, away in others if away > far]
        if not others:
            return None
        best, away = min(others, key=lambda one: one[0].metric)
        more = "more" if best.metric < here else "nearly as"
        return (
            f"the scans are {more} alike in another place, {away:.0f} mm away on average "
            f"({self._compared.metric} {best.metric:.3g} there and {here:.3g} here, on a coarse "
            "grid): look at the picture, and begin with landmarks if this place is wrong"
        )

    def _search(self, start: Any) -> Place:  # noqa: ANN401
        """Returns where a short search from a start ends."""
        sitk = simpleitk()
        transform = sitk.Euler3DTransform(start)
        method = self._compared.method()
        method.SetMetricSamplingStrategy(method.RANDOM)
        share = 2.0 * SAMPLES / self._images[0].GetNumberOfPixels()
        method.SetMetricSamplingPercentage(min(1.0, share), self._seed)
        method.SetInitialTransform(transform, inPlace=True)
        method.SetOptimizerAsRegularStepGradientDescent(
            learningRate=self._step,
            minStep=LAST_STEP * self._step,
            numberOfIterations=STEPS,
            **step_limit(method, self._step),
        )
        method.SetOptimizerScalesFromPhysicalShift()
        try:
            method.Execute(*self._images)
        except RuntimeError:
            # it left the scan
            return Place(transform, np.inf)
        return Place(transform, self._measure(transform))

    def _measure(self, transform: Any) -> float:  # noqa: ANN401
        """Returns how alike the scans are on the coarse grids."""
        sitk = simpleitk()
        method = self._compared.method()
        method.SetInitialTransform(sitk.Transform(transform), inPlace=False)
        try:
            return float(method.MetricEvaluate(*self._images))
        except RuntimeError:
            return np.inf

    def _scale(self, metric: float) -> float:
        """Returns what a difference of the metric counts against."""
        by_values = self._compared.metric == "mean-squares"
        return float(np.var(self._values)) if by_values else abs(metric)

    def _moved(self, transform: Any) -> Points:  # noqa: ANN401
        """Returns where some of the samples come to lie, shape [count, 3] [mm]."""
        some = self._points[: len(self._points) // 10 + 1].tolist()
        return np.array([transform.TransformPoint(point) for point in some])

    def _sampled(self) -> tuple[Points, Points]:
        """Returns voxels of the fixed scan, or of its mask: points [mm] and values."""
        there = _inside_mask(self._compared.masks[0], self._images[0])
        places = np.argwhere(np.ones(self._fixed.values.shape, bool) if there is None else there)
        chosen = np.random.default_rng(self._seed).permutation(len(places))[:SAMPLES]
        z, y, x = places[chosen].T
        values = self._fixed.values[z, y, x].astype(np.float64)
        return self._fixed.points(np.stack([x, y, z], axis=1).astype(np.float64)), values

    def _look(self, matrix: Points) -> tuple[float, float]:
        """Returns how alike the samples are by their nearest voxels, and the share covered."""
        index = self._moving.index(self._points @ matrix[:3, :3].T + matrix[:3, 3])
        inside = self._moving.inside(index)
        x, y, z = np.rint(index[inside]).astype(np.intp).T
        fixed, moving = self._values[inside], self._moving.values[z, y, x].astype(np.float64)
        if self._seen is not None:
            seen = self._seen[z, y, x]
            fixed, moving = fixed[seen], moving[seen]
        share = len(fixed) / max(1, len(self._values))
        return (self._alike.at(fixed, moving)[0] if len(fixed) else np.inf), share

    def _starts(self, first: Any) -> Iterator[Points]:  # noqa: ANN401
        """Yields turns about the middle of the grids and about the middle of what is bright."""
        middle = self._fixed.points((self._fixed.size - 1) / 2.0)
        shifts = [(middle, np.asarray(first.TransformPoint(middle.tolist())))]
        heavy = [
            _bright(image, mask)
            for image, mask in zip(self._images, self._compared.masks, strict=True)
        ]
        shifts.append((heavy[0], heavy[1]))
        for turn in turns(TURNS):
            for here, there in shifts:
                matrix = np.eye(4)
                matrix[:3, :3] = turn
                matrix[:3, 3] = there - turn @ here
                yield matrix


def turns(count: int) -> Points:
    """Returns turns that are spread evenly, as matrices, shape [count, 3, 3]."""
    place = np.arange(count) + 0.5
    inner, outer = np.sqrt(place / count), np.sqrt(1.0 - place / count)
    one, other = 2.0 * np.pi * place / np.sqrt(2.0), 2.0 * np.pi * place / PSI
    x, y = inner * np.sin(one), inner * np.cos(one)
    z, w = outer * np.sin(other), outer * np.cos(other)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


def _on_step(image: Any, step: float) -> Any:  # noqa: ANN401
    """Returns an image on a grid with about one step between voxels [mm]."""
    return coarser(image, [max(1, round(step / edge)) for edge in image.GetSpacing()])


def _inside_mask(mask: Any, image: Any) -> NDArray[np.bool_] | None:  # noqa: ANN401
    """Returns which voxels of an image are in its mask; None where there is none."""
    if mask is None:
        return None
    inside: NDArray[np.bool_] = simpleitk().GetArrayFromImage(mask_on(mask, image)) != 0
    return inside


def _bright(image: Any, mask: Any) -> Points:  # noqa: ANN401
    """Returns the middle of the values above the lowest [mm]."""
    seen = Sampled(image)
    weights = seen.values - seen.values.min()
    there = _inside_mask(mask, image)
    weights = weights if there is None else weights * there
    if not weights.any():
        weights = np.ones_like(weights)
    z, y, x = np.indices(weights.shape).reshape(3, -1)
    middle = np.average(np.stack([x, y, z], axis=1), axis=0, weights=weights.ravel())
    return seen.points(middle)
