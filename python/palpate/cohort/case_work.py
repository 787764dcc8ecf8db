"""What the process of a case does: reads the recipe, runs it, measures what came of it."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from time import monotonic
from typing import Any

from palpate.base.errors import OptionError, PalpateError
from palpate.base.package_version import package_version
from palpate.cohort.case_figures import THUMBNAIL, measured_segments, write_thumbnail
from palpate.cohort.inputs import inputs_of, recipe_hash, told_inputs
from palpate.export.kinds import Kind, kind_of
from palpate.recipes.check import check_options, read_inputs
from palpate.recipes.filled import filled, placed
from palpate.recipes.recipe import recipe_of
from palpate.recipes.run import run_recipe
from palpate.recipes.source import read_source
from palpate.recipes.steps import Recipe

__all__ = ["work"]

HOLD_SEGMENTS: tuple[Kind, ...] = ("seg-nrrd", "labels", "dicom-seg", "dicom-labelmap", "rtstruct")


def work(request: dict[str, Any], part: Path) -> dict[str, Any]:
    """Runs a case into its folder; returns what ``done.json`` tells.

    Raises:
        PalpateError: A step cannot be done.
        OSError: A file cannot be read, or the disk refuses one.
    """
    begun = monotonic()
    scan = request["scan"]
    source = read_source(Path(request["recipe"]))
    source = filled(source, request["variables"], scan=None if scan is None else Path(scan))
    inputs = told_inputs(inputs_of(source))
    recipe = placed(recipe_of(source), source, part)
    check_options(recipe, source)
    try:
        made = run_recipe(recipe, read_inputs(recipe, source))
    except PalpateError as error:
        raise OptionError(source.said(str(error))) from error
    measured, of_names = measured_segments(made.scene, made.measures.columns)
    write_thumbnail(made.scene, part / THUMBNAIL)
    return {
        "recipe_sha256": recipe_hash(source),
        "inputs": inputs,
        "palpate": package_version(),
        "wall_s": round(monotonic() - begun, 3),
        "cpu_s": round(sum(os.times()[:4]), 3),
        "peak_memory_bytes": _peak_memory(),
        "warnings": [source.said(sentence) for sentence in (*made.told, *of_names)],
        "files": [path.relative_to(part).as_posix() for path in made.written],
        "labels": _labels(recipe, part),
        "scan": None if recipe.scan is None else str(recipe.scan.path),
        "segments": measured,
    }


def _labels(recipe: Recipe, part: Path) -> str | None:
    """Returns the first file that holds the segments: `palpate open --segments` takes it."""
    for export in recipe.export:
        kind = export.kind or kind_of(export.out, has_segments=bool(recipe.segment))
        if kind in HOLD_SEGMENTS:
            return export.out.relative_to(part).as_posix()
    return None


def _peak_memory() -> int | None:
    if sys.platform == "win32":
        return None
    import resource

    peak = max(
        resource.getrusage(who).ru_maxrss
        for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    )
    return peak if sys.platform == "darwin" else peak * 1024
