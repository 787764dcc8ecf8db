"""Settings of touch: contact model, spring and damper, friction, probe and largest force."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

__all__ = ["ContactModel", "Smoothing", "TouchSettings"]

ContactModel = Literal["exact", "thesis-original", "thesis-improved"]
"""Contact models by name; use ``exact``, the others are for comparison."""

Smoothing = Literal["intensities", "bits", "off"]
"""Where the direction of the force comes from: the smooth surface between voxels (from the scan's
values where a threshold made the segment), the surface of the voxels only, or no smoothing."""


@dataclass(frozen=True, kw_only=True)
class TouchSettings:
    """Settings of touch; None keeps the current value, at first the engine's default."""

    model: ContactModel | None = None
    """Contact model that moves the probe over the voxels."""
    stiffness: float | None = None
    """Stiffness of the spring between probe and device [N/mm], more than 0, at most 10."""
    damping: float | None = None
    """Damping between probe and device [N·s/mm], 0 to 0.1."""
    friction_static: float | None = None
    """Static Coulomb coefficient, 0 to 2."""
    friction_kinetic: float | None = None
    """Kinetic Coulomb coefficient, at most the static one."""
    smoothing: Smoothing | None = None
    """Where the direction of the force comes from."""
    probe_radius: float | None = None
    """Radius of the probe [mm], 0 to 20; 0 is a point."""
    force_limit: float | None = None
    """Largest force [N], more than 0, at most 40."""
    gain: float | None = None
    """Motion of the probe relative to that of the device, 0.1 to 10."""
