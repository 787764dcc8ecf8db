"""What segments are made of: constants of isotropic matter, in SI.

Models of deformation read them; docs/algorithms/deformation.md says what each does with them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

from palpate import _core

__all__ = [
    "LinearMaterial",
    "Material",
    "Part",
    "Preset",
    "Treatment",
    "deformation_models",
    "material_presets",
]

Treatment = Literal["deformable", "rigid", "empty"]
"""How matter takes part: it gives, stays where it is, or is as if it were not there."""


class Material(NamedTuple):
    """Constants that hold everywhere in a segment, as for MR scans."""

    young: float
    """Young's modulus [Pa]."""
    poisson: float = 0.45
    """Poisson's ratio, below 0.5."""
    density: float = 1050.0
    """[kg/m³]."""
    breaking_strain: float = float("inf")
    """Strain at which bonds break; infinity for matter that never breaks."""
    friction: float = 0.2
    """Coulomb friction with a tool."""


@dataclass(frozen=True)
class LinearMaterial:
    """Constants linear in HU between two materials, held at its ends (thesis 5.54)."""

    interval: tuple[float, float]
    """HU of ``low`` and of ``high``."""
    low: Material
    high: Material


@dataclass(frozen=True)
class Part:
    """A part of a segment that takes part in its own way; all of it where nothing else is told."""

    treatment: Treatment
    box: tuple[tuple[int, int, int], tuple[int, int, int]] | None = None
    """What lies in a box of voxels (x, y, z): first, and one past the last."""
    shared_with: int | None = None
    """What belongs to this other segment too."""


@dataclass(frozen=True)
class Preset:
    """A material that can be chosen by its name."""

    name: str
    source: str
    """Where its constants are from."""


def material_presets() -> list[Preset]:
    """Lists the materials that have a name."""
    return [Preset(name, source) for name, source in _core.material_presets()]


def deformation_models() -> list[str]:
    """Lists the names of the models by which matter gives way."""
    return _core.deformation_models()
