"""Recipes: a scan, its segments and what is written of them, in one file.

A recipe is YAML. Its keys are the stages of the pipeline (thesis 2.2.1), theirs the options of the
commands: ``import`` or ``reconstruct``, ``register``, ``segment``, ``surface``, ``export``,
``transform``; and where the ``report`` goes. Files stand beside the recipe. All of it is checked
before anything is read, with the line of what is wrong.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import msgspec
import yaml

from palpate.base.damaged_file import BROKEN
from palpate.base.errors import OptionError, PalpateError
from palpate.base.plain_file import check_plain
from palpate.base.typed_numbers import parse_voxel_size
from palpate.base.whole_file import check_target
from palpate.export.export import check_export, kind_of
from palpate.export.image import IMAGE_SUFFIXES
from palpate.recipes.steps import (
    ExportStep,
    ImportStep,
    ReconstructStep,
    RegisterStep,
    SurfaceStep,
)
from palpate.recipes.transform_step import TransformStep
from palpate.reconstruction.projections import stack_at
from palpate.reconstruction.reconstruction import missing_library
from palpate.reconstruction.request import grid_of
from palpate.segmentation.request import SegmentRequest
from palpate.volumes.mesh_write import SUFFIXES

__all__ = ["Recipe", "read_recipe"]

DEEPEST = 16
"""Of lists and options in one another."""
MOST_BYTES = 1 << 20
"""A larger file is no recipe."""


class Recipe(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What is to be done, in this order."""

    scan: ImportStep | None = msgspec.field(default=None, name="import")
    reconstruct: ReconstructStep | None = None
    """In the place of ``import``."""
    register: RegisterStep | None = None
    segment: list[SegmentRequest]
    surface: list[SurfaceStep] = []
    export: list[ExportStep] = []
    transform: list[TransformStep] = []
    report: Path | None = None


@dataclass(frozen=True)
class Source:
    """The text of a recipe, by which what is wrong is told."""

    path: Path
    lines: dict[str, int]
    """Where each value stands, by its way from the root, such as ``$.segment[0].smooth``."""

    def wrong(self, where: str, why: object) -> OptionError:
        """Returns an error that names the line of a value, or of the nearest one around it."""
        while where not in self.lines and where != "$":
            around = re.sub(r"(\.[^.\[]*|\[\d+\])$", "", where)
            # the name of an option may be of any form
            where = around if around != where else "$"
        return OptionError(f"{self.path}, line {self.lines.get(where, 1)}: {why}")

    @contextmanager
    def at(self, where: str) -> Iterator[None]:
        """Gives what is refused within the line of a value."""
        try:
            yield
        except (PalpateError, OSError) as error:
            raise self.wrong(where, error) from None


def read_recipe(path: Path) -> Recipe:
    """Reads a recipe and checks it; names of files are then as this process sees them.

    Raises:
        FileNotFoundError: The recipe does not exist.
        OptionError: Something in it is wrong; the message says where.
    """
    check_plain(path)
    if path.stat().st_size > MOST_BYTES:
        raise OptionError(f"{path} is larger than {MOST_BYTES} bytes; allowed: a recipe")
    try:
        text = path.read_text("utf-8")
        _refuse_aliases(path, text)
        root = yaml.compose(text, Loader=yaml.SafeLoader)
        given = yaml.SafeLoader("").construct_document(root) if root is not None else None
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        line = 1 if mark is None else mark.line + 1
        raise OptionError(f"{path}, line {line}: {error.problem or error.context}") from None
    except PalpateError:
        raise
    except (yaml.YAMLError, *BROKEN) as error:
        raise OptionError(f"{path} is no YAML: {' '.join(str(error).split())}") from None
    if root is None:
        raise OptionError(f"{path} is empty; allowed: a recipe, as `palpate run --help` shows one")
    source = Source(path, dict(_lines(root, "$")))
    _refuse_twice(root, "$", source)
    folder = path.parent

    def from_text(kind: type, value: object) -> object:
        if kind is Path and isinstance(value, str) and value:
            return folder / value
        raise ValueError(f"{value!r} given; allowed: the name of a file")

    try:
        recipe = msgspec.convert(given, Recipe, dec_hook=from_text)
    except (msgspec.ValidationError, ValueError) as error:
        raise _told(error, source) from None
    _check(recipe, source)
    return recipe


def _told(error: Exception, source: Source) -> OptionError:
    """Says what does not fit, in the words of recipes, with its line."""
    said, _, place = str(error).partition(" - at `")
    where = place.rstrip("`") or "$"
    unknown = re.search(r"unknown field `(.*)`", said)
    if unknown is not None:
        where, said = f"{where}.{unknown[1]}", f"{unknown[1]!r} is no option here"
        kind = _kind_at(where)
        names = ", ".join(field.encode_name for field in msgspec.structs.fields(kind))
        said = f"{said}; allowed: {names}"
    missing = re.search(r"missing required field `(.*)`", said)
    if missing is not None:
        said = f"{missing[1]!r} is missing"
    return source.wrong(where, said)


def _kind_at(where: str) -> type[msgspec.Struct]:
    kinds: dict[str, type[msgspec.Struct]] = {
        "import": ImportStep,
        "reconstruct": ReconstructStep,
        "register": RegisterStep,
        "segment": SegmentRequest,
        "surface": SurfaceStep,
        "export": ExportStep,
        "transform": TransformStep,
    }
    way = re.match(r"\$\.(\w+)(\[\d+\])?\.", where)
    return Recipe if way is None else kinds.get(way[1], Recipe)


def _check(recipe: Recipe, source: Source) -> None:
    """Refuses what could not be done, whatever the scan is like."""
    _check_scan(recipe, source)
    if recipe.register is not None:
        _check_register(recipe.register, source)
    if not recipe.segment:
        raise source.wrong("$.segment", "no segment given; allowed: one or more")
    for number, request in enumerate(recipe.segment):
        with source.at(f"$.segment[{number}]"):
            request.check()
    names = _names(recipe)
    for number, surface in enumerate(recipe.surface):
        with source.at(f"$.surface[{number}].out"):
            check_target(surface.out, SUFFIXES)
        with source.at(f"$.surface[{number}].segment"):
            _check_name(surface.segment, names)
    for number, export in enumerate(recipe.export):
        with source.at(f"$.export[{number}]"):
            _check_export(export)
    made = {path for _, path in _written(recipe)}
    for number, step in enumerate(recipe.transform):
        with source.at(f"$.transform[{number}]"):
            step.check(made)
    if recipe.report is not None:
        with source.at("$.report"):
            check_target(recipe.report, (".html",))
    _refuse_same_file(recipe, source)


def _check_scan(recipe: Recipe, source: Source) -> None:
    if (recipe.scan is None) == (recipe.reconstruct is None):
        given = "neither" if recipe.scan is None else "both"
        raise source.wrong("$", f"{given} given; allowed: 'import' or 'reconstruct', one of both")
    if recipe.scan is not None:
        if not recipe.scan.path.exists():
            raise source.wrong("$.import.path", f"{recipe.scan.path} does not exist")
        with source.at("$.import.voxel-size"):
            parse_voxel_size(recipe.scan.voxel_size)
    if recipe.reconstruct is not None:
        _check_reconstruct(recipe.reconstruct, source)


def _check_reconstruct(step: ReconstructStep, source: Source) -> None:
    with source.at("$.reconstruct.path"):
        stack = stack_at(step.path)
    with source.at("$.reconstruct"):
        grid_of(stack, step.request())
        missing = missing_library(step.beam)
        if missing is not None:
            raise OptionError(missing)
    if step.output is not None:
        with source.at("$.reconstruct.output"):
            check_target(step.output, IMAGE_SUFFIXES)


def _check_register(step: RegisterStep, source: Source) -> None:
    if not step.moving.exists():
        raise source.wrong("$.register.moving", f"{step.moving} does not exist")
    for name, path, suffixes in (
        ("output", step.output, (".tfm",)),
        ("write_inverse", step.write_inverse, (".tfm",)),
        ("resampled", step.resampled, IMAGE_SUFFIXES),
        ("picture", step.picture, (".png",)),
    ):
        if path is not None:
            with source.at(f"$.register.{name}"):
                check_target(path, suffixes)


def _check_name(name: str | None, names: list[str] | None) -> None:
    if names is None or name in names or (name is None and len(names) == 1):
        return
    given = "no segment" if name is None else f"segment {name!r}"
    raise OptionError(f"{given} given; allowed: {', '.join(names)}")


def _check_export(step: ExportStep) -> None:
    kind = kind_of(step.out, has_segments=True) if step.kind is None else step.kind
    check_export(step.out, kind, keep_identity=step.keep_identity)


def _names(recipe: Recipe) -> list[str] | None:
    """Returns the names of all segments; None where they are known only once they are there."""
    named = [each.name for each in recipe.segment if each.otsu is None]
    certain = all(each.otsu is None and not each.auto and not each.seeds for each in recipe.segment)
    return [name for name in named if name is not None] if certain and all(named) else None


def _written(recipe: Recipe) -> list[tuple[str, Path]]:
    """Lists where a recipe names the files that it writes, and these."""
    register, reconstruct = recipe.register, recipe.reconstruct
    output = None if reconstruct is None else reconstruct.output
    return [
        *([] if output is None else [("$.reconstruct.output", output)]),
        *(
            (f"$.register.{name}", path)
            for name in ("output", "write_inverse", "resampled", "picture")
            if register is not None and (path := getattr(register, name)) is not None
        ),
        *((f"$.surface[{n}].out", step.out) for n, step in enumerate(recipe.surface)),
        *((f"$.export[{n}].out", step.out) for n, step in enumerate(recipe.export)),
        *((f"$.transform[{n}].output", step.output) for n, step in enumerate(recipe.transform)),
        *([("$.report", recipe.report)] if recipe.report is not None else []),
    ]


def _refuse_same_file(recipe: Recipe, source: Source) -> None:
    register, reconstruct = recipe.register, recipe.reconstruct
    written: set[Path] = {
        step.path.resolve() for step in (recipe.scan, reconstruct) if step is not None
    }
    if register is not None:
        written.add(register.moving.resolve())
    made = {p.resolve() for at, p in _written(recipe) if not at.startswith("$.transform")}
    for step in recipe.transform:
        written |= {step.path.resolve(), step.transform.resolve()} - made
        made.add(step.output.resolve())
    for where, path in _written(recipe):
        if path.resolve() in written:
            raise source.wrong(
                where, f"{path} is read or written by a step before; allowed: a new one"
            )
        written.add(path.resolve())


def _refuse_aliases(path: Path, text: str) -> None:
    """Refuses what stands for another part of the file, and lists in lists without end."""
    depth = 0
    for event in yaml.parse(text, Loader=yaml.SafeLoader):
        depth += isinstance(event, yaml.CollectionStartEvent)
        depth -= isinstance(event, yaml.CollectionEndEvent)
        if depth > DEEPEST:
            line = event.start_mark.line + 1
            raise OptionError(
                f"{path}, line {line}: lists and options {depth} deep; allowed: {DEEPEST}"
            )
        if isinstance(event, yaml.AliasEvent):
            line = event.start_mark.line + 1
            raise OptionError(f"{path}, line {line}: *{event.anchor} given; allowed: no aliases")


# --- lines ------------------------------------------------------------------------------


def _lines(node: yaml.Node, where: str) -> Iterator[tuple[str, int]]:
    """Yields where each value of a document stands."""
    yield where, node.start_mark.line + 1
    if isinstance(node, yaml.MappingNode):
        for key, value in node.value:
            yield from _lines(value, f"{where}.{key.value}")
            # the key's line, also where its value begins on the next one
            yield f"{where}.{key.value}", key.start_mark.line + 1
    elif isinstance(node, yaml.SequenceNode):
        for number, value in enumerate(node.value):
            yield from _lines(value, f"{where}[{number}]")


def _refuse_twice(node: yaml.Node | None, where: str, source: Source) -> None:
    """Refuses a key that is given twice: YAML would take the last one and say nothing."""
    if isinstance(node, yaml.MappingNode):
        seen: set[str] = set()
        for key, value in node.value:
            if not isinstance(key, yaml.ScalarNode):
                raise source.wrong(where, "a list as the name of an option; allowed: a word")
            if key.value in seen:
                raise source.wrong(f"{where}.{key.value}", f"{key.value!r} is given twice")
            seen.add(str(key.value))
            _refuse_twice(value, f"{where}.{key.value}", source)
    elif isinstance(node, yaml.SequenceNode):
        for number, value in enumerate(node.value):
            _refuse_twice(value, f"{where}[{number}]", source)
