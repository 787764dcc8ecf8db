"""Messages on outlines in slices: the live wire, level sets, and filling."""

from __future__ import annotations

from typing import Annotated

import msgspec

from palpate.protocol.types import Message, SegmentId, Value, Vector

__all__ = ["FillOutline", "Outline", "TraceLevel", "Wire"]


class Outline(Message, frozen=True, tag="outline"):
    """Answer to the ``Wire`` or ``TraceLevel`` with this number, to the page that sent it.

    The outline of a level is closed: its last point is connected to the first. Without points
    ``problem`` says why there is no outline.
    """

    number: int
    points: list[Vector]
    problem: str | None


class Wire(Message, frozen=True, tag="wire"):
    """Requests the path along edges of a slice from one point to another; see ``Outline``."""

    number: Annotated[int, msgspec.Meta(ge=0)]
    begin: Vector
    end: Vector
    normal: Vector


class TraceLevel(Message, frozen=True, tag="trace_level"):
    """Requests the outline through a point of a slice at that point's value; see ``Outline``."""

    number: Annotated[int, msgspec.Meta(ge=0)]
    point: Vector
    normal: Vector


class FillOutline(Message, frozen=True, tag="fill_outline"):
    """Adds the voxels inside an outline in a slice to a segment, or removes them: one step of undo.

    Where ``values`` is given, only voxels with such values are changed.
    """

    id: SegmentId
    erases: bool
    points: Annotated[list[Vector], msgspec.Meta(min_length=3, max_length=50_000)]
    normal: Vector
    values: tuple[Value, Value] | None
