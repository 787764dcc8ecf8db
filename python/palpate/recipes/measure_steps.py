"""Steps of a recipe that measure segments and make none."""

from __future__ import annotations

from pathlib import Path

from palpate.base.progress import Progress
from palpate.recipes.measures import Measures, Table
from palpate.recipes.steps import Recipe
from palpate.segmentation.measures.comparison_request import CompareRequest
from palpate.segmentation.measures.comparison_table import comparison_cells, comparison_row
from palpate.segmentation.measures.landmarks_request import LandmarksRequest, landmark_cells
from palpate.session.touch_request import TouchRequest
from palpate.volumes.scene import Scene

__all__ = ["measure"]

NO_NUMBERS = ("segment", "reference", "volume_ml", "note")
"""Columns of a comparison that a cohort has already, or that say no number."""


def measure(
    scene: Scene, recipe: Recipe, *, log: tuple[list[str], list[Path]], progress: Progress
) -> Measures:
    """Does the steps that measure.

    Args:
        scene: The scan and its segments.
        recipe: The recipe.
        log: Takes what a person should know, and the files that are written.
        progress: Takes the progress.

    Raises:
        PalpateError: A step cannot be done.
        OSError: The disk refuses a file.
    """
    told, written = log
    measures = Measures()
    for compared in recipe.compare:
        told += _compare(scene, compared, measures, progress=progress)
        written += [] if compared.out is None else [compared.out]
    for listed in recipe.landmarks:
        told += _landmarks(scene, listed, measures)
        written += [] if listed.out is None else [listed.out]
    for touched in recipe.touch:
        progress("touching", None)
        told += _touch(scene, touched, measures)
        written += [path for path in (touched.out, touched.plot) if path is not None]
    return measures


def _compare(
    scene: Scene, step: CompareRequest, measures: Measures, *, progress: Progress
) -> tuple[str, ...]:
    found = step.compare(scene, progress=progress)
    title = f"Compared with {step.reference.name}"
    measures.tables.append(Table(title, comparison_cells(found)))
    for one in found.segments:
        row = comparison_row(one)
        measures.note(one.name, {name: row[name] for name in row if name not in NO_NUMBERS})
    return found.warnings


def _landmarks(scene: Scene, step: LandmarksRequest, measures: Measures) -> list[str]:
    found, told = step.find(scene)
    measures.tables.append(Table("Landmarks", landmark_cells(found)))
    for each in found:
        axes = zip("LPS", each.point, strict=True)
        measures.note(each.segment, {f"landmark_{each.name}_{axis}_mm": n for axis, n in axes})
    return told


def _touch(scene: Scene, step: TouchRequest, measures: Measures) -> tuple[str, ...]:
    # recipes without touch need no session
    from palpate.session.touch_table import touch_and_write, touch_cells, touch_row

    felt = touch_and_write(scene, step)
    measures.tables.append(Table(f"Touched: {felt.do} of {felt.segment}", touch_cells(felt)))
    measures.note(felt.segment, touch_row(felt))
    return felt.warnings
