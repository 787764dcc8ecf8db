"""Options of a registration, its curve on each level, and its error."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError, PalpateError
from palpate.registration.choices import (
    KINDS,
    METRICS,
    STARTS,
    Kind,
    Metric,
    MetricChoice,
    Start,
)

__all__ = [
    "KINDS",
    "METRICS",
    "STARTS",
    "Curve",
    "Kind",
    "Level",
    "Metric",
    "MetricChoice",
    "Pairs",
    "Points",
    "RegistrationError",
    "SearchOptions",
    "Start",
    "Watch",
    "check_choices",
    "checked_landmarks",
    "checked_matrix",
    "unwatched",
]

Points = NDArray[np.float64]
Pairs = tuple[Sequence[Sequence[float]], Sequence[Sequence[float]]]
"""Points of the fixed scan, and the same places in the moving one [mm]."""

LEAST_DETERMINANT = 1e-6
"""Smallest determinant of a matrix to start from."""
LEAST_PAIRS = 3
"""Fewest pairs of landmarks that determine a rigid transform."""


@dataclass(frozen=True)
class Level:
    """The metric on one level of one stage."""

    stage: Kind
    shrink: int
    """How many times coarser than the scan."""
    sampled: float
    """Share of its voxels that were compared."""
    values: list[float] = field(default_factory=list)
    """After each step; made small."""


Curve = Sequence[Level]
Watch = Callable[[Curve], None]
"""Called with the metric so far after each step."""


def unwatched(curve: Curve, /) -> None:
    """Ignores the metric."""


class RegistrationError(PalpateError):
    """Two scans were not registered; both are as they were."""

    def __init__(self, message: str, curve: Sequence[Level] = ()) -> None:
        """Takes the message, and the metric after each step."""
        super().__init__(message)
        self.curve = tuple(curve)


@dataclass(frozen=True, kw_only=True)
class SearchOptions:
    """How a transform is searched."""

    samples: int = 50_000
    """Voxels that are compared on each level of a rigid or affine transform."""
    bent_samples: int = 3_000
    """Points that are drawn at random and compared in each step of a B-spline transform."""
    iterations: int = 150
    """Steps of a rigid or affine transform on each level, at most."""
    bent_iterations: int = 300
    """Steps of a B-spline transform on each level."""
    knots: float = 12.0
    """Spacing of the control points of a B-spline on the finest level [mm]."""
    bending: float = 1.0
    """Weight of the bending energy of a B-spline: its mean squared second derivatives [mm²]."""
    bins: int = 32
    """Histogram bins of each scan, for mutual information."""
    seed: int = 1
    """Seed of the samples."""

    def check(self) -> None:
        """Refuses what cannot be searched with.

        Raises:
            OptionError: A number is out of range.
        """
        for name, low, high in (
            ("samples", 100, 10**9),
            ("bent_samples", 100, 10**9),
            ("iterations", 1, 10**5),
            ("bent_iterations", 1, 10**5),
            ("knots", 1.0, 1000.0),
            ("bending", 0.0, 1e6),
            ("bins", 5, 256),
            ("seed", 1, 10**9),
        ):
            given = getattr(self, name)
            if not low <= given <= high:
                what = name.replace("_", " ")
                raise OptionError(f"{what} {given:g} given; allowed: {low:g} to {high:g}")


def check_choices(kind: str, metric: str, start: str) -> None:
    """Refuses what is not known.

    Raises:
        OptionError: It is not.
    """
    for what, given, allowed in (
        ("kind", kind, KINDS),
        ("metric", metric, METRICS),
        ("start", start, STARTS),
    ):
        if given not in allowed:
            raise OptionError(f"{what} {given!r} given; allowed: {', '.join(allowed)}")


def checked_landmarks(pairs: Pairs | None, *, wanted: bool) -> tuple[Points, Points] | None:
    """Returns landmarks as arrays, shape [count, 3] each.

    Raises:
        OptionError: They are missing, or do not determine a rigid transform.
    """
    if pairs is None:
        if wanted:
            raise OptionError("start from landmarks, but none given; allowed: pairs of points [mm]")
        return None
    fixed, moving = (np.asarray(points, np.float64) for points in pairs)
    allowed = f"allowed: {LEAST_PAIRS} or more pairs of points X,Y,Z [mm] that are not on one line"
    if fixed.shape != moving.shape or fixed.ndim != 2 or fixed.shape[1:] != (3,):
        raise OptionError(
            f"landmarks of shapes {list(fixed.shape)} and {list(moving.shape)} given; {allowed}"
        )
    if not (np.isfinite(fixed).all() and np.isfinite(moving).all()):
        raise OptionError(f"landmarks that are no numbers given; {allowed}")
    if len(fixed) < LEAST_PAIRS or _on_a_line(fixed) or _on_a_line(moving):
        raise OptionError(f"{len(fixed)} landmarks given, or all on one line; {allowed}")
    return fixed, moving


def checked_matrix(given: Points) -> Points:
    """Returns a matrix between points of two scans, shape [4, 4] [mm].

    Raises:
        OptionError: It is none, or flattens the scan.
    """
    matrix = np.asarray(given, np.float64)
    if matrix.shape != (4, 4):
        raise OptionError(f"a start of shape {list(matrix.shape)} given; allowed: [4, 4]")
    sound = np.isfinite(matrix).all() and np.array_equal(matrix[3], (0.0, 0.0, 0.0, 1.0))
    if not sound or np.linalg.det(matrix) <= LEAST_DETERMINANT:
        raise OptionError(
            "a start that is no place of a scan given; allowed: a matrix with the last row "
            "0 0 0 1 that neither flattens nor mirrors"
        )
    return matrix


def _on_a_line(points: Points) -> bool:
    sizes = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return bool(sizes[1] <= 1e-3 * max(float(sizes[0]), 1e-6))
