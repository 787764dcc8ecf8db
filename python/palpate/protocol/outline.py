"""Messages on outlines in slices: the live wire, levels, and what they enclose."""

from __future__ import annotations

from typing import Annotated

import msgspec

from palpate.protocol.types import Message, SegmentId, Value, Vector

__all__ = ["FillOutline", "Outline", "TraceLevel", "Wire"]


class Outline(Message, frozen=True, tag="outline"):
    """The answer to a ``Wire`` or ``TraceLevel`` of this number, to the page that asked.

    A level's outline is closed, its last point joined to the first. Without points there is none,
    for the reason that ``problem`` tells.
    """

    number: int
    points: list[Vector]
    problem: str | None


class Wire(Message, frozen=True, tag="wire"):
    """Asks for the path along edges of a slice from one point to another; see ``Outline``."""

    number: Annotated[int, msgspec.Meta(ge=0)]
    begin: Vector
    end: Vector
    normal: Vector


class TraceLevel(Message, frozen=True, tag="trace_level"):
    """Asks for the outline of the value at a point of a slice, through it; see ``Outline``."""

    number: Annotated[int, msgspec.Meta(ge=0)]
    point: Vector
    normal: Vector


class FillOutline(Message, frozen=True, tag="fill_outline"):
    """Paints what an outline in a slice encloses, or takes it away: one step of undo.

    Only voxels with such ``values`` are changed, where these are given.
    """

    id: SegmentId
    erases: bool
    points: Annotated[list[Vector], msgspec.Meta(min_length=3, max_length=50_000)]
    normal: Vector
    values: tuple[Value, Value] | None
