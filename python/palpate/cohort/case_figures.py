"""What the overview shows of a case: numbers of its segments, and a small picture."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from palpate.export.numbering import unique_names
from palpate.pictures.picture_file import image_of
from palpate.pictures.render import DrawnScene
from palpate.segmentation.measures.segment_statistics import statistics
from palpate.segmentation.measures.statistics_table import Row, statistics_row
from palpate.volumes.scene import Scene

__all__ = ["THUMBNAIL", "measured_segments", "write_thumbnail"]

THUMBNAIL = "thumbnail.jpg"
EDGE = 200
"""Of the picture [pixels]: of thousands of cases the overview is still opened at once."""
QUALITY = 80


def measured_segments(
    scene: Scene, measured: Mapping[str, Row] | None = None
) -> tuple[dict[str, dict[str, Any]], list[str]]:
    """Measures the segments of a case.

    Args:
        scene: The scan and its segments.
        measured: Numbers that steps of the recipe have measured, by segment.

    Returns:
        What ``palpate statistics`` tells of each, by names that differ, and its colour; and what is
        to be said of the names.
    """
    shown = list(scene)
    names, told = unique_names(shown)
    further = measured or {}
    rows = {
        name: {**statistics_row(row), **further.get(one.name, {}), "colour": _hex(one.colour)}
        for name, one, row in zip(names, shown, statistics(scene), strict=True)
    }
    return rows, told


def write_thumbnail(scene: Scene, path: Path) -> None:
    """Writes a small picture of a scan and its segments, seen from the front of the patient.

    Raises:
        OSError: The disk refuses it.
    """
    drawn = DrawnScene(scene)
    size = (EDGE, EDGE)
    picture = drawn.draw(drawn.camera("anterior", size), size, quality="fast")
    image_of(picture).convert("RGB").save(path, "JPEG", quality=QUALITY)


def _hex(colour: tuple[float, float, float]) -> str:
    return "#" + "".join(f"{round(255 * share):02x}" for share in colour)
