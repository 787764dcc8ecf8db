"""Results of the engine's benchmarks, as ``_core`` returns them: typed dictionaries.

Reports that a table looks up by name, with numbers only, are ``dict[str, float]`` instead.
"""

from __future__ import annotations

from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "EmbeddedResult",
    "LatticeFrames",
    "PairsResult",
    "PressedBlock",
    "SessionResult",
    "SoftTissueStressResult",
    "SoftTissueViolation",
    "StressResult",
    "StressViolation",
]


class EmbeddedResult(TypedDict):
    """Touch of the same body in a small and a large scan."""

    small_per_second: float
    """Updates per second."""
    large_per_second: float
    ratio: float
    """Large by small."""
    contact_share: float
    """Fraction of updates in contact."""
    small_cold: dict[str, float]
    """Times of single calls, as ``TouchBench.run`` returns them."""
    large_cold: dict[str, float]


class StressViolation(TypedDict):
    """A violated guarantee of touch, and the run that shows it."""

    run: int
    move: int
    """Moves before it."""
    model: str
    guarantee: int
    """Its number."""
    what: str
    plan: str


class StressResult(TypedDict):
    """Counts over runs of random moves."""

    moves: int
    contacts: int
    """Moves in contact."""
    edits: int
    poses: int
    """Steps of moved segments."""
    cuts: int
    """Forces that fell at once because they would have pulled."""
    violation: StressViolation | None


class SoftTissueViolation(TypedDict):
    """A violated guarantee of touch in soft tissue."""

    run: int
    tick: int
    """Ticks before it."""
    guarantee: int
    """Its number."""
    what: str


class SoftTissueStressResult(TypedDict):
    """Counts over runs of work in soft tissue."""

    ticks: int
    contacts: int
    bits: int
    """Voxels around the probe that changed."""
    edits: int
    answers: int
    in_bone: int
    drilled: int
    punctures: int
    rests: int
    violation: SoftTissueViolation | None


class SessionResult(TypedDict):
    """Rates of servo and model; the first four have one number for each sample."""

    ticks: list[float]
    contacts: list[float]
    """Ticks in contact."""
    answers: list[float]
    seconds: list[float]
    nodes: int
    """Of the last answer, as ``iterations``."""
    iterations: int
    violations: int


class LatticeFrames(TypedDict):
    """The bonded lattice under a ball that presses and slides."""

    seconds: list[float]
    """Time of each frame on one core."""
    worst_error: float
    """Of the force, relative to that at residual 1e-6."""
    worst_exact: float
    """Largest residual of the reference."""


class PressedBlock(TypedDict):
    """A block of the bonded lattice at rest between two plates."""

    moved: NDArray[np.float64]
    """Displacement of each node [mm], shape [nodes, 3], x fastest."""
    force: tuple[float, float, float]
    """On the lower plate [N]."""
    iterations: int
    residual: float


class PairsResult(TypedDict):
    """A crystal of Lennard-Jones particles; units a = D = m = 1, energies per particle."""

    side: float
    """Edge of the periodic box."""
    positions: NDArray[np.float64]
    """At the start, shape [n, 3]."""
    velocities: NDArray[np.float64]
    """At the start, shape [n, 3]."""
    step: float
    """Time step."""
    seconds: float
    """Of the timed steps."""
    pairs_per_second: float
    builds: int
    """Times that neighbour lists were built."""
    potential_at_start: float
    potential_after_warm_up: float
    total_at_end: float
