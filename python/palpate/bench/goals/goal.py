"""A figure that a benchmark reports, and its goal."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

__all__ = ["Goal"]


@dataclass(frozen=True)
class Goal:
    """A figure that a benchmark reports."""

    case: str
    """What was done."""
    metric: str
    """What was measured."""
    key: str
    """Its key in the engine's report."""
    scale: float
    """Reported figure per unit of the engine's."""
    unit: str
    goal: float | None
    better: Literal["higher", "lower"]
