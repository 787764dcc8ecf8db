"""Needles: what tissues are to them, and what happens to one in a session.

The law is told in ``docs/understand/needle.md``. Points are in the patient [mm].
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from palpate import _core

__all__ = ["DIAMETER", "TISSUES", "NeedleEvent", "Tissue"]


@dataclass(frozen=True)
class Tissue:
    """What a needle meets in a tissue that it can puncture."""

    linear: float
    """Force per deflection of the tissue under the tip [N/mm]."""
    quadratic: float
    """What the square of the deflection adds [N/mm²]."""
    puncture: float
    """Force at which the tip goes in [N]."""
    cutting: float
    """Force at the tip while it cuts its way on [N]."""
    friction: float
    """Friction of the shaft per length in the tissue [N/mm]."""
    lateral: float
    """Stiffness against the side per length of shaft in the tissue [N/mm per mm]."""
    relaxation: float
    """Share of the cutting force that a tip at rest loses."""
    relaxation_secs: float
    """Time in which that loss comes to 63 % [s]."""

    def met_by(self, diameter: float) -> Tissue:
        """Returns what a needle of another diameter [mm] meets.

        Forces at tip and shaft grow in proportion to it, as the shaft's face does; that is assumed.
        """
        share = diameter / DIAMETER
        return replace(
            self,
            linear=self.linear * share,
            quadratic=self.quadratic * share,
            puncture=self.puncture * share,
            cutting=self.cutting * share,
            friction=self.friction * share,
        )


DIAMETER = 1.0
"""Of the needle that the presets are for [mm]."""

TISSUES: Mapping[str, Tissue] = {name: Tissue(*figures) for name, figures in _core.needle_tissues()}
"""Presets by name; bone is none of them, since no needle punctures it."""


@dataclass(frozen=True)
class NeedleEvent:
    """What happened to a needle in a session."""

    kind: str
    """``punctured``, ``crossed``, ``stopped`` or ``withdrawn``."""
    segment: int
    """Which segment; 0 where none."""
    time: float
    """When [s]."""
    depth: float
    """How deep, from where the needle went in [mm]."""
    force: float
    """At the tip [N]."""
