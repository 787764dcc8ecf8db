"""A recipe for one of many scans: its variables filled in, its files in a folder of their own."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec

from palpate.base.errors import OptionError
from palpate.base.nearest import perhaps
from palpate.base.request import Request, options_of
from palpate.recipes.source import Source
from palpate.recipes.steps import Recipe

__all__ = ["filled", "placed"]

VARIABLE = re.compile(r"\{([A-Za-z_]\w*)\}", re.ASCII)


def filled(source: Source, variables: Mapping[str, str], *, scan: Path | None = None) -> Source:
    """Returns a recipe with its variables filled in.

    Args:
        source: The recipe; ``{name}`` in its texts stands for a variable.
        variables: What stands there instead.
        scan: Takes the place of the path of ``import``, or of ``reconstruct`` where that is there.

    Raises:
        OptionError: A variable is not known; the message says in which line.
    """

    def fill(given: Any, where: str) -> Any:  # noqa: ANN401  # as YAML has it
        if isinstance(given, dict):
            # YAML reads {scan} without quotes as a structure with one key
            if len(given) == 1 and list(given.values()) == [None]:
                (name,) = given
                return fill(f"{{{name}}}", where)
            return {key: fill(value, f"{where}.{key}") for key, value in given.items()}
        if isinstance(given, list):
            return [fill(value, f"{where}[{number}]") for number, value in enumerate(given)]
        if not isinstance(given, str):
            return given
        for name in VARIABLE.findall(given):
            if name not in variables:
                near = perhaps(name, variables)
                allowed = ", ".join(f"{{{each}}}" for each in variables)
                raise source.wrong(where, f"{{{name}}} is no variable{near}; allowed: {allowed}")
        return VARIABLE.sub(lambda found: variables[found[1]], given)

    given = source.given
    if scan is not None and isinstance(given, dict):
        key = "reconstruct" if "reconstruct" in given else "import"
        step = given.get(key)
        if step is None or isinstance(step, dict):
            given = {**given, key: {**(step or {}), "path": str(scan)}}
    return replace(source, given=fill(given, "$"))


def placed(recipe: Recipe, source: Source, folder: Path) -> Recipe:
    """Returns a recipe that writes into a folder what it would write beside itself.

    Raises:
        OptionError: It writes elsewhere.
    """
    written: dict[Path, Path] = {}

    def note(path: Path, *, writes: bool) -> Path:
        if writes:
            written[path] = folder / _name_of(path, source)
        return path

    def place(path: Path, *, writes: bool) -> Path:  # noqa: ARG001  # as ``note``
        # what another step of this recipe writes is read from there
        return written.get(path, path)

    _each_file(recipe, note)
    made: Recipe = _each_file(recipe, place)
    return made


def _name_of(path: Path, source: Source) -> str:
    if path.parent != source.path.parent:
        raise OptionError(
            f"{source.path} writes {str(path)!r}; allowed over many scans: plain names, such as "
            "bone.stl, which are written into the folder of each case"
        )
    return path.name


def _each_file(request: Request, change: Callable[..., Path]) -> Any:  # noqa: ANN401  # as given
    """Returns a request, and those in it, with each of its files changed."""
    changed = {}
    for option in options_of(type(request)):
        value = getattr(request, option.field)
        if isinstance(value, Request):
            changed[option.field] = _each_file(value, change)
        elif isinstance(value, list) and all(isinstance(each, Request) for each in value):
            changed[option.field] = [_each_file(each, change) for each in value]
        elif isinstance(value, Path) and (option.reads or option.writes):
            changed[option.field] = change(value, writes=bool(option.writes))
    return msgspec.structs.replace(request, **changed)
