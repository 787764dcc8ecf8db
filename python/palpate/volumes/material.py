"""What segments are made of: constants of isotropic matter, in SI.

Models of deformation read them; docs/understand/deformation.md says what each does with them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

from palpate import _core
from palpate.base.errors import OptionError

__all__ = [
    "ForceSource",
    "LinearMaterial",
    "Material",
    "Preset",
    "Region",
    "Treatment",
    "material_presets",
    "require_hounsfield",
]

Treatment = Literal["deformable", "rigid", "empty"]
"""How matter takes part: it gives, stays where it is, or is as if it were not there."""

ForceSource = Literal["matter", "voxels"]
"""What a tool feels of matter that gives way: its own force, or its voxels until they move."""


class Material(NamedTuple):
    """Constants that hold everywhere in a segment, as for MR scans."""

    young: float
    """Young's modulus [Pa]."""
    poisson: float = 0.45
    """Poisson's ratio, below 0.5; what a model cannot do is told, and the nearest is taken."""
    density: float = 1050.0
    """[kg/m³]; no model reads it, since matter is brought to rest."""
    breaking_strain: float = float("inf")
    """Strain at which bonds break; infinity for matter that never breaks."""
    friction: float = 0.2
    """Coulomb friction with a tool that sticks; four fifths of it where one slides, 2 at most."""


@dataclass(frozen=True)
class LinearMaterial:
    """Constants linear in HU between two materials, held at its ends (thesis 5.54)."""

    interval: tuple[float, float]
    """HU of ``low`` and of ``high``."""
    low: Material
    high: Material


@dataclass(frozen=True)
class Region:
    """Some of a segment that takes part in its own way; all of it where nothing else is told."""

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
    needs_hounsfield: bool
    """Whether its constants follow HU: it is for CT only."""
    low: Material
    """Its constants, at the lower end where they follow HU."""
    high: Material
    """Its constants, at the upper end where they follow HU."""


def require_hounsfield(material: Material | LinearMaterial | str | None, *, unit: str) -> None:
    """Refuses a material whose constants follow HU, for a scan with values of another unit.

    Raises:
        OptionError: They follow HU, and values are not known to be HU.
    """
    constant = [preset.name for preset in material_presets() if not preset.needs_hounsfield]
    by_name = [preset.name for preset in material_presets() if preset.needs_hounsfield]
    if unit == "HU" or not (isinstance(material, LinearMaterial) or material in by_name):
        return
    told = f'"{material}"' if isinstance(material, str) else "LinearMaterial"
    raise OptionError(
        f"material {told}, which follows HU, given for a scan whose values are not known to be HU; "
        f"allowed: a Material, or one of {', '.join(constant)}; where they are HU, read the scan "
        'with unit="HU" (--unit HU)'
    )


def material_presets() -> list[Preset]:
    """Lists the materials that have a name."""
    return [
        Preset(name, source, needs_hounsfield, Material(*low), Material(*high))
        for name, source, needs_hounsfield, low, high in _core.material_presets()
    ]
