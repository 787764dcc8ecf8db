"""A segment and the settings of touch, as ``_core.Session`` returns them: typed dictionaries.

A pose is a homogeneous matrix of the scene, LPS [mm], by rows: 16 numbers.
"""

from __future__ import annotations

from typing import Literal, TypedDict

__all__ = [
    "Bounds",
    "EngineSegmentState",
    "FeelState",
    "MaterialState",
    "PoseState",
    "SegmentState",
    "SettingsState",
]

Limits = tuple[float, float]
Constants = tuple[float, float, float, float, float, float]
"""Fields of ``palpate.Material``, in their order."""

Bounds = tuple[list[int], list[int]]
"""Lowest voxel and one past the highest, each (x, y, z)."""


class SettingsState(TypedDict):
    """Settings of touch in effect; units and ranges are those of ``palpate.TouchSettings``."""

    model: Literal["exact", "thesis-original", "thesis-improved"]
    stiffness: float
    damping: float
    friction_static: float
    friction_kinetic: float
    smoothing: Literal["intensities", "bits", "off"]
    probe_radius: float
    force_limit: float
    gain: float


class FeelState(TypedDict):
    """Touch settings of one segment; None where the session's settings apply."""

    stiffness: float | None
    friction_static: float | None
    friction_kinetic: float | None


class MaterialState(TypedDict):
    """Material of a segment."""

    preset: str | None
    """Its name in ``palpate.material_presets()``; None where the constants were given."""
    low: Constants
    """Constants at the lower end of ``interval``; of all voxels where that is None."""
    high: Constants
    """Constants at the upper end of ``interval``; as ``low`` where that is None."""
    interval: Limits | None
    """HU between which the constants are interpolated; None where they are the same everywhere."""


class EngineSegmentState(TypedDict):
    """One segment of a session as the engine has it: ``touchable`` is what holds."""

    id: int
    """1 to 255."""
    voxels: int
    volume: float
    """[mm³]."""
    grid: list[float] | None
    """``patient_from_grid`` by rows, where the segment has a grid of its own."""
    bounds: Bounds | None
    """Bounding box in voxels of the scan, or of its own grid; None where it is empty."""
    touchable: bool
    locked: bool
    pending: bool
    """Whether touch does not follow its latest change yet."""
    range: Limits | None
    """Threshold whose voxels it has now; None as soon as an edit changes them."""
    made_by: Limits | None
    """Threshold that made it, whatever edits did since."""
    feel: FeelState
    material: MaterialState | None
    """None where the segment is rigid."""
    pose: list[float] | None
    """Where it was moved to; None where it stands as in the scan."""


class SegmentState(EngineSegmentState):
    """One segment of a session: ``touchable`` is what is wanted."""

    felt: bool
    """Whether the probe collides with it: touchable, and visible or touched while hidden."""


class PoseState(TypedDict):
    """Pose of a moved segment."""

    id: int
    pose: list[float]
