"""How the segments of a session are shown, as journals and scene files keep it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import msgspec
import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.session.session import Session
from palpate.volumes.anatomical_colour import colour_of_name
from palpate.volumes.appearance import (
    DEFAULT_SMOOTHING,
    Colour,
    LightFactor,
    SegmentAppearance,
    Share,
    ShownAs,
    SmoothingDegree,
    SurfaceSource,
)
from palpate.volumes.scene import PALETTE, Scene, new_appearance

__all__ = [
    "UNMOVED",
    "ShownAppearance",
    "appearance_of_number",
    "appearances_of",
    "colour_of_number",
    "keep_appearances",
    "restore_appearances",
    "scene_with_appearances",
    "with_colour_chosen",
]

UNMOVED = [float(row == column) for row in range(4) for column in range(4)]
"""Pose of a segment that was not moved."""


class ShownAppearance(SegmentAppearance, frozen=True):
    """How a segment of a session is shown, and where its colour comes from.

    Journals and scenes of earlier versions lack some fields: these have defaults.
    """

    visible: bool = True
    touched_while_hidden: bool = False
    shown_as: ShownAs = "volume"
    opacity: Share = 1.0
    smoothing: SmoothingDegree = DEFAULT_SMOOTHING
    surface_from: SurfaceSource = "intensities"
    wireframe: bool = False
    ambient: LightFactor = 1.0
    specular: LightFactor = 1.0
    colour_chosen: bool = msgspec.field(name="chosen", default=True)
    """Whether a person or a file gave the colour, and not the name or the number."""


class KeptSegment(msgspec.Struct, frozen=True):
    """What a journal keeps of how a segment is shown."""

    id: Annotated[int, msgspec.Meta(ge=1, le=255)]
    touchable: bool
    appearance: ShownAppearance = msgspec.field(name="look")
    locked: bool = False


def with_colour_chosen(appearance: SegmentAppearance, *, chosen: bool) -> ShownAppearance:
    """Returns an appearance with where its colour comes from."""
    shared = {name: getattr(appearance, name) for name in SegmentAppearance.__struct_fields__}
    return ShownAppearance(**shared, colour_chosen=chosen)


def colour_of_number(segment_id: int) -> Colour:
    """Returns the colour of a segment whose name has none."""
    return PALETTE[(segment_id - 1) % len(PALETTE)]


def appearance_of_number(segment_id: int) -> ShownAppearance:
    """Returns how a segment is shown of which only the number is known."""
    new = new_appearance(f"segment {segment_id}", colour_of_number(segment_id))
    return with_colour_chosen(new, chosen=False)


def appearances_of(session: Session) -> dict[int, ShownAppearance]:
    """Returns how the segments of a session's scene are shown, by their numbers."""
    return {
        segment_id: with_colour_chosen(
            shown.appearance,
            chosen=shown.colour not in (*PALETTE, colour_of_name(shown.name)),
        )
        for segment_id, shown in zip(session.ids, session.scene, strict=True)
    }


def keep_appearances(session: Session, appearance_of: Callable[[int], ShownAppearance]) -> bytes:
    """Returns appearances and what can be touched or changed, for ``restore_appearances``."""
    kept = [
        KeptSegment(
            id=state["id"],
            touchable=state["touchable"],
            appearance=appearance_of(state["id"]),
            locked=state["locked"],
        )
        for state in session.segments()
    ]
    return msgspec.json.encode(kept)


def restore_appearances(session: Session, kept: bytes) -> dict[int, ShownAppearance]:
    """Returns appearances that were kept, and sets which segments can be touched or changed.

    Some may be of segments that are gone: undo may bring them back.

    Raises:
        OptionError: The bytes are not what ``keep_appearances`` returns.
    """
    try:
        segments = msgspec.json.decode(kept, type=list[KeptSegment])
    except msgspec.DecodeError as error:
        raise OptionError(f"names and colours cannot be read: {error}") from None
    there = {state["id"] for state in session.segments()}
    for each in segments:
        if each.id in there:
            session.set_touchable(
                each.id,
                touchable=each.touchable,
                visible=each.appearance.visible,
                touched_while_hidden=each.appearance.touched_while_hidden,
            )
            session.set_locked(each.id, locked=each.locked)
    return {each.id: each.appearance for each in segments}


def scene_with_appearances(
    session: Session,
    values: NDArray[np.int16],
    appearance_of: Callable[[int], SegmentAppearance],
) -> tuple[Scene, list[str]]:
    """Returns the scan with these stored values and its segments as they are now, for files.

    Also returns sentences on what files cannot hold.

    Raises:
        OptionError: Segments were added or removed meanwhile.
    """
    scene, notes = session.scene_now(values), []
    states = session.segments()
    if len(states) != len(scene):
        raise OptionError("segments came or went meanwhile; allowed: once more")
    for one, state in zip(scene, states, strict=True):
        wanted = appearance_of(state["id"])
        if wanted.name != one.name:
            # a segment that was renamed is something else, or never had terms of its own
            one.segment.terminology = None
            one.segment.name = wanted.name
        one.appearance = msgspec.structs.replace(
            one.appearance, name=wanted.name, colour=wanted.colour
        )
        if state["pose"] not in (None, UNMOVED):
            notes.append(f"{wanted.name} was moved: it is taken where the scan has it")
    return scene, notes
