"""Reconstruction: scans from projections, by filtered back-projection."""

from __future__ import annotations

from typing import TYPE_CHECKING

from palpate.base.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from palpate.reconstruction.beams import BEAMS, WATER, Beam
    from palpate.reconstruction.reconstruction import missing_library, reconstruct
    from palpate.reconstruction.rtk_geometry import read_geometry
    from palpate.reconstruction.scanner import Scanner

__all__ = [
    "BEAMS",
    "WATER",
    "Beam",
    "Scanner",
    "missing_library",
    "read_geometry",
    "reconstruct",
]

__getattr__ = lazy_exports(
    __name__,
    {
        "BEAMS": "beams",
        "Beam": "beams",
        "Scanner": "scanner",
        "WATER": "beams",
        "missing_library": "reconstruction",
        "read_geometry": "rtk_geometry",
        "reconstruct": "reconstruction",
    },
)
