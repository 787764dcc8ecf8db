"""A small real head and how it looks, for pictures that are held against the renderer in NumPy."""

from __future__ import annotations

from pathlib import Path

import SimpleITK
from palpate.pictures.appearance import Mode
from reference_renderer import Look

__all__ = ["GREY", "LOOK", "MODES", "small_head"]

MODES: tuple[Mode, ...] = (
    "shaded",
    "composite",
    "absorption",
    "emission",
    "mip",
    "minip",
    "average",
    "iso",
)
GREY = ("mip", "minip", "average")
SOFT_TISSUE, BONE = 40.0, 250.0
"""Of a CT in HU."""
LOOK = Look(
    opacities=[(-220, 0), (-90, 0.03), (20, 0.06), (120, 0.05), (300, 0.3), (1200, 0.8)],
    colours=[(-220, "#cf9272"), (20, "#b5534a"), (300, "#efdfc0"), (1200, "#fdf8ec")],
    densities={"shaded": 1, "composite": 1, "absorption": 0.04, "emission": 0.03},
    windows={"mip": (1500, 600), "minip": (1200, -500), "average": (1400, 0)},
    slabs={"mip": 0, "minip": 30, "average": 30},
    iso_value=BONE,
    tissue_from=SOFT_TISSUE - 0.8 * (BONE - SOFT_TISSUE),
    edge_gradient=0.2 * (BONE - SOFT_TISSUE),
    flat_share=0.06,
)


def small_head(path: Path) -> SimpleITK.Image:
    """Returns the head in HU, of which each voxel is the mean of 3 × 3 × 2."""
    whole = SimpleITK.Cast(SimpleITK.ReadImage(str(path)), SimpleITK.sitkFloat32)
    small = SimpleITK.Cast(SimpleITK.BinShrink(whole, [3, 3, 2]) - 1024, SimpleITK.sitkInt16)
    small.SetOrigin((-120.0, -130.0, -90.0))
    return small
