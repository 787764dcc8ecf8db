"""What the folder of a cohort tells of its cases, and which of their numbers are outliers."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from palpate.cohort.case_figures import THUMBNAIL
from palpate.cohort.output_folder import CohortFolder
from palpate.cohort.overview.outliers import outliers

__all__ = ["ToldCase", "told_cases"]

NO_MEASURES = ("centroid", "landmark", "voxels", "segment", "note", "colour", "volume_mm3")
"""Columns that depend on the frame of the scan or its grid, say no number, or say one twice."""


@dataclass
class ToldCase:
    """One case."""

    name: str
    reason: str | None
    """Why it failed the last time; None where it is done."""
    scan: str | None = None
    labels: str | None = None
    """The file of its folder that holds the segments."""
    segments: dict[str, dict[str, Any]] = field(default_factory=dict)
    """Numbers of each segment, by column."""
    outliers: list[tuple[str, str]] = field(default_factory=list)
    """Segment and column of numbers that are far from those of the other cases."""
    warnings: list[str] = field(default_factory=list)
    files: list[str] = field(default_factory=list)
    wall_s: float | None = None
    thumbnail: bytes | None = None


def told_cases(folder: CohortFolder) -> list[ToldCase]:
    """Returns the cases that a folder holds, by name; numbers of one that failed are left out."""
    places = sorted(place for place in folder.of().iterdir() if place.is_dir())
    cases = [case for case in map(_told, places) if case is not None]
    _mark_outliers([case for case in cases if case.reason is None])
    return cases


def measures_of(row: dict[str, Any]) -> dict[str, float]:
    """Returns the numbers of a segment that can be compared between scans."""
    return {
        name: float(cell)
        for name, cell in row.items()
        if isinstance(cell, int | float) and not name.startswith(NO_MEASURES)
    }


def _told(place: Path) -> ToldCase | None:
    if place.name.endswith((".part", ".old")):
        return None
    failed = _read(place / "failed.json")
    if failed is not None:
        return ToldCase(place.name, str(failed.get("reason", "")), scan=failed.get("scan"))
    done = _read(place / "done.json")
    if done is None:
        return None
    return ToldCase(
        place.name,
        None,
        scan=done.get("scan"),
        labels=done.get("labels"),
        segments=done.get("segments", {}),
        warnings=done.get("warnings", []),
        files=done.get("files", []),
        wall_s=done.get("wall_s"),
        thumbnail=_picture(place / THUMBNAIL),
    )


def _picture(path: Path) -> bytes | None:
    try:
        return path.read_bytes()
    except OSError:
        return None


def _read(path: Path) -> dict[str, Any] | None:
    try:
        told = json.loads(path.read_text("utf-8"))
    except (OSError, ValueError):
        return None
    return told if isinstance(told, dict) else None


def _mark_outliers(cases: list[ToldCase]) -> None:
    found: dict[tuple[str, str], list[tuple[ToldCase, float]]] = {}
    for case in cases:
        for segment, row in case.segments.items():
            for name, value in measures_of(row).items():
                found.setdefault((segment, name), []).append((case, value))
    for place, each in found.items():
        for (case, _), far in zip(each, outliers([value for _, value in each]), strict=True):
            if far:
                case.outliers.append(place)
