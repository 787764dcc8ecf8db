"""Ranges of Hounsfield units that stand for tissues, as programs for segmentation offer them.

Tissues overlap in CT, and values depend on the scanner's voltage and filter: a range is where to
begin, not what is found. They are the customary ones for adults, of no single source.
"""

from __future__ import annotations

from palpate.base.errors import OptionError
from palpate.base.nearest import perhaps

__all__ = ["PRESETS", "preset_range"]

PRESETS: dict[str, tuple[float, float | None]] = {
    "bone": (226.0, None),
    "compact bone": (662.0, 1988.0),
    "spongy bone": (148.0, 661.0),
    "soft tissue": (-700.0, 225.0),
    "muscle": (-5.0, 135.0),
    "fat": (-205.0, -51.0),
    "skin": (-718.0, -177.0),
    "lung": (-950.0, -500.0),
}
"""Lowest and highest value [HU]; None is no end."""


def preset_range(name: str, *, unit: str) -> tuple[float, float | None]:
    """Returns the range of a preset, for a scan with values of a unit.

    Raises:
        OptionError: There is no such preset, or values are no Hounsfield units.
    """
    if name not in PRESETS:
        raise OptionError(
            f"threshold {name!r} given{perhaps(name, PRESETS)}; allowed: LOW or LOW,HIGH, or one "
            f"of {', '.join(PRESETS)}"
        )
    if unit != "HU":
        raise OptionError(
            f"threshold {name!r} given for a scan whose values are not known to be HU; allowed: "
            "LOW or LOW,HIGH, `otsu=CLASSES`, or `unit=HU` where they are HU"
        )
    return PRESETS[name]
