"""What a user gives in Python: numbers and paths, refused in one line where they are others.

Flags and text are no numbers: ``True`` is no 1, and ``"2"`` no 2.
"""

from __future__ import annotations

import operator
from numbers import Real
from os import PathLike, fspath
from pathlib import Path
from reprlib import repr as short
from typing import Any

from palpate.base.errors import OptionError

__all__ = ["given_text", "number", "path_of", "whole_number"]


def number(name: str, given: Any) -> float:  # noqa: ANN401  # whatever a user gives
    """Returns a number as it was given, whole or not, finite or not.

    Raises:
        OptionError: It is none.
    """
    if isinstance(given, bool) or not isinstance(given, Real):
        raise OptionError(f"{name} {given_text(given)} given; allowed: a number")
    return given  # type: ignore[return-value]  # arrays' own numbers are reals too


def whole_number(name: str, given: Any) -> int:  # noqa: ANN401
    """Returns a whole number, given as such or as a float that is one, such as 1e9.

    Raises:
        OptionError: It is none.
    """
    try:
        if isinstance(given, float) and given.is_integer():
            return int(given)
        if not isinstance(given, bool):
            return operator.index(given)
    except TypeError:
        pass
    raise OptionError(f"{name} {given_text(given)} given; allowed: a whole number")


def path_of(given: Any, *, name: str = "path") -> Path:  # noqa: ANN401
    """Returns a path.

    Raises:
        OptionError: It is neither text nor a path.
    """
    if isinstance(given, str | PathLike) and isinstance(fspath(given), str):
        return Path(given)
    raise OptionError(f"{name} {given_text(given)} given; allowed: text or a pathlib.Path")


def given_text(given: Any) -> str:  # noqa: ANN401
    """Returns what was given as a message has it: short values, of others the type."""
    if given is None or isinstance(given, bool | int | float | str | bytes | list | tuple):
        return short(given)
    return f"of type {type(given).__name__}"
