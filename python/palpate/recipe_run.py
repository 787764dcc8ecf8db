"""Does what a recipe says, without a page: scan, segments, surfaces, files, report."""

from __future__ import annotations

from pathlib import Path

from palpate.cli_surface import choose_segment
from palpate.errors import OptionError
from palpate.export import export_scene
from palpate.io import read
from palpate.mesh_write import write_mesh
from palpate.progress import Progress, silent
from palpate.recipe import Recipe
from palpate.recipe_report import write_report
from palpate.scene import Scene
from palpate.surface import Surface

__all__ = ["run_recipe"]


def run_recipe(
    recipe: Recipe, *, progress: Progress = silent
) -> tuple[Scene, list[Path], list[str]]:
    """Does all steps in order.

    Returns:
        The scan with its segments, the files that were written, and what a person should know.

    Raises:
        PalpateError: A step cannot be done; files of steps before it stay.
        OSError: The disk refuses a file.
    """
    step = recipe.scan
    volume = read(
        step.path,
        series=None if step.series is None else str(step.series),
        orientation=step.orientation,
        unit=step.unit,
        fill=step.fill,
        progress=progress,
    )
    told, written = list(volume.warnings), []
    scene = Scene(volume)
    for request in recipe.segment:
        made, warnings = request.make(volume, progress=progress)
        told += warnings
        for one in made:
            if one.name in {shown.name for shown in scene}:
                raise OptionError(f"two segments are called {one.name!r}; allowed: a name for each")
            scene.add(one)
    for surface in recipe.surface:
        progress(f"writing {surface.out.name}", None)
        chosen = choose_segment(scene, surface.segment)
        made_surface = Surface(
            chosen, step=surface.step, smoothing=surface.smoothing, source=surface.source
        )
        write_mesh(made_surface.mesh(), surface.out)
        written.append(surface.out)
    for export in recipe.export:
        told += export_scene(
            scene,
            export.out,
            kind=export.kind,
            only=export.only,
            keep_identity=export.keep_identity,
            progress=progress,
        )
        written.append(export.out)
    if recipe.report is not None:
        progress("writing the report", None)
        write_report(scene, recipe.report, written=written, told=told)
        written.append(recipe.report)
    return scene, written, told
