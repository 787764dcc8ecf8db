"""Values in ellipses and rectangles that pages have drawn in slices."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any, Literal

import msgspec
import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.volumes.area_values import Area, values_in_area
from palpate.volumes.volume import Volume

__all__ = ["AreaRequest", "measured_areas"]

MOST_AREAS = 1000


class AreaWanted(msgspec.Struct, frozen=True):
    """A shape: its middle and the ends of two half axes, patient, LPS [mm]."""

    kind: Literal["ellipse", "rectangle"]
    points: tuple[
        tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]
    ]


class AreaRequest(msgspec.Struct, frozen=True):
    """What a page asks to be measured."""

    areas: list[AreaWanted]


def measured_areas(
    request: AreaRequest, volume: Volume, stored: NDArray[np.int16]
) -> list[dict[str, Any]]:
    """Returns the measurements of areas, in their order, of values as edits have left them.

    Raises:
        OptionError: There are too many, or one is none.
    """
    if len(request.areas) > MOST_AREAS:
        raise OptionError(f"{len(request.areas)} areas given; allowed: at most {MOST_AREAS}")
    return [
        asdict(values_in_area(volume, Area(wanted.kind, *wanted.points), stored=stored))
        for wanted in request.areas
    ]
