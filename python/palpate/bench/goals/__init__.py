"""Reports of all benchmarks, and their goals: the one table that reports and tests read.

A row without a goal is reported for information.
"""

from __future__ import annotations

from palpate.bench.goals.cohort import COHORT_ROWS
from palpate.bench.goals.edit import EDIT_ROWS
from palpate.bench.goals.goal import Goal
from palpate.bench.goals.growing import GROW_ROWS
from palpate.bench.goals.haptics import HAPTICS_ROWS
from palpate.bench.goals.opening import OPEN_ROWS
from palpate.bench.goals.passivity import PASSIVITY_ROWS
from palpate.bench.goals.quality import QUALITY_ROWS
from palpate.bench.goals.registration import REGISTER_ROWS
from palpate.bench.goals.render import RENDER_ROWS
from palpate.bench.goals.segmenting import SEGMENT_ROWS
from palpate.bench.goals.servo import SERVO_ROWS
from palpate.bench.goals.soft_tissue import (
    DEFORM_ROWS,
    MATTER_STRESS_ROWS,
    SESSION_ROWS,
    TRUTH_CUBE_ROWS,
)
from palpate.bench.goals.stress import STRESS_ROWS
from palpate.bench.goals.surface import SURFACE_ROWS

__all__ = ["GOALS", "Goal"]

GOALS: dict[str, tuple[Goal, ...]] = {
    "edit": EDIT_ROWS,
    "open": OPEN_ROWS,
    "render": RENDER_ROWS,
    "cohort": COHORT_ROWS,
    "register": REGISTER_ROWS,
    "segment": SEGMENT_ROWS,
    "segment --grow": GROW_ROWS,
    "surface": SURFACE_ROWS,
    "haptics": HAPTICS_ROWS,
    "touch-quality": QUALITY_ROWS,
    "passivity": PASSIVITY_ROWS,
    "stress": STRESS_ROWS,
    "servo": SERVO_ROWS,
    "deform": DEFORM_ROWS,
    "session": SESSION_ROWS,
    "truth-cube": TRUTH_CUBE_ROWS,
    "stress-deform": MATTER_STRESS_ROWS,
}
"""Rows of each benchmark, in the order of its table."""
