"""Segmentation: segments made from scans and from other segments."""

from __future__ import annotations

from typing import TYPE_CHECKING

from palpate.base.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from palpate.segmentation.multi_otsu import otsu
    from palpate.segmentation.operations import ShapeKind, changed_shape, grown, smoothed_together
    from palpate.segmentation.region_growing import Growing
    from palpate.segmentation.watershed import grown_from_seeds

__all__ = [
    "Growing",
    "ShapeKind",
    "changed_shape",
    "grown",
    "grown_from_seeds",
    "otsu",
    "smoothed_together",
]

__getattr__ = lazy_exports(
    __name__,
    {
        "Growing": "region_growing",
        "ShapeKind": "operations",
        "changed_shape": "operations",
        "grown": "operations",
        "grown_from_seeds": "watershed",
        "otsu": "multi_otsu",
        "smoothed_together": "operations",
    },
)
