"""What all parts of a session share: the engine's end, and how values go there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from palpate import _core
from palpate.base.errors import OptionError
from palpate.volumes.scene import Scene

__all__ = ["Point", "SessionPart", "given", "triple"]

Point = Sequence[float] | NDArray[np.float64]
"""x, y, z [scene]."""


class SessionPart:
    """Some of what a session can do: all parts of it ask the same engine."""

    scene: Scene
    """The scan and segments as they were at the start."""
    ids: list[int]
    """Numbers of those segments."""
    _internal: _core.Session


def triple(numbers: Point) -> tuple[float, float, float]:
    """Returns three numbers as the engine takes them."""
    x, y, z = (float(number) for number in numbers)
    return x, y, z


@contextmanager
def given() -> Iterator[None]:
    """Turns the engine's refusal of a value into the package's own."""
    try:
        yield
    except ValueError as error:
        raise OptionError(str(error)) from None
