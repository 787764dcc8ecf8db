"""What steps of a recipe measure of its segments: tables for people, and columns of a cohort."""

from __future__ import annotations

from dataclasses import dataclass, field

from palpate.segmentation.measures.statistics_table import Row

__all__ = ["Measures", "Table"]


@dataclass(frozen=True)
class Table:
    """A table for people."""

    title: str
    cells: list[list[str]]
    """Headings with units, and rows."""


@dataclass
class Measures:
    """What steps have measured so far."""

    tables: list[Table] = field(default_factory=list)
    columns: dict[str, Row] = field(default_factory=dict)
    """Numbers of each segment by the name of their column, beside its statistics."""

    def note(self, segment: str, row: Row) -> None:
        """Takes numbers of a segment; a second one of the same name gets a number of its own."""
        columns = self.columns.setdefault(segment, {})
        for name, cell in row.items():
            number = 1
            while (key := name if number == 1 else f"{name}_{number}") in columns:
                number += 1
            columns[key] = cell
