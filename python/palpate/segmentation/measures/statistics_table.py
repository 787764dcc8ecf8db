"""Statistics of segments as CSV, as JSON, and as lines for people.

The names of columns and keys hold the units: ``volume_mm3``, ``mean_HU``. Points are LPS [mm].
"""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping, Sequence
from io import StringIO
from typing import Any

from palpate.base.volume_text import volume_text
from palpate.segmentation.measures.segment_statistics import SegmentStatistics

__all__ = [
    "Row",
    "aligned_lines",
    "rows_csv",
    "statistics_cells",
    "statistics_csv",
    "statistics_json",
    "statistics_lines",
    "statistics_row",
    "table_text",
]

Row = dict[str, str | int | float | None]

VALUES = {
    "mean": "mean",
    "sd": "standard_deviation",
    "min": "minimum",
    "p5": "percentile_5",
    "p25": "percentile_25",
    "median": "median",
    "p75": "percentile_75",
    "p95": "percentile_95",
    "max": "maximum",
}
"""Columns of values, and where they are from."""

LONG = 1e5
"""From here on a number is longer than five digits."""

HEADINGS = ("segment", "volume", "voxels", "mean", "sd", "median", "5 to 95 %", "min to max")
LENGTHS = ("diameter", "axial", "surface", "centroid L, P, S")


def statistics_row(one: SegmentStatistics) -> Row:
    """Returns the numbers of a segment by the name of their column; None where there is none."""
    unit = f"_{one.unit}" if one.unit else ""
    x, y, z = one.centroid or (None, None, None)
    return {
        "segment": one.name,
        "voxels": one.voxels,
        "volume_mm3": one.volume,
        "volume_ml": one.volume / 1000.0,
        "surface_mm2": one.surface_area,
        "diameter_mm": one.diameter,
        "axial_diameter_mm": one.axial_diameter,
        "centroid_L_mm": x,
        "centroid_P_mm": y,
        "centroid_S_mm": z,
        "voxels_without_value": one.without_value,
        **{f"{name}{unit}": getattr(one.values, field, None) for name, field in VALUES.items()},
        "note": one.note,
    }


def statistics_csv(measured: Sequence[SegmentStatistics]) -> str:
    """Returns a table with a line for each segment, in at most ten digits."""
    return rows_csv([statistics_row(one) for one in measured])


def rows_csv(rows: Sequence[Row]) -> str:
    """Returns rows of the same columns as CSV, in at most ten digits."""
    text = StringIO()
    writer = csv.DictWriter(text, list(rows[0]) if rows else ["segment"], lineterminator="\n")
    writer.writeheader()
    writer.writerows({name: _in_ten_digits(cell) for name, cell in row.items()} for row in rows)
    return text.getvalue()


def table_text(form: str, rows: Sequence[Row], cells: Sequence[Sequence[str]], **told: Any) -> str:  # noqa: ANN401  # whatever JSON can say
    """Returns a table as the text of a ".csv", a ".json", or a "table" for people.

    Args:
        form: Which of them.
        rows: Its numbers, for programs.
        cells: Headings and rows for people.
        **told: What a JSON object says: its rows by a name, and what is to be known of them.
    """
    if form == ".csv":
        return rows_csv(rows)
    if form == ".json":
        return json.dumps(told, indent=2, ensure_ascii=False) + "\n"
    return "".join(f"{line}\n" for line in aligned_lines(cells))


def _in_ten_digits(cell: str | float | None) -> str | float | None:
    return f"{cell:.10g}" if isinstance(cell, float) else cell


def statistics_json(measured: Sequence[SegmentStatistics], about: Mapping[str, Any]) -> str:
    """Returns an object with what is known ``about`` the scan and a list of segments."""
    rows = [statistics_row(one) for one in measured]
    return json.dumps({**about, "segments": rows}, indent=2, ensure_ascii=False) + "\n"


def statistics_cells(measured: Sequence[SegmentStatistics]) -> list[list[str]]:
    """Returns a table for people: headings with units, and a row for each segment.

    The first column is the name, the last one what is to be known of missing numbers.
    """
    unit = f" [{measured[0].unit}]" if measured and measured[0].unit else ""
    headings = [
        *HEADINGS[:3],
        *(f"{name}{unit}" for name in HEADINGS[3:]),
        *(f"{name} [{'mm²' if name == 'surface' else 'mm'}]" for name in LENGTHS),
        "",
    ]
    return [headings, *(_cells(one) for one in measured)]


def statistics_lines(measured: Sequence[SegmentStatistics]) -> list[str]:
    """Returns the same table as lines of equal columns."""
    return aligned_lines(statistics_cells(measured))


def aligned_lines(rows: Sequence[Sequence[str]]) -> list[str]:
    """Returns rows as lines of equal columns; numbers stand between the first and the last."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(
            # names begin at the left, numbers end at the right
            cell.ljust(width) if index in (0, len(widths) - 1) else cell.rjust(width)
            for index, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]


def _cells(one: SegmentStatistics) -> list[str]:
    found = one.values
    values = ["–"] * 5
    if found is not None:
        low, high = found.percentile_5, found.percentile_95
        values = [
            _number(found.mean),
            _number(found.standard_deviation),
            _number(found.median),
            f"{_number(low)} to {_number(high)}",
            f"{_number(found.minimum)} to {_number(found.maximum)}",
        ]
    lengths = (one.diameter, one.axial_diameter, one.surface_area)
    without = f"{one.without_value} voxels without a value" if one.without_value else ""
    return [
        one.name,
        volume_text(one.volume),
        str(one.voxels),
        *values,
        *("–" if each is None else _number(each) for each in lengths),
        "–" if one.centroid is None else ", ".join(f"{along:.1f}" for along in one.centroid),
        "; ".join(filter(None, (one.note, without))),
    ]


def _number(value: float) -> str:
    """Returns a number in five digits, or whole where that is longer but still read at a glance."""
    return f"{value:.0f}" if LONG <= abs(value) < 100 * LONG else f"{value:.5g}"
