"""What of a recipe can be known to fail before its first step, and the scans that it reads.

What needs no scan is looked at first, so that most is told at once.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from palpate.base.errors import OptionError
from palpate.base.nearest import perhaps
from palpate.base.progress import Progress, silent
from palpate.base.replacing import check_replaceable
from palpate.base.request import Request
from palpate.base.request_files import check_file, files_of
from palpate.export.carried_file import carried_kind, carried_table, check_ending
from palpate.export.dicom_source import dicom_source
from palpate.export.kinds import FROM_DICOM
from palpate.export.request import ExportRequest
from palpate.recipes.register_step import read_mask, read_moving
from palpate.recipes.source import Source
from palpate.recipes.steps import (
    Recipe,
    ReconstructStep,
    RegisterStep,
    TransformStep,
    steps_of,
)
from palpate.reconstruction.projections import stack_at
from palpate.reconstruction.reconstruction import missing_library
from palpate.reconstruction.request import grid_of
from palpate.session.touch_request import TouchRequest
from palpate.volumes.surface_request import SurfaceRequest
from palpate.volumes.volume import Volume

__all__ = ["Inputs", "check_options", "read_inputs"]

OF_ONE = (SurfaceRequest, TouchRequest)
"""Steps that take one segment, and must be told which where there are several."""


@dataclass(frozen=True)
class Inputs:
    """The scans that a recipe reads."""

    scan: Volume | None
    """None where it is reconstructed."""
    moving: Volume | None


def check_options(recipe: Recipe, source: Source) -> None:
    """Refuses what cannot be done, whatever the scan is like.

    Raises:
        OptionError: Something is wrong; the message says where.
    """
    if (recipe.scan is None) == (recipe.reconstruct is None):
        given = "neither" if recipe.scan is None else "both"
        raise source.wrong("$", f"{given} given; allowed: 'import' or 'reconstruct', one of both")
    if not recipe.segment:
        raise source.wrong("$.segment", "no segment given; allowed: one or more")
    _check_files(recipe, source)
    for where, step in steps_of(recipe):
        check = getattr(step, "check", None)
        if check is not None:
            with source.at(where):
                check()
    for number, carried in enumerate(recipe.transform):
        # what another step writes is not there yet
        if carried.path.exists():
            with source.at(f"$.transform[{number}].output"):
                check_ending(carried_kind(carried.path), carried.output)
    if recipe.reconstruct is not None:
        _check_reconstruct(recipe.reconstruct, source)
    _check_names(recipe, source)
    if recipe.reconstruct is not None:
        _refuse_dicom(recipe, source, "a reconstruction comes from no DICOM files")
    if recipe.register is not None and recipe.register.go_on_with == "moving":
        _refuse_dicom(recipe, source, "a resampled scan comes from no DICOM files")


def read_inputs(recipe: Recipe, source: Source, *, progress: Progress = silent) -> Inputs:
    """Reads the scans and refuses what cannot be done with them; writes nothing.

    Raises:
        OptionError: A file cannot be read, or a step cannot be done; the message says where.
    """
    scan = moving = None
    if recipe.scan is not None:
        with source.at("$.import"):
            scan = recipe.scan.read(recipe.scan.path, progress)
    if recipe.register is not None:
        with source.at("$.register"):
            moving = read_moving(recipe.register, progress=progress)
        _check_masks(recipe.register, scan, moving, source=source)
    if scan is not None:
        _check_on(recipe, scan, source, progress=progress)
    return Inputs(scan, moving)


def _check_reconstruct(step: ReconstructStep, source: Source) -> None:
    with source.at("$.reconstruct.path"):
        stack = stack_at(step.path)
    with source.at("$.reconstruct"):
        grid_of(stack, step)
        missing = missing_library(step.beam)
        if missing is not None:
            raise OptionError(missing)


def _check_names(recipe: Recipe, source: Source) -> None:
    """Refuses a name that two segments have, and names of segments that there will not be."""
    known: list[str] = []
    for number, request in enumerate(recipe.segment):
        names = request.names
        if names is None:
            # what a file or a program calls them is seen once they are there
            return
        for name in names:
            if name in known:
                raise source.wrong(
                    f"$.segment[{number}].name",
                    f"two segments are called {name!r}; allowed: a name for each",
                )
        known += names
    for where, step in steps_of(recipe):
        if isinstance(step, OF_ONE) and step.segment is None and len(known) > 1:
            raise source.wrong(f"{where}.segment", f"no segment given; allowed: {', '.join(known)}")
    numbers = [str(number + 1) for number in range(len(known))]
    for where, name in _names_used(recipe):
        # a number is one of the list
        if name not in numbers or ".only[" in where:
            with source.at(where):
                _check_name(name, known)


def _names_used(recipe: Recipe) -> Iterator[tuple[str, str]]:
    """Yields names of segments that steps take, with their places."""
    for where, step in steps_of(recipe):
        segment = getattr(step, "segment", None)
        if isinstance(segment, str):
            yield f"{where}.segment", segment
        if isinstance(step, TouchRequest):
            for place, name in enumerate(step.rigid):
                yield f"{where}.rigid[{place}]", name
        if isinstance(step, ExportRequest):
            for place, name in enumerate(step.only or ()):
                yield f"{where}.only[{place}]", name


def _check_name(name: str, known: list[str]) -> None:
    if name not in known:
        near = perhaps(name, known)
        raise OptionError(f"segment {name!r} given{near}; allowed: {', '.join(known)}")


def _check_files(recipe: Recipe, source: Source) -> None:
    """Refuses files that cannot be read or written, and those that would replace others.

    What a step reads may be written by one before it.
    """
    read: set[Path] = set()
    written: set[Path] = set()
    for where, step in steps_of(recipe):
        for option, path in files_of(step):
            place = path.resolve()
            with source.at(f"{where}.{option.name}"):
                if option.writes:
                    _check_new(path, str(path), read=read, written=written)
                if not (option.reads and place in written):
                    check_file(option, path)
            (written if option.writes else read).add(place)
        out = "out" if isinstance(step, ExportRequest) else "output"
        with source.at(f"{where}.{out}"):
            table = _table_of(step, written)
            if table is not None:
                called = f"{table.name}, the table of names that comes beside it,"
                _check_new(table, called, read=read, written=written)
                check_replaceable(table)
                written.add(table.resolve())


def _check_new(path: Path, called: str, *, read: set[Path], written: set[Path]) -> None:
    place = path.resolve()
    if place in read | written:
        done = "written" if place in written else "read"
        raise OptionError(f"{called} is {done} by another step; allowed: a new file")


def _table_of(step: Request, written: set[Path]) -> Path | None:
    """Returns the table of names that a step writes beside its image; None where there is none."""
    if isinstance(step, ExportRequest):
        return step.table(written)
    # what another step writes is not there yet
    if isinstance(step, TransformStep) and step.path.exists():
        return carried_table(carried_kind(step.path), step.output, planned=written)
    return None


def _refuse_dicom(recipe: Recipe, source: Source, why: str) -> None:
    """Refuses files that refer to the DICOM files of the scan."""
    for number, export in enumerate(recipe.export):
        if export.kind_for(has_segments=True) in FROM_DICOM:
            raise source.wrong(
                f"$.export[{number}].out",
                f"{export.out.name!r} would refer to DICOM files, but {why}; allowed: .seg.nrrd, "
                "NIfTI or NRRD",
            )


def _check_masks(
    step: RegisterStep, scan: Volume | None, moving: Volume, *, source: Source
) -> None:
    for name, path, volume in (
        ("fixed-mask", step.fixed_mask, scan),
        ("moving-mask", step.moving_mask, moving),
    ):
        if path is not None and volume is not None:
            with source.at(f"$.register.{name}"):
                read_mask(path, volume, step, progress=silent)


def _check_on(recipe: Recipe, scan: Volume, source: Source, *, progress: Progress) -> None:
    """Refuses what cannot be done with this scan."""
    if recipe.register is None or recipe.register.go_on_with == "fixed":
        for number, request in enumerate(recipe.segment):
            with source.at(f"$.segment[{number}]"):
                request.check_on(scan, progress=progress)
        for number, compared in enumerate(recipe.compare):
            with source.at(f"$.compare[{number}].reference"):
                compared.check_on(scan, progress=progress)
    for number, export in enumerate(recipe.export):
        if export.kind_for(has_segments=True) in FROM_DICOM:
            with source.at(f"$.export[{number}].out"):
                _check_dicom(export, scan, progress)


def _check_dicom(export: ExportRequest, scan: Volume, progress: Progress) -> None:
    with dicom_source(scan, complete=not export.keep_identity, progress=progress):
        pass
