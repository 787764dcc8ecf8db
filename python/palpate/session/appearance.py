"""Appearance of segments as journals and scene files store it: name, colour, opacity and more."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import msgspec
import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.session.session import Session
from palpate.volumes.anatomical_colour import colour_of_name
from palpate.volumes.scene import PALETTE, Colour, Scene, ShownAs
from palpate.volumes.surface import Source

__all__ = [
    "UNMOVED",
    "Look",
    "colour_of_number",
    "kept_looks",
    "look_of_number",
    "looks_of",
    "restored_looks",
    "scene_with_looks",
]

DEFAULT_SMOOTHING = 3
"""Degree of smoothing that hides the steps of voxels and keeps structures of a few voxels."""

UNMOVED = [float(row == column) for row in range(4) for column in range(4)]
"""Pose of a segment that was not moved."""


@dataclass(frozen=True)
class Look:
    """How a segment is shown; from opacity to the wireframe it is about its surface."""

    name: str
    colour: Colour
    visible: bool = True
    shown_as: ShownAs = "volume"
    opacity: float = 1.0
    smoothing: int = DEFAULT_SMOOTHING
    surface_from: Source = "intensities"
    wireframe: bool = False
    ambient: float = 1.0
    specular: float = 1.0
    chosen: bool = True
    """Whether a person or a file chose the colour; else it follows from name or number."""


@dataclass(frozen=True)
class KeptLook:
    """A segment's look as a journal keeps it."""

    id: Annotated[int, msgspec.Meta(ge=1, le=255)]
    touchable: bool
    look: Look
    locked: bool = False


def colour_of_number(segment_id: int) -> Colour:
    """Returns the colour of a segment without a known name."""
    return PALETTE[(segment_id - 1) % len(PALETTE)]


def look_of_number(segment_id: int) -> Look:
    """Returns how a segment is shown of which nothing is known but its number."""
    return Look(f"segment {segment_id}", colour_of_number(segment_id), chosen=False)


def looks_of(session: Session) -> dict[int, Look]:
    """Returns how the segments of a session's scene are shown, by their numbers."""
    return {
        segment_id: Look(
            shown.name,
            shown.colour,
            shown.visible,
            shown.shown_as,
            chosen=shown.colour not in (*PALETTE, colour_of_name(shown.name)),
        )
        for segment_id, shown in zip(session.ids, session.scene, strict=True)
    }


def kept_looks(session: Session, look_of: Callable[[int], Look]) -> bytes:
    """Returns looks, with which segments can be touched and changed, for ``restored_looks``."""
    kept = [
        KeptLook(
            id=state["id"],
            touchable=state["touchable"],
            look=look_of(state["id"]),
            locked=state["locked"],
        )
        for state in session.segments()
    ]
    return msgspec.json.encode(kept)


def restored_looks(session: Session, kept: bytes) -> dict[int, Look]:
    """Returns looks that were kept, and gives the session which can be touched and changed.

    Some may be of segments that are gone: undo may bring them back.

    Raises:
        OptionError: The bytes are none.
    """
    try:
        looks = msgspec.json.decode(kept, type=list[KeptLook])
    except msgspec.DecodeError as error:
        raise OptionError(f"names and colours cannot be read: {error}") from None
    there = {state["id"] for state in session.segments()}
    for each in looks:
        if each.id in there:
            session.set_touchable(each.id, touchable=each.touchable)
            session.set_locked(each.id, locked=each.locked)
    return {each.id: each.look for each in looks}


def scene_with_looks(
    session: Session, values: NDArray[np.int16], look_of: Callable[[int], Look]
) -> tuple[Scene, list[str]]:
    """Returns the scan with the given stored values and its current segments, for files.

    Returns:
        The scene, and sentences on what files cannot store.

    Raises:
        OptionError: Segments were added or removed meanwhile.
    """
    scene, told = session.scene_now(values), []
    states = session.segments()
    if len(states) != len(scene):
        raise OptionError("segments came or went meanwhile; allowed: once more")
    for one, state in zip(scene, states, strict=True):
        look = look_of(state["id"])
        if look.name != one.name:
            # a segment that was renamed is something else, or was never told what it is
            one.segment.terminology = None
        one.name, one.colour = look.name, look.colour
        if state["pose"] not in (None, UNMOVED):
            told.append(f"{look.name} was moved: it is written where the scan has it")
    return scene, told
