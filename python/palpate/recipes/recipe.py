"""Recipes: a scan, its segments and what is written of them, in one file.

A recipe is YAML. Its keys are the stages of the pipeline (thesis 2.2.1), theirs the options of the
commands: ``import`` or ``reconstruct``, ``register``, ``segment``, ``surface``, ``export``; and
where the ``report`` goes. Files stand beside the recipe. What is wrong is told with its line, step
and key.
"""

from __future__ import annotations

from pathlib import Path
from typing import TypeVar, get_args, get_origin

from palpate.base.nearest import perhaps
from palpate.base.request import Request, options_of, shown
from palpate.recipes.check import check_options
from palpate.recipes.source import Source, read_source
from palpate.recipes.steps import Recipe

__all__ = ["Recipe", "read_recipe", "recipe_of"]

Made = TypeVar("Made", bound=Request)


def read_recipe(path: Path) -> tuple[Recipe, Source]:
    """Reads a recipe and checks its options; names of files are then as this process sees them.

    Raises:
        FileNotFoundError: The recipe does not exist.
        OptionError: Something in it is wrong; the message says where.
    """
    source = read_source(path)
    recipe = recipe_of(source)
    check_options(recipe, source)
    return recipe, source


def recipe_of(source: Source) -> Recipe:
    """Returns the recipe that a text says; types of its values are checked, and no more.

    Raises:
        OptionError: Something in it is wrong; the message says where.
    """
    return _made(Recipe, source.given, "$", source=source)


def _made(kind: type[Made], given: object, where: str, *, source: Source) -> Made:
    """Returns a request of what stands at a place of a recipe."""
    options = {each.name: each for each in options_of(kind)}
    if not isinstance(given, dict):
        raise source.wrong(where, f"{shown(given)} given; allowed: {', '.join(options)}")
    for key in given:
        if key not in options:
            near = perhaps(key, options)
            raise source.wrong(
                f"{where}.{key}",
                f"{str(key)!r} is no option here{near}; allowed: {', '.join(options)}",
            )
    for name, option in options.items():
        if option.required and name not in given:
            raise source.wrong(where, f"{name!r} is missing; allowed: {option.allowed}")
    values = {}
    for key, value in given.items():
        option, place = options[key], f"{where}.{key}"
        step = _step_of(option.kind)
        if step is not None and isinstance(value, list) == (get_origin(option.kind) is list):
            values[option.field] = (
                _made(step, value, place, source=source)
                if step is option.kind
                else [
                    _made(step, each, f"{place}[{number}]", source=source)
                    for number, each in enumerate(value)
                ]
            )
            continue
        with source.at(place):
            values[option.field] = option.value(value, folder=source.path.parent)
    return kind(**values)


def _step_of(kind: object) -> type[Request] | None:
    """Returns the request that an option is, or that it is a list of."""
    (inner,) = get_args(kind) if get_origin(kind) is list else (kind,)
    return inner if isinstance(inner, type) and issubclass(inner, Request) else None
