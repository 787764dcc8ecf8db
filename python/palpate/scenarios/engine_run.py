"""Scenario runs as ``_core`` returns them: typed dictionaries, one value for each tick in a column.

Frame: scene, LPS [mm]; s, N.
"""

from __future__ import annotations

from typing import Literal, TypedDict

import numpy as np
from numpy.typing import NDArray

from palpate import _core

__all__ = ["DrillRun", "EngineRun", "NeedleRun", "PressRun", "RearrangingRun"]

Column = NDArray[np.float64]


class EngineRun(TypedDict):
    """What every scenario returns; ``palpate.scenarios.run.ScenarioRun`` explains the columns."""

    time: Column
    phase: list[Literal["in", "rest", "out"]]
    tool: Column
    """Position of the tool, shape [ticks, 3]."""
    travel: Column
    tip: Column
    probe: Column
    force: Column
    across: Column
    segment: NDArray[np.uint8]
    violations: int


class NeedleRun(EngineRun):
    """A needle that was driven through tissue."""

    stiffness: Column
    cutting: Column
    friction: Column
    wall: Column
    lateral: Column
    events: list[tuple[str, int, float, float, float]]
    """Kind, segment, time [s], depth [mm] and force [N] of each event."""
    wall_at: float | None
    """Travel at which the path meets a rigid obstacle [mm]."""


class IntoBone(EngineRun):
    """A tool that was driven into bone."""

    volume: Column
    """Volume of the places of bone that are empty by then [mm³]."""
    events: list[tuple[bool, float, float, float]]
    """Whether contact began or ended, time [s], travel [mm] and force [N]."""
    bone: _core.Segment
    """The bone afterwards."""


class DrillRun(IntoBone):
    """A drill that removed bone."""

    load: Column
    """[mW]."""


class RearrangingRun(IntoBone):
    """A ball that pushed particles of bone aside."""

    piled: Column
    """Volume of empty places that are bone by then [mm³]."""
    answers: int
    """Answers of the model."""
    slips: int
    """Answers in which particles slipped."""


class PressRun(EngineRun):
    """A ball that was pressed into soft tissue."""

    answers: int
    """Answers of the deformation model."""
