"""The text of a recipe: what its YAML says, and in which line."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args, get_origin

import yaml

from palpate.base.damaged_file import BROKEN
from palpate.base.errors import OptionError, PalpateError
from palpate.base.hints import in_recipe
from palpate.base.plain_file import check_plain
from palpate.base.request import Request, options_of
from palpate.recipes.steps import Recipe

__all__ = ["Source", "read_source"]

DEEPEST = 16
"""Of lists and options in one another."""
MOST_BYTES = 1 << 20
"""A larger file is no recipe."""


@dataclass(frozen=True)
class Source:
    """A recipe as it is written."""

    path: Path
    given: Any
    """What the YAML says."""
    lines: dict[str, int]
    """Where each value stands, by its way from the root, such as ``$.segment[0].smooth``."""

    def wrong(self, where: str, why: object) -> OptionError:
        """Returns an error that names the line of a value, or of the nearest one around it."""
        line = where
        while line not in self.lines and line != "$":
            around = re.sub(r"(\.[^.\[]*|\[\d+\])$", "", line)
            # the name of an option may be of any form
            line = around if around != line else "$"
        step = step_of(where)
        told = f"{step}: " if step else ""
        said = self.said(str(why), step=step)
        return OptionError(f"{self.path}, line {self.lines.get(line, 1)}: {told}{said}")

    def said(self, message: str, *, step: str = "import") -> str:
        """Returns a message with options as the recipe has them, such as "unit: HU"."""
        return in_recipe(message, known=_options_of(step), files=self._files())

    def _files(self) -> list[Path]:
        """Returns the files that it names, as this process sees them."""
        found, left = [], [self.given]
        while left:
            one = left.pop()
            if isinstance(one, dict | list):
                left += one.values() if isinstance(one, dict) else one
            elif isinstance(one, str) and one and (self.path.parent / one).exists():
                found.append(self.path.parent / one)
        return found

    @contextmanager
    def at(self, where: str) -> Iterator[None]:
        """Gives what is refused within the line of a value."""
        try:
            yield
        except (PalpateError, OSError) as error:
            raise self.wrong(where, error) from None


def step_of(where: str) -> str:
    """Returns the step of a value, such as "segment 2", with its number where it has one."""
    way = re.match(r"\$\.(\w+)(?:\[(\d+)\])?", where)
    if way is None:
        return ""
    return way[1] if way[2] is None else f"{way[1]} {int(way[2]) + 1}"


def _options_of(step: str) -> set[str]:
    """Returns the options of a step, as Python calls them, and those of reading the scan."""
    known: set[str] = set()
    for each in options_of(Recipe):
        (kind,) = get_args(each.kind) if get_origin(each.kind) is list else (each.kind,)
        if each.name in {step.split(" ", maxsplit=1)[0], "import"} and issubclass(kind, Request):
            known |= {one.field for one in options_of(kind)}
    return known


def read_source(path: Path) -> Source:
    """Reads the text of a recipe.

    Raises:
        FileNotFoundError: The recipe does not exist.
        OptionError: It is no YAML, is empty, or says one thing twice.
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
    source = Source(path, given, dict(_lines(root, "$")))
    _refuse_twice(root, "$", source)
    return source


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
