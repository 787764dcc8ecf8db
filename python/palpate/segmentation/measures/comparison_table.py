"""Comparisons with a reference as CSV, as JSON, and as lines for people; units are in the names."""

from __future__ import annotations

from palpate.base.volume_text import volume_text
from palpate.segmentation.measures.comparison import Comparison, SegmentComparison
from palpate.segmentation.measures.statistics_table import Row, table_text

__all__ = ["comparison_cells", "comparison_row", "comparison_text"]

HEADINGS = ("segment", "reference", "Dice", "HD95 [mm]", "mean surface distance [mm]")
HEADINGS_OF_VOLUMES = ("volume", "of the reference", "")


def comparison_row(one: SegmentComparison) -> Row:
    """Returns the numbers of a segment by the name of their column; None where there is none."""
    known = one.reference_volume
    return {
        "segment": one.name,
        "reference": one.reference,
        "dice": one.dice,
        "hausdorff95_mm": one.hausdorff_95,
        "mean_surface_distance_mm": one.mean_surface_distance,
        "volume_ml": one.volume / 1000.0,
        "reference_volume_ml": None if known is None else known / 1000.0,
        "note": one.note,
    }


def comparison_text(found: Comparison, form: str) -> str:
    """Returns a comparison as the text of a ".csv", a ".json", or a "table" for people."""
    rows = [comparison_row(one) for one in found.segments]
    told = list(found.warnings)
    return table_text(form, rows, comparison_cells(found), segments=rows, warnings=told)


def comparison_cells(found: Comparison) -> list[list[str]]:
    """Returns a table for people: headings with units, and a row for each segment."""
    return [[*HEADINGS, *HEADINGS_OF_VOLUMES], *(_cells(one) for one in found.segments)]


def _cells(one: SegmentComparison) -> list[str]:
    known = one.reference_volume
    numbers = (one.dice, one.hausdorff_95, one.mean_surface_distance)
    return [
        one.name,
        one.reference or "–",
        *("–" if number is None else f"{number:.4g}" for number in numbers),
        volume_text(one.volume),
        "–" if known is None else volume_text(known),
        one.note,
    ]
