"""Segmentation: segments made from scans and from other segments."""

from __future__ import annotations

from typing import TYPE_CHECKING

from palpate.base.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from palpate.segmentation.growing.region_growing import Growing
    from palpate.segmentation.measures.segment_statistics import (
        SegmentStatistics,
        ValueStatistics,
        statistics,
    )
    from palpate.segmentation.multi_otsu import otsu
    from palpate.segmentation.operations import ShapeKind, changed_shape, grown, smoothed_together
    from palpate.segmentation.segment_steps import HandEdit, SegmentSteps, ShapeStep
    from palpate.segmentation.watershed import grown_from_seeds

__all__ = [
    "Growing",
    "HandEdit",
    "SegmentStatistics",
    "SegmentSteps",
    "ShapeKind",
    "ShapeStep",
    "ValueStatistics",
    "changed_shape",
    "grown",
    "grown_from_seeds",
    "otsu",
    "smoothed_together",
    "statistics",
]

__getattr__ = lazy_exports(
    __name__,
    {
        "Growing": "region_growing",
        "HandEdit": "segment_steps",
        "SegmentStatistics": "segment_statistics",
        "SegmentSteps": "segment_steps",
        "ShapeKind": "operations",
        "ShapeStep": "segment_steps",
        "ValueStatistics": "segment_statistics",
        "changed_shape": "operations",
        "grown": "operations",
        "grown_from_seeds": "watershed",
        "otsu": "multi_otsu",
        "smoothed_together": "operations",
        "statistics": "segment_statistics",
    },
)
