"""Commands made of requests: the options of a command are the fields of its requests."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_origin

import typer

from palpate.base.hints import retold
from palpate.base.request import Option, Request, options_of
from palpate.base.request_files import check_file, files_of
from palpate.cli.written_files import WRITES

__all__ = ["with_requests"]

Result = TypeVar("Result")
PARSED = (bool, int, float, Path)
"""Types that the command line reads; all others it takes as texts."""


def with_requests(command: Callable[..., Result]) -> Callable[..., Result]:
    """Gives a command the options of each request among its parameters, in the request's place.

    Where two have an option of one name, the one stays that the command has itself, or that comes
    first. A request is checked before the command begins, if it can be.
    """
    written = inspect.signature(command, eval_str=True)
    parameters: dict[str, inspect.Parameter] = {}
    own = {name for name, each in written.parameters.items() if not _is_request(each.annotation)}
    requests: dict[str, tuple[type[Request], list[Option]]] = {}
    for name, parameter in written.parameters.items():
        if not _is_request(parameter.annotation):
            parameters[name] = parameter
            continue
        kind = parameter.annotation
        free = [
            each
            for each in options_of(kind)
            if each.field not in own and each.field not in parameters
        ]
        requests[name] = (kind, free)
        parameters |= {each.field: _parameter(each) for each in free}

    @wraps(command)
    def run(**given: Any) -> Result:  # noqa: ANN401  # each option has a type of its own
        made = {
            name: _made(kind, options, {each.field: given.pop(each.field) for each in options})
            for name, (kind, options) in requests.items()
        }
        for request in made.values():
            _check(request)
        return command(**given, **made)

    # what the command line is made of
    run.__signature__ = written.replace(parameters=list(parameters.values()))  # type: ignore[attr-defined]
    return run


def _is_request(annotation: object) -> bool:
    return isinstance(annotation, type) and issubclass(annotation, Request)


def _made(kind: type[Request], options: list[Option], given: dict[str, Any]) -> Request:
    """Returns a request of what stands on the command line."""
    values = {
        each.field: each.value(given[each.field])
        for each in options
        if given[each.field] is not None
    }
    return kind(**values)


def _check(request: Request) -> None:
    """Refuses what cannot be done, whatever the scan is."""
    for option, path in files_of(request):
        check_file(option, path)
    check = getattr(request, "check", None)
    if check is not None:
        check()


def _parameter(option: Option) -> inspect.Parameter:
    """Returns an option as a parameter that the command line is made of."""
    kind: Any = option.kind if option.kind in PARSED else str
    if get_origin(option.kind) is list:
        kind = list[str]
    default = None if option.default == [] else option.default
    if isinstance(default, tuple):
        default = ",".join(f"{number:g}" for number in default)
    if default is None:
        kind = kind | None
    told = retold(option.told, lambda name, _: f"--{name.replace('_', '-')}")
    if option.argument:
        info = typer.Argument(help=told, metavar=option.form)
    else:
        names = [f"--{option.name}", *([] if option.short is None else [f"-{option.short}"])]
        info = typer.Option(*names, help=told, metavar=option.form)
    return inspect.Parameter(
        option.field,
        inspect.Parameter.KEYWORD_ONLY,
        default=inspect.Parameter.empty if option.required else default,
        annotation=Annotated[kind, info, WRITES] if option.writes else Annotated[kind, info],
    )
