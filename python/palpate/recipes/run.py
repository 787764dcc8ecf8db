"""Does what a recipe says, without a page: scan, segments, surfaces, files, report."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from palpate.base.errors import OptionError
from palpate.base.progress import Progress, silent
from palpate.export.export import export_scene
from palpate.export.image import write_scan
from palpate.recipes.check import Inputs
from palpate.recipes.measure_steps import measure
from palpate.recipes.measures import Measures
from palpate.recipes.register_step import registered
from palpate.recipes.report import write_report
from palpate.recipes.steps import Recipe, RegisterStep
from palpate.recipes.transform_step import carried
from palpate.reconstruction.request import reconstruct_file
from palpate.registration.report import sentence_of
from palpate.volumes.mesh_write import write_mesh
from palpate.volumes.scene import Scene, choose_segment
from palpate.volumes.surface import Surface
from palpate.volumes.volume import Volume

__all__ = ["RecipeResult", "run_recipe"]


@dataclass(frozen=True)
class RecipeResult:
    """What a recipe made."""

    scene: Scene
    """The scan with its segments."""
    written: list[Path]
    told: list[str]
    """What a person should know."""
    measures: Measures


def run_recipe(recipe: Recipe, inputs: Inputs, *, progress: Progress = silent) -> RecipeResult:
    """Does all steps in order.

    Args:
        recipe: What is to be done.
        inputs: Its scans, as ``palpate.recipes.check.read_inputs`` read and checked them.
        progress: Takes the progress.

    Raises:
        PalpateError: A step cannot be done; files of steps before it stay.
        OSError: The disk refuses a file.
    """
    written: list[Path] = []
    volume = _scan(recipe, inputs, written, progress=progress)
    told = list(volume.warnings)
    if recipe.register is not None and inputs.moving is not None:
        pair = (volume, inputs.moving)
        volume = _registered(pair, recipe.register, log=(told, written), progress=progress)
    scene = Scene(volume)
    told += _add_segments(scene, recipe, progress=progress)
    for surface in recipe.surface:
        progress(f"writing {surface.out.name}", None)
        chosen = choose_segment(scene, surface.segment)
        made_surface = Surface(
            chosen, step=surface.step, smoothing=surface.smoothing, source=surface.source
        )
        write_mesh(made_surface.mesh(), surface.out)
        told += made_surface.report().warnings
        written.append(surface.out)
    for export in recipe.export:
        told += export_scene(
            scene,
            export.out,
            kind=export.kind,
            only=export.only,
            keep_identity=export.keep_identity,
            pixels_checked=export.pixels_checked,
            progress=progress,
        )
        written.append(export.out)
    measures = measure(scene, recipe, log=(told, written), progress=progress)
    for carried_step in recipe.transform:
        told += carried(carried_step, volume, progress=progress)
        written.append(carried_step.output)
    for picture in recipe.picture:
        written += picture.write(scene, progress=progress)
    if recipe.report is not None:
        progress("writing the report", None)
        tables = measures.tables
        write_report(scene, recipe.report, written=written, told=told, tables=tables)
        written.append(recipe.report)
    return RecipeResult(scene, written, told, measures)


def _add_segments(scene: Scene, recipe: Recipe, *, progress: Progress) -> list[str]:
    """Makes all segments; returns what a person should know of them.

    Raises:
        OptionError: Two have one name, or one that is to be written is not there.
    """
    told: list[str] = []
    for request in recipe.segment:
        made, warnings = request.make(scene.volume, progress=progress)
        told += warnings
        for one in made:
            if one.name in {shown.name for shown in scene}:
                raise OptionError(f"two segments are called {one.name!r}; allowed: a name for each")
            scene.add(one)
    # names that files and programs give are known from here on
    for surface in recipe.surface:
        choose_segment(scene, surface.segment)
    for export in recipe.export:
        for name in export.only or ():
            choose_segment(scene, name)
    return told


def _scan(recipe: Recipe, inputs: Inputs, written: list[Path], *, progress: Progress) -> Volume:
    """Returns the scan that a recipe begins with: read, or made of projections."""
    if inputs.scan is not None:
        return inputs.scan
    step = recipe.reconstruct
    if step is None:
        raise OptionError("no scan given; allowed: 'import' or 'reconstruct'")
    volume = reconstruct_file(step.path, step, name=step.path.stem, progress=progress)
    if step.output is not None:
        write_scan(volume, step.output)
        written.append(step.output)
    return volume


def _registered(
    pair: tuple[Volume, Volume],
    step: RegisterStep,
    *,
    log: tuple[list[str], list[Path]],
    progress: Progress,
) -> Volume:
    """Brings another scan to the first one; returns the one to go on with."""
    told, written = log
    fixed, moving = pair
    made = registered(fixed, moving, step, progress=progress)
    told += [*moving.warnings, *made.warnings, f"registration: {sentence_of(made.report)}"]
    written += made.written
    if step.go_on_with == "fixed":
        return fixed
    return made.found.resampled(moving, fixed, interpolation=step.interpolation)
