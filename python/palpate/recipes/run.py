"""Does what a recipe says, without a page: scan, segments, surfaces, files, report."""

from __future__ import annotations

from pathlib import Path

from palpate.base.errors import OptionError
from palpate.base.progress import Progress, silent
from palpate.base.typed_numbers import parse_voxel_size
from palpate.export.export import export_scene
from palpate.export.image import write_scan
from palpate.io.reading import read
from palpate.recipes.recipe import Recipe
from palpate.recipes.report import write_report
from palpate.recipes.steps import RegisterStep
from palpate.reconstruction.request import reconstruct_file
from palpate.registration.registration import register
from palpate.registration.report import report_of, sentence_of, write_checkerboard
from palpate.volumes.mesh_write import write_mesh
from palpate.volumes.scene import Scene, choose_segment
from palpate.volumes.surface import Surface
from palpate.volumes.volume import Volume

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
    written: list[Path] = []
    volume = _scan(recipe, written, progress)
    told = list(volume.warnings)
    if recipe.register is not None:
        volume = _registered(volume, recipe.register, log=(told, written), progress=progress)
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
        told += made_surface.report().warnings
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


def _scan(recipe: Recipe, written: list[Path], progress: Progress) -> Volume:
    """Returns the scan that a recipe begins with: read, or made of projections."""
    if recipe.reconstruct is not None:
        made = recipe.reconstruct
        volume = reconstruct_file(made.path, made.request(), name=made.path.stem, progress=progress)
        if made.output is not None:
            write_scan(volume, made.output)
            written.append(made.output)
        return volume
    step = recipe.scan
    if step is None:
        raise OptionError("no scan given; allowed: 'import' or 'reconstruct'")
    return read(
        step.path,
        series=None if step.series is None else str(step.series),
        frame=step.frame,
        orientation=step.orientation,
        unit=step.unit,
        fill=step.fill,
        strict=step.strict,
        raw=step.raw,
        voxel_size=parse_voxel_size(step.voxel_size),
        progress=progress,
    )


def _registered(
    fixed: Volume,
    step: RegisterStep,
    *,
    log: tuple[list[str], list[Path]],
    progress: Progress,
) -> Volume:
    """Brings another scan to the first one; returns the one to go on with."""
    told, written = log
    series = None if step.moving_series is None else str(step.moving_series)
    moving = read(step.moving, series=series, frame=step.moving_frame, progress=progress)
    found = register(
        fixed, moving, kind=step.kind, metric=step.metric, start=step.start, progress=progress
    )
    told += [*moving.warnings, f"registration: {sentence_of(report_of(found, fixed, moving))}"]
    if step.output is not None:
        found.save(step.output)
        written.append(step.output)
    if step.resampled is not None:
        write_scan(found.resampled(moving, fixed), step.resampled)
        written.append(step.resampled)
    if step.picture is not None:
        write_checkerboard(found, fixed, moving, path=step.picture)
        written.append(step.picture)
    return found.resampled(moving, fixed) if step.go_on_with == "moving" else fixed
