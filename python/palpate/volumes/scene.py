"""Scenes: a scan, its segments and their appearance."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

from palpate.base.errors import OptionError
from palpate.volumes.anatomical_colour import first_colour
from palpate.volumes.second_scan import SecondScan
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume

__all__ = [
    "MOST_SEGMENTS",
    "PALETTE",
    "Colour",
    "Scene",
    "SceneSegment",
    "ShownAs",
    "choose_segment",
]

Colour = tuple[float, float, float]

ShownAs = Literal["volume", "surface", "both"]

PALETTE: tuple[Colour, ...] = (
    (0.94, 0.89, 0.78),
    (0.85, 0.45, 0.38),
    (0.42, 0.68, 0.84),
    (0.55, 0.76, 0.45),
    (0.90, 0.70, 0.32),
    (0.66, 0.52, 0.80),
    (0.36, 0.70, 0.66),
    (0.88, 0.56, 0.70),
)
"""Colours that segments get in turn, sRGB; the first one is that of bone."""

MOST_SEGMENTS = 255
"""A segment's number is one byte, and 0 means none."""


@dataclass
class SceneSegment:
    """A segment, and its appearance and touch at the start of a session."""

    segment: Segment
    name: str
    colour: Colour
    visible: bool
    touchable: bool
    shown_as: ShownAs = "volume"


class Scene:
    """A scan and the segments to show and touch in it."""

    def __init__(self, volume: Volume, segments: Iterable[Segment] = ()) -> None:
        """Takes a scan and segments of it, each visible and touchable.

        Raises:
            OptionError: A segment has another size than the scan.
        """
        self.volume = volume
        self.second: SecondScan | None = None
        """A second scan to show with it."""
        self._segments: list[SceneSegment] = []
        for segment in segments:
            self.add(segment)

    def __iter__(self) -> Iterator[SceneSegment]:
        return iter(self._segments)

    def __len__(self) -> int:
        return len(self._segments)

    def add(
        self,
        segment: Segment,
        *,
        colour: Colour | None = None,
        visible: bool = True,
        touchable: bool = True,
        shown_as: ShownAs = "volume",
    ) -> SceneSegment:
        """Adds a segment.

        Args:
            segment: Voxels of this scan, or on a grid of its own; that is shown as a surface.
            colour: sRGB, each 0 to 1; the default is the usual colour of its name, or where that is
                not known or taken, the next one of the palette.
            visible: Whether it is shown.
            touchable: Whether the probe collides with it.
            shown_as: How it is drawn: from its voxels, as a surface, or both.

        Raises:
            OptionError: It has another size than the scan, or there are too many segments.
        """
        if segment.has_own_grid:
            shown_as = "surface"
        elif segment.volume.dimensions != self.volume.dimensions:
            raise OptionError(
                f"segment {segment.name!r} is of a scan of {segment.volume.dimensions} voxels; "
                f"allowed: {self.volume.dimensions}"
            )
        if len(self._segments) == MOST_SEGMENTS:
            raise OptionError(
                f"segment {segment.name!r} is one too many; allowed: {MOST_SEGMENTS} in a scene"
            )
        next_one = PALETTE[len(self._segments) % len(PALETTE)]
        names = [other.name for other in self._segments]
        chosen = colour or first_colour(segment.name, names, otherwise=next_one)
        added = SceneSegment(segment, segment.name, chosen, visible, touchable, shown_as)
        self._segments.append(added)
        return added


def choose_segment(scene: Scene, name: str | None) -> Segment:
    """Returns the segment of a name; without a name, the only one there is.

    Raises:
        OptionError: There is none, or it is ambiguous.
    """
    segments = {one.name: one.segment for one in scene}
    if name is None and len(segments) == 1:
        return next(iter(segments.values()))
    if name is None or name not in segments:
        given = "no segment" if name is None else f"segment {name!r}"
        raise OptionError(f"{given} given; allowed: {', '.join(segments) or 'none in this scan'}")
    return segments[name]
