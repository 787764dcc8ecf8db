"""A table of landmarks as a command or a recipe asks for it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import msgspec

from palpate.base.request import Request, words

if TYPE_CHECKING:
    from palpate.segmentation.measures.landmarks import Landmark
    from palpate.segmentation.measures.statistics_table import Row
    from palpate.volumes.scene import Scene

__all__ = ["LandmarksRequest", "landmark_cells", "landmarks_text"]


class LandmarksRequest(Request, frozen=True, kw_only=True):
    """The options of ``palpate landmarks``."""

    segment: Annotated[
        str | None, words("Name or number of the segment; by default all segments.")
    ] = None
    points: Annotated[
        list[str],
        words(
            "Landmark: centroid, left, right, posterior, anterior, superior, inferior; repeatable; "
            "by default all.",
            form="NAME",
        ),
    ] = msgspec.field(default_factory=list)
    out: Annotated[
        Path | None,
        words("Table to write (.csv, .json).", short="o", writes=(".csv", ".json")),
    ] = None

    def check(self) -> None:
        """Refuses names that no landmark has.

        Raises:
            OptionError: One is none.
        """
        from palpate.segmentation.measures.landmarks import check_points

        check_points(self.points)

    def find(self, scene: Scene) -> tuple[list[Landmark], list[str]]:
        """Finds the landmarks, and writes the table where one is asked for.

        Returns:
            The landmarks, and what a person should know.

        Raises:
            OptionError: There is no such segment.
            OSError: The disk refuses the table.
        """
        from palpate.segmentation.measures.landmarks import POINTS, landmarks
        from palpate.volumes.scene import choose_segment

        found = landmarks(scene, segment=self.segment, points=self.points or POINTS)
        if self.out is not None:
            from palpate.base.whole_file import whole_file

            with whole_file(self.out) as unfinished:
                unfinished.write_text(landmarks_text(found, self.out.suffix.lower()), "utf-8")
        wanted = (
            [each.name for each in scene]
            if self.segment is None
            else [choose_segment(scene, self.segment).name]
        )
        known = {each.segment for each in found}
        told = [f"{name} is empty: no landmarks" for name in wanted if name not in known]
        return found, told


def landmarks_text(found: Sequence[Landmark], form: str) -> str:
    """Returns landmarks as the text of a ".csv", a ".json", or a "table" for people."""
    from palpate.segmentation.measures.statistics_table import table_text

    rows: list[Row] = [
        {
            "segment": each.segment,
            "landmark": each.name,
            **dict(zip(("L_mm", "P_mm", "S_mm"), each.point, strict=True)),
        }
        for each in found
    ]
    return table_text(form, rows, landmark_cells(found), landmarks=rows)


def landmark_cells(found: Sequence[Landmark]) -> list[list[str]]:
    """Returns a table for people: headings with units, and a row for each landmark."""
    headings = ["segment", "landmark", "L [mm]", "P [mm]", "S [mm]"]
    rows = [[each.segment, each.name, *(f"{n:.2f}" for n in each.point)] for each in found]
    return [headings, *rows]
