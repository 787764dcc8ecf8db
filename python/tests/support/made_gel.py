"""A block of gel in air, for sessions that press it."""

from __future__ import annotations

import numpy as np
from palpate.volumes.material import Material
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume, VolumeTraits

TOP = 24.0
"""Upper end of the block along z [mm]."""
GEL = Material(young=2.0e4, poisson=0.45, friction=0.0)
"""Soft, and never breaks."""


def gel_scene(unit: str = "HU") -> Scene:
    """Returns a scan of 48 mm whose lower half, 48 x 48 x 24 mm, is segment 1."""
    values = np.full((48, 48, 48), -1000, dtype=np.int16)
    values[: int(TOP)] = 50
    volume = Volume(values, spacing=(1.0, 1.0, 1.0), traits=VolumeTraits(unit=unit))
    return Scene(volume, [volume.threshold(0.0, 100.0, name="gel")])
