"""Volumes as people read them; the page has the same in ``viewer/src/core/base/format.ts``."""

from __future__ import annotations

__all__ = ["volume_text"]

ML = 1000.0
"""mm³ in a ml."""

HALF_DIGIT = 5e-4
"""Share of a number below which it rounds up to the next power of ten, in three digits."""


def volume_text(volume: float) -> str:
    """Returns a volume [mm³] in three digits or whole: small ones in mm³, others in ml."""
    if abs(volume) < ML * (1.0 - HALF_DIGIT):
        return f"{volume:.3g} mm³"
    ml = volume / ML
    # "#" keeps zeros, which tell the precision
    return f"{ml:.0f} ml" if abs(ml) >= 100.0 * (1.0 - HALF_DIGIT) else f"{ml:#.3g} ml"
