"""The engine's end of a session: its type, and how points and errors pass between both."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from palpate import _core
from palpate.base.errors import OptionError

__all__ = ["Engine", "Point", "option_errors", "triple"]

Engine = _core.Session
"""What every part of a session calls."""

Point = Sequence[float] | NDArray[np.float64]
"""x, y, z in the scene, LPS [mm]."""


def triple(name: str, numbers: Point) -> tuple[float, float, float]:
    """Returns three numbers in the form that the engine takes; ``name`` is their argument's.

    Raises:
        OptionError: They are not three numbers.
    """
    try:
        x, y, z = (float(number) for number in numbers)
    except (TypeError, ValueError):
        raise OptionError(f"{name} {numbers!r} given; allowed: three numbers, x, y, z") from None
    return x, y, z


@contextmanager
def option_errors() -> Iterator[None]:
    """Raises ``OptionError`` where the engine rejects a value with ``ValueError``."""
    try:
        yield
    except ValueError as error:
        raise OptionError(str(error)) from None
