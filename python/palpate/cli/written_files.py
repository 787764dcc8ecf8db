"""What commands write never replaces what they read, and other files only where a person agrees.

Each path among the parameters of a command is read, except those that are declared with
``WRITES``. On a terminal the person is asked; elsewhere ``--force`` is needed.
"""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Iterator
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_args, get_origin

import typer

from palpate.base.errors import OptionError
from palpate.base.files_read import files_noted, note_read
from palpate.base.replacing import agreed_by, check_replaceable
from palpate.base.state_folder import state_folder

__all__ = ["WRITES", "Force", "asked", "keeping_files"]

Result = TypeVar("Result")

WRITES = "written"
"""Marks a parameter of a command as a file that it writes."""

Force = Annotated[
    bool, typer.Option("--force", help="Replace files that exist; never those that are read.")
]


def keeping_files(command: Callable[..., Result]) -> Callable[..., Result]:
    """Gives a command the option ``--force``, and keeps files that it must not replace.

    They are looked at before the command begins, and again by whoever writes them.
    """
    made = inspect.signature(command, eval_str=True)
    written = [name for name, each in made.parameters.items() if _is_written(each.annotation)]

    @wraps(command)
    def run(*, force: bool, **given: Any) -> Result:  # noqa: ANN401  # as the command has them
        files = [path for name in written for path in _paths(given.get(name))]
        with files_noted(), agreed_by(asked(force=force)):
            for name, value in given.items():
                for path in _paths(value) if name not in written else ():
                    note_read(path)
            _refuse_twice(files)
            for path in files:
                check_replaceable(path)
            return command(**given)

    option = inspect.Parameter(
        "force",
        inspect.Parameter.KEYWORD_ONLY,
        default=False,
        annotation=Force,
    )
    # what the command line is made of
    run.__signature__ = made.replace(parameters=[*made.parameters.values(), option])  # type: ignore[attr-defined]
    return run


def asked(*, force: bool) -> Callable[[Path], None]:
    """Returns what refuses to replace a file where nobody agrees; each is asked about once."""
    agreed: set[Path] = set()

    def agree(path: Path) -> None:
        # the program's own files are not the person's
        if force or path in agreed or state_folder() in path.absolute().parents:
            return
        asks = sys.stdin.isatty() and sys.stderr.isatty()
        if not (asks and typer.confirm(f"{path} exists already. Replace it?", err=True)):
            raise OptionError(
                f"{path} exists already; allowed: a new file, or to replace it with --force"
            )
        agreed.add(path)

    return agree


def _is_written(annotation: object) -> bool:
    return get_origin(annotation) is Annotated and WRITES in get_args(annotation)[1:]


def _paths(value: object) -> Iterator[Path]:
    for each in value if isinstance(value, list | tuple) else (value,):
        if isinstance(each, Path):
            yield each


def _refuse_twice(files: list[Path]) -> None:
    """Refuses one file for two results.

    Raises:
        OptionError: There is one.
    """
    taken: set[Path] = set()
    for path in files:
        if path.resolve() in taken:
            raise OptionError(f"{path} is written already; allowed: a new file")
        taken.add(path.resolve())
