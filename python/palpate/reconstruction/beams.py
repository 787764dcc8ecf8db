"""Beams of projections, where they begin, and what they are weakened by."""

from __future__ import annotations

from typing import Literal, get_args

__all__ = ["BEAMS", "WATER", "ZEROS", "Beam", "Zero"]

Beam = Literal["parallel", "cone"]
BEAMS: tuple[Beam, ...] = get_args(Beam)
Zero = Literal["back", "front"]
"""Side of the patient with the source at angle 0."""
ZEROS: tuple[Zero, ...] = get_args(Zero)

WATER = 0.0206
"""Attenuation of water at 60 keV [1/mm] (NIST, Hubbell and Seltzer)."""
