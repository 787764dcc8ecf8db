"""Requests: the options of one thing that Palpate does, written once.

A request is a structure whose fields are its options. Commands and steps of recipes are both made
of it: names, types, defaults and help of each option stand at its field and nowhere else.

    class SmoothRequest(Request, frozen=True, kw_only=True):
        smooth: Annotated[float | None, words("Smooth with this standard deviation in mm.")] = None
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

import msgspec

from palpate.base.errors import OptionError
from palpate.base.nearest import perhaps

__all__ = ["Option", "Request", "options_of", "shown", "words"]

SHOWN = 60
"""Most letters of a value in a message."""


class Request(msgspec.Struct, frozen=True, kw_only=True):
    """Base of all requests; each field is declared with its ``words``."""


def words(
    told: str,
    *,
    form: str | None = None,
    name: str | None = None,
    short: str | None = None,
    argument: bool = False,
    reads: bool = False,
    writes: tuple[str, ...] = (),
) -> msgspec.Meta:
    """Returns what people are told of an option, for the annotation of its field.

    Args:
        told: What the option does, in one sentence.
        form: How its value is written, such as "X,Y,Z".
        name: How the option is called where that is not the field's name.
        short: Its letter on the command line, such as "o".
        argument: Whether it stands on the command line without its name.
        reads: Whether it is a file or folder that is read.
        writes: Endings of the file that is written there.
    """
    extra = {
        "form": form,
        "name": name,
        "short": short,
        "argument": argument,
        "reads": reads,
        "writes": writes,
    }
    return msgspec.Meta(description=told, extra=extra)


@dataclass(frozen=True)
class Option:
    """One option of a request."""

    field: str
    """Its field."""
    name: str
    """Its name for people, such as "keep-largest"."""
    kind: Any
    """Type of its values, without None."""
    default: Any
    """``msgspec.NODEFAULT`` where it has to be given."""
    told: str
    form: str | None
    short: str | None
    argument: bool
    reads: bool
    writes: tuple[str, ...]

    @property
    def required(self) -> bool:
        """Whether it has to be given."""
        return self.default is msgspec.NODEFAULT

    @property
    def choices(self) -> tuple[str, ...]:
        """All values that are allowed; empty where they cannot be listed."""
        return get_args(self.kind) if get_origin(self.kind) is Literal else ()

    def value(self, given: object, *, folder: Path | None = None) -> Any:  # noqa: ANN401
        """Returns what was given as the type of the field.

        Args:
            given: As a file or the command line has it; numbers may be text, several with commas.
            folder: What paths are relative to; by default where the process is.

        Raises:
            OptionError: It does not fit; the message names the option and what is allowed.
        """
        if given is None and not self.required and self.default is None:
            return None
        kind = self.kind
        parts = given.split(",") if isinstance(given, str) and get_origin(kind) is tuple else given

        def path_of(kind: type, text: object) -> Path:
            if kind is Path and isinstance(text, str) and text:
                return Path(text) if folder is None else folder / text
            raise ValueError("no path")

        if isinstance(given, Path) and kind is Path:
            return given
        try:
            # a variable of a recipe is text, whatever option it fills
            exact = not isinstance(given, str)
            return msgspec.convert(parts, kind, dec_hook=path_of, strict=exact)
        except (msgspec.ValidationError, ValueError):
            near = perhaps(given, self.choices)
            raise OptionError(
                f"{self.name} {shown(given)} given{near}; allowed: {self.allowed}"
            ) from None

    @property
    def allowed(self) -> str:
        """Says which values are allowed."""
        return ", ".join(self.choices) or _allowed(self.kind, self.form)


@cache
def options_of(kind: type[msgspec.Struct]) -> tuple[Option, ...]:
    """Returns the options of a request in order, without fields that have no words."""
    annotations = get_type_hints(kind, include_extras=True)
    found = []
    for field in msgspec.structs.fields(kind):
        annotation = annotations[field.name]
        if get_origin(annotation) is not Annotated:
            continue
        declared, meta = get_args(annotation)
        extra = meta.extra
        made = field.default_factory is not msgspec.NODEFAULT
        found.append(
            Option(
                field=field.name,
                name=extra["name"] or field.name.replace("_", "-"),
                kind=_without_none(declared),
                default=field.default_factory() if made else field.default,
                told=meta.description,
                form=extra["form"],
                short=extra["short"],
                argument=extra["argument"],
                reads=extra["reads"],
                writes=extra["writes"],
            )
        )
    return tuple(found)


def shown(given: object) -> str:
    """Returns a value as a message shows it."""
    if given is None:
        return "without a value"
    if isinstance(given, bool):
        return str(given).lower()
    text = repr(str(given) if isinstance(given, Path) else given)
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}…"


def _without_none(kind: Any) -> Any:  # noqa: ANN401
    if get_origin(kind) not in (Union, UnionType):
        return kind
    return Union[tuple(each for each in get_args(kind) if each is not NoneType)]  # noqa: UP007


def _allowed(kind: Any, form: str | None) -> str:  # noqa: ANN401
    """Says in plain words what a type takes."""
    written = "" if form is None else f", {form}"
    if get_origin(kind) is tuple:
        return f"{len(get_args(kind))} numbers{written}"
    if get_origin(kind) is list:
        what = "texts" if get_args(kind) == (str,) else "steps, each with its options"
        return f"a list of {what}{written}"
    if get_origin(kind) is Union or get_origin(kind) is UnionType:
        return " or ".join(_allowed(each, None) for each in get_args(kind)) + written
    plain = {
        bool: "true or false",
        int: "a whole number",
        float: "a number",
        str: "text",
        Path: "the name of a file",
    }
    return plain.get(kind, "options") + written
