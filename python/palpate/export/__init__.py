"""Export: segments and scans as files that other programs read."""

from __future__ import annotations

from typing import TYPE_CHECKING

from palpate.base.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from palpate.export.export import export_scene
    from palpate.export.kinds import KINDS, Kind, check_export, kind_of

__all__ = ["KINDS", "Kind", "check_export", "export_scene", "kind_of"]

__getattr__ = lazy_exports(
    __name__,
    {
        "KINDS": "kinds",
        "Kind": "kinds",
        "check_export": "kinds",
        "export_scene": "export",
        "kind_of": "kinds",
    },
)
