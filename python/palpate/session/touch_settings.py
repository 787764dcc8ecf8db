"""How touch feels: the contact model, the spring, friction, the probe and the largest force."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

__all__ = ["ContactModel", "Smoothing", "TouchSettings"]

ContactModel = Literal["exact", "thesis-original", "thesis-improved"]
"""Contact models by name; ``exact`` is the one to use, the others are for comparison."""

Smoothing = Literal["intensities", "bits", "off"]
"""Where the force comes from: the smooth surface, which the scan's values tell where a threshold
made the segment; that of its voxels alone; or the voxels' stairs."""


@dataclass(frozen=True, kw_only=True)
class TouchSettings:
    """Settings of touch; what is None stays as it is, at first the engine's own choice."""

    model: ContactModel | None = None
    """What moves the probe over the voxels."""
    stiffness: float | None = None
    """Of the spring between probe and device [N/mm], more than 0, at most 10."""
    damping: float | None = None
    """Of the damper beside it [N·s/mm], 0 to 0.1."""
    friction_static: float | None = None
    """Coulomb coefficient of a probe that sticks, 0 to 2."""
    friction_kinetic: float | None = None
    """Coulomb coefficient of a probe that slides, at most the static one."""
    smoothing: Smoothing | None = None
    """Where the force comes from."""
    probe_radius: float | None = None
    """Radius of the probe [mm]; 0 is a point."""
    force_limit: float | None = None
    """Largest force [N], more than 0, at most 40."""
    gain: float | None = None
    """Millimetres that the probe goes per millimetre of the device, 0.1 to 10."""
