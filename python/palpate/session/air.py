"""What is left where matter was taken away."""

from __future__ import annotations

from palpate.volumes.volume import Volume

__all__ = ["air_of"]

AIR_HU = -1000.0


def air_of(volume: Volume) -> float:
    """Returns the value of air in a scan [unit of the scan]; without a known unit its lowest."""
    return AIR_HU if volume.unit == "HU" else volume.range[0]
