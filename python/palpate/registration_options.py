"""What can be chosen of a registration, what is told of its way, and how it fails."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from palpate.errors import OptionError, PalpateError

__all__ = [
    "KINDS",
    "METRICS",
    "STARTS",
    "Kind",
    "Level",
    "Metric",
    "Pairs",
    "Points",
    "RegistrationError",
    "SearchOptions",
    "Start",
    "check_choices",
    "checked_landmarks",
]

Kind = Literal["rigid", "affine", "bspline"]
Metric = Literal["mutual-information", "correlation", "mean-squares"]
Start = Literal["geometry", "centre", "moments", "landmarks"]
KINDS: tuple[Kind, ...] = get_args(Kind)
METRICS: tuple[Metric, ...] = get_args(Metric)
STARTS: tuple[Start, ...] = get_args(Start)

Points = NDArray[np.float64]
Pairs = tuple[Sequence[Sequence[float]], Sequence[Sequence[float]]]
"""Points of the fixed scan, and the same places in the moving one [mm]."""

LEAST_PAIRS = 3
"""Of landmarks, for a turn and a shift."""


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


class RegistrationError(PalpateError):
    """Two scans were not brought together; both are as they were."""

    def __init__(self, message: str, curve: Sequence[Level] = ()) -> None:
        """Takes what is said, and the metric on the way."""
        super().__init__(message)
        self.curve = tuple(curve)


@dataclass(frozen=True, kw_only=True)
class SearchOptions:
    """How a transform is searched."""

    samples: int = 50_000
    """Voxels that are compared on each level for a turn, shift, scale and shear."""
    bent_samples: int = 8_000
    """The same for a bent transform on the finest level; more on coarser ones, with fewer knots."""
    iterations: int = 150
    """On each level, at most."""
    bent_iterations: int = 15
    """The same for a bent transform."""
    knots: float = 32.0
    """Between the knots of a bent transform on the finest level [mm]."""
    bins: int = 32
    """Of values, for mutual information."""
    seed: int = 1
    """Of the samples."""

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
            ("bins", 5, 256),
            ("seed", 1, 10**9),
        ):
            given = getattr(self, name)
            if not low <= given <= high:
                told = name.replace("_", " ")
                raise OptionError(f"{told} {given:g} given; allowed: {low:g} to {high:g}")


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
        OptionError: They are missing, or do not tell a turn and a shift.
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


def _on_a_line(points: Points) -> bool:
    sizes = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return bool(sizes[1] <= 1e-3 * max(float(sizes[0]), 1e-6))
