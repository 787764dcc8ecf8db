"""What ``palpate bench render`` measures of pictures that a person sees, whoever draws them.

Scans are opened, turned and drilled on the page. Where the engine draws, its moving pictures are
compared with sharp ones, the servo is watched beside them, and their times are held against VTK's
ray caster and vtk.js. What is missing, such as VTK, is told and has no rows.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from palpate.base.errors import OptionError
from palpate.base.progress import Progress
from palpate.bench.goals.seen import (
    BETTER_CASE,
    GIVEN_SCAN,
    LATE_CASE,
    SEEN_SCANS,
    VTK_CASE,
    VTK_JS_CASE,
    moving_case,
    seen_case,
)
from palpate.bench.haptics_data import AMOS, CTHEAD, LIDC, MissingDataError, data_file
from palpate.bench.page import opened, served
from palpate.bench.pictures.beside_vtk import beside_vtk, beside_vtk_js
from palpate.bench.pictures.moving_quality import moving_quality
from palpate.bench.pictures.seen import WINDOW, Looking, seen
from palpate.bench.pictures.servo_beside_pictures import late_beside_pictures
from palpate.io.reading import read
from palpate.saved.opening import opening_of

__all__ = ["SeenEffort", "measure_seen"]

Report = dict[str, dict[str, float]]
"""Figures by their case."""

FILES = {"CThead": CTHEAD, "AMOS": AMOS, "LIDC": LIDC}


@dataclass(frozen=True)
class SeenEffort:
    """How much is measured."""

    looking: Looking = field(default_factory=Looking)
    views: int = 6
    """Moving pictures of each scan that are compared."""
    pairs: int = 6
    """Spans of the servo with and without pictures."""
    span: float = 4.0
    """Length of each span [s]."""
    rounds: int = 7
    """Timed rounds beside VTK."""
    vtk_size: tuple[int, int] = (806, 696)
    """Columns and rows; the page's view in a window of 1366 × 768."""
    vtk_js_size: tuple[int, int] = (320, 240)


def measure_seen(
    scan: Path | None,
    *,
    drawer: str | None,
    peer: Path | None,
    effort: SeenEffort,
    progress: Progress,
) -> tuple[Report, list[str]]:
    """Measures a scan, or else those of the data folder.

    Args:
        scan: A scan.
        drawer: "engine" or "browser"; None leaves it to the page.
        peer: Script that draws with vtk.js.
        effort: How much is measured.
        progress: Takes the progress.

    Returns:
        The figures, and sentences on what is missing.

    Raises:
        OptionError: A browser or a scan cannot be used.
        MissingDataError: None of the scans is there.
    """
    scans, missing = _found(scan)
    report: Report = {}
    by_engine = False
    coarsest = 0.0
    for name, path in scans.items():
        if name not in (*SEEN_SCANS, GIVEN_SCAN):
            continue
        progress(f"looking at {name}", None)
        figures = seen(path, effort.looking, drawer=drawer)
        by_engine = figures.pop("by engine") > 0.0
        report[seen_case(name, by_engine=by_engine)] = figures
        coarsest = max(coarsest, figures.get("coarsest", 0.0))
    if by_engine and coarsest > 0.0:
        report |= _engine(scans, coarsest, effort=effort, progress=progress)
        first = next(iter(scans.values()))
        found, lacking = _beside(first, peer=peer, effort=effort, progress=progress)
        report |= found
        missing += lacking
    return report, missing


def _found(scan: Path | None) -> tuple[dict[str, Path], list[str]]:
    """Returns the scans by their names in the table, and sentences on those that are missing."""
    if scan is not None:
        return {GIVEN_SCAN: scan}, []
    found, missing = {}, []
    for name, file in FILES.items():
        try:
            found[name] = data_file(file)
        except MissingDataError as error:
            missing.append(f"{name}: no {error}")
    if not found:
        raise MissingDataError(CTHEAD)
    return found, missing


def _engine(
    scans: dict[str, Path], divisor: float, *, effort: SeenEffort, progress: Progress
) -> Report:
    """Measures how like moving pictures are, and how late the servo is beside them."""
    report: Report = {}
    for name, path in scans.items():
        progress(f"moving pictures of {name}", None)
        scene = opening_of(read(path)).scene
        report[moving_case(name)] = moving_quality(scene, divisor=divisor, views=effort.views)
    progress("servo beside pictures", None)
    scene = opening_of(read(next(iter(scans.values())))).scene
    report[LATE_CASE] = late_beside_pictures(scene, pairs=effort.pairs, seconds=effort.span)
    return report


def _beside(
    path: Path, *, peer: Path | None, effort: SeenEffort, progress: Progress
) -> tuple[Report, list[str]]:
    """Compares the engine with VTK and vtk.js; returns also what of them is missing."""
    report: Report = {}
    missing = []
    volume = read(path)
    progress("beside VTK", None)
    try:
        report[VTK_CASE] = beside_vtk(volume, rounds=effort.rounds, size=effort.vtk_size)
    except OptionError as error:
        missing.append(f"beside VTK: {error}")
    if peer is not None:
        progress("beside vtk.js", None)
        with served(path) as url, opened(url, **WINDOW, drawer="engine") as page:
            page.wait("window.palpate.finished && window.palpate.bench.scene() !== null")
            report[VTK_JS_CASE] = beside_vtk_js(
                volume,
                page,
                peer.read_text(encoding="utf-8"),
                rounds=effort.rounds,
                size=effort.vtk_js_size,
            )
    if len(report) == len((VTK_CASE, VTK_JS_CASE)):
        report[BETTER_CASE] = {"ratio": min(figures["ratio"] for figures in report.values())}
    return report, missing
