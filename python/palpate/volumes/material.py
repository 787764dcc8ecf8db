"""Materials of segments: constants of isotropic elastic tissue, in SI units.

``docs/understand/deformation.md`` explains what each deformation model does with them.
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
"""How a region takes part in deformation: it deforms, is rigid, or counts as empty."""

ForceSource = Literal["matter", "voxels"]
"""Source of the force of soft tissue on a tool: the model, or voxels that are rigid until moved.
"""


class Material(NamedTuple):
    """Material with the same constants in a whole segment."""

    young: float
    """Young's modulus [Pa], 1 to 2e12."""
    poisson: float = 0.45
    """Poisson's ratio, more than -1, less than 0.5; a model that cannot represent it takes the
    nearest possible value and reports that."""
    density: float = 1050.0
    """Density [kg/m³], 0.1 to 23000; no model uses it, since tissue is brought to rest."""
    fracture_energy: float = float("inf")
    """Energy that a crack takes for its area [J/m²]; infinity for tissue that never tears."""
    friction: float = 0.2
    """Static Coulomb friction with a tool, 0 to 10; kinetic friction is four fifths of it, 2 at
    most."""
    stiffening: float = 0.0
    """Strain stiffening of the lattice, 0 (none) to 100: the exponent b of exp(b (I1 - 3)), with
    which shear grows, up to 20 times; ``young`` is that of small strains."""


@dataclass(frozen=True)
class LinearMaterial:
    """Material with constants linear in HU, and constant beyond two ends (thesis 5.54)."""

    interval: tuple[float, float]
    """HU of ``low`` and of ``high``."""
    low: Material
    high: Material


@dataclass(frozen=True)
class Region:
    """A region of a segment, and how it takes part in deformation.

    At most one of ``box`` and ``shared_with`` is given; without both it is the whole segment.
    """

    treatment: Treatment
    box: tuple[tuple[int, int, int], tuple[int, int, int]] | None = None
    """First voxel (x, y, z) of a box, and one past the last."""
    shared_with: int | None = None
    """Number of another segment: the region is what both have in common."""


@dataclass(frozen=True)
class Preset:
    """A material with a name."""

    name: str
    source: str
    """Source of its constants."""
    needs_hounsfield: bool
    """Whether its constants depend on HU, so that it is for CT only."""
    low: Material
    """Constants, at the lower end of HU where they depend on it."""
    high: Material
    """Constants, at the upper end of HU where they depend on it."""
    young_range: tuple[float, float]
    """Range of Young's moduli in its sources, or a standard deviation around the mean [Pa]."""


def require_hounsfield(material: Material | LinearMaterial | str | None, *, unit: str) -> None:
    """Refuses a material that depends on HU for a scan in another unit.

    Raises:
        OptionError: It depends on HU, and the scan's values are not known to be HU.
    """
    constant = [preset.name for preset in material_presets() if not preset.needs_hounsfield]
    by_name = [preset.name for preset in material_presets() if preset.needs_hounsfield]
    if unit == "HU" or not (isinstance(material, LinearMaterial) or material in by_name):
        return
    name = f'"{material}"' if isinstance(material, str) else "LinearMaterial"
    raise OptionError(
        f"material {name}, which follows HU, given for a scan whose values are not known to be HU; "
        f"allowed: a Material, or one of {', '.join(constant)}; where they are HU, read the scan "
        "with `unit=HU`"
    )


def material_presets() -> list[Preset]:
    """Returns all materials with a name."""
    return [
        Preset(name, source, needs_hounsfield, Material(*low), Material(*high), young_range)
        for name, source, needs_hounsfield, low, high, young_range in _core.material_presets()
    ]
