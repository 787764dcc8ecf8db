"""Where a picture is seen from."""

from __future__ import annotations

import msgspec

__all__ = ["Camera"]

Point = tuple[float, float, float]


class Camera(msgspec.Struct, frozen=True, kw_only=True):
    """A point that is looked at, and from where. Frame: patient, LPS mm; as the page has it."""

    target: Point
    """Point in the middle of the picture."""
    distance: float
    """From the eye to the target [mm]."""
    right: Point
    """Unit axes of the view: to the right, up, and back toward the person."""
    up: Point
    back: Point
    field: float
    """Vertical angle of view [rad]."""
    parallel: float | None = None
    """Orthographic: how far before the target rays begin, side by side [mm]; the picture is as high
    as one in perspective is at the target. None: in perspective."""
    aside: float = 0.0
    """One of two eyes: so far to the right [fraction of the distance], looking straight ahead."""
