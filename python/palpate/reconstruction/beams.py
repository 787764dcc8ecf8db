"""Beams of projections, and what they are weakened by."""

from __future__ import annotations

from typing import Literal, get_args

__all__ = ["BEAMS", "WATER", "Beam"]

Beam = Literal["parallel", "cone"]
BEAMS: tuple[Beam, ...] = get_args(Beam)

WATER = 0.0206
"""Attenuation of water at 60 keV [1/mm] (NIST, Hubbell and Seltzer)."""
