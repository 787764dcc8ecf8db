"""Needles: properties of tissue, and events of a needle in a session.

``docs/understand/needle.md`` explains the model. Points are in the patient, LPS [mm].
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from palpate import _core

__all__ = ["DIAMETER", "TISSUES", "NeedleEvent", "Tissue"]


@dataclass(frozen=True)
class Tissue:
    """Properties of a tissue for a needle of diameter ``DIAMETER``."""

    linear: float
    """Stiffness of the tissue under the tip, linear part [N/mm]."""
    quadratic: float
    """Stiffness of the tissue under the tip, quadratic part [N/mm²]."""
    puncture: float
    """Force at which the tip punctures the surface [N]."""
    cutting: float
    """Force at the tip while it cuts [N]."""
    friction: float
    """Friction of the shaft per length in the tissue [N/mm]."""
    lateral: float
    """Lateral stiffness per length of shaft in the tissue [N/mm per mm]."""
    relaxation: float
    """Fraction of the cutting force that relaxes while the tip rests, 0 to 1."""
    relaxation_secs: float
    """Time constant of that relaxation [s]."""

    def met_by(self, diameter: float) -> Tissue:
        """Returns the properties for a needle of another diameter [mm].

        Forces at tip and shaft are assumed to be proportional to the diameter, as the shaft's
        surface is.
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
"""Diameter of the needle of the presets [mm]."""

TISSUES: Mapping[str, Tissue] = {name: Tissue(*figures) for name, figures in _core.needle_tissues()}
"""Presets by name; bone is not among them, since a needle does not puncture it."""


@dataclass(frozen=True)
class NeedleEvent:
    """An event of a needle in a session."""

    kind: str
    """``punctured``, ``crossed``, ``stopped`` or ``withdrawn``."""
    segment: int
    """Number of the segment; 0 for none."""
    time: float
    """Time of the event [s]."""
    depth: float
    """Distance of the tip from the point of entry [mm]."""
    force: float
    """Force at the tip [N]."""
