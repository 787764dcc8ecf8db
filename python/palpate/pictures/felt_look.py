"""How the scan looks beside segments that can be touched, as on the page (felt_look.ts).

What is seen is what is felt: as soon as a threshold that can be touched reaches into bone, other
bright tissue is only hinted at, grey and seen through.
"""

from __future__ import annotations

import msgspec

from palpate.pictures.appearance import Appearance
from palpate.pictures.transfer import LEAST_SPAN, Transfer, colour_at, extinction_at
from palpate.session.felt import TouchWish
from palpate.volumes.histogram import Anchors
from palpate.volumes.scene import Scene, SceneSegment

__all__ = ["SOLIDS", "feels_bone", "hinted", "is_felt", "look_beside"]

SOLIDS = ("shaded", "composite", "iso")
"""Modes in which segments are bodies; in the others all are values."""

HINT = 0.06
"""Fraction of its extinction that a hint of bright tissue keeps."""
GREY = 0.85
"""How far its colour is grey."""
STEP = 0.02
"""Width of the step where hints begin, of the span from soft tissue to bone."""


def is_felt(one: SceneSegment) -> bool:
    """Whether the probe collides with a segment."""
    return TouchWish.of(one).is_felt


def look_beside(look: Appearance, scene: Scene, *, touchable_only: bool) -> Appearance:
    """Returns the look of a scan beside the segments of its scene that can be touched.

    Args:
        look: How the scan looks alone.
        scene: The scan and its segments.
        touchable_only: Nothing of the scan is shown.
    """
    volume = scene.volume
    if look.mode not in SOLIDS:
        return look
    if touchable_only:
        nothing = tuple((value, colour, 0.0) for value, colour, _ in look.transfer)
        # above all values
        beyond = volume.range[1] + 1.0 + abs(volume.range[1])
        return msgspec.structs.replace(look, transfer=nothing, iso_value=beyond)
    if not feels_bone(scene):
        return look
    transfer = hinted(look.transfer, volume.anchors)
    colour = colour_at(transfer, look.iso_value)
    return msgspec.structs.replace(look, transfer=transfer, iso_colour=colour)


def feels_bone(scene: Scene) -> bool:
    """Whether a threshold that can be touched reaches into what is bone in a CT.

    A scan of unknown kind is taken for a CT.
    """
    volume = scene.volume
    if volume.modality not in ("CT", ""):
        return False
    thresholds = (one.segment.range or one.segment.made_by for one in scene if is_felt(one))
    return any(limits is not None and limits[1] >= volume.anchors.bone for limits in thresholds)


def hinted(transfer: Transfer, anchors: Anchors) -> Transfer:
    """Returns a function that only hints at values of bone."""
    bone = anchors.bone
    step = max(STEP * abs(bone - anchors.soft_tissue), LEAST_SPAN)
    values = sorted({*(value for value, _, _ in transfer), bone - step, bone})
    points = [(at, colour_at(transfer, at), extinction_at(transfer, at)) for at in values]
    return tuple(_hint(*point) if point[0] >= bone else point for point in points)


def _hint(
    value: float, colour: tuple[float, float, float], extinction: float
) -> tuple[float, tuple[float, float, float], float]:
    red, green, blue = colour
    grey = 0.2126 * red + 0.7152 * green + 0.0722 * blue
    red, green, blue = (channel + (grey - channel) * GREY for channel in colour)
    return value, (red, green, blue), HINT * extinction
