"""Scenes: a scan, its segments and their appearance."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Generic, TypeVar

import msgspec

from palpate.base.errors import OptionError
from palpate.volumes.anatomical_colour import first_colour
from palpate.volumes.appearance import (
    DEFAULT_SMOOTHING,
    Colour,
    SegmentAppearance,
    ShownAs,
)
from palpate.volumes.same_grid import distance_of_grids, lie_together
from palpate.volumes.second_scan import SecondScan
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume

__all__ = [
    "MOST_SEGMENTS",
    "PALETTE",
    "Scene",
    "SceneSegment",
    "choose_segment",
    "new_appearance",
    "require_scene",
]

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

Field = TypeVar("Field")

MOST_SEGMENTS = 255
"""A segment's number is one byte, and 0 means none."""


class _AppearanceField(Generic[Field]):
    """A field of a segment's appearance, read and set on the ``SceneSegment`` itself."""

    def __set_name__(self, _: type[SceneSegment], name: str) -> None:
        self._name = name

    def __get__(self, one: SceneSegment, _: type[SceneSegment]) -> Field:
        value: Field = getattr(one.appearance, self._name)
        return value

    def __set__(self, one: SceneSegment, value: Field) -> None:
        one.appearance = msgspec.structs.replace(one.appearance, **{self._name: value})


@dataclass
class SceneSegment:
    """A segment, and its appearance and touch at the start of a session."""

    segment: Segment
    appearance: SegmentAppearance
    touchable: bool

    name = _AppearanceField[str]()
    colour = _AppearanceField[Colour]()
    """sRGB, each 0..1."""
    visible = _AppearanceField[bool]()
    shown_as = _AppearanceField[ShownAs]()


def new_appearance(
    name: str,
    colour: Colour,
    *,
    visible: bool = True,
    touched_while_hidden: bool = False,
    shown_as: ShownAs = "volume",
) -> SegmentAppearance:
    """Returns how a segment is shown that nobody has changed yet."""
    return SegmentAppearance(
        name=name,
        colour=colour,
        visible=visible,
        touched_while_hidden=touched_while_hidden,
        shown_as=shown_as,
        opacity=1.0,
        smoothing=DEFAULT_SMOOTHING,
        surface_from="intensities",
        wireframe=False,
        ambient=1.0,
        specular=1.0,
    )


class Scene:
    """A scan and the segments to show and touch in it."""

    def __init__(self, volume: Volume, segments: Iterable[Segment] = ()) -> None:
        """Takes a scan and segments of it, each visible and touchable.

        Raises:
            OptionError: What is given is no scan, or a segment has another size than the scan.
        """
        if not isinstance(volume, Volume):
            raise OptionError(
                f"volume of type {type(volume).__name__} given; allowed: a Volume, as "
                "palpate.read and palpate.Volume return it"
            )
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
        touched_while_hidden: bool = False,
        shown_as: ShownAs = "volume",
    ) -> SceneSegment:
        """Adds a segment.

        Args:
            segment: Voxels of this scan, or on a grid of its own; that is shown as a surface.
            colour: sRGB, each 0 to 1; the default is the usual colour of its name, or where that is
                not known or taken, the next one of the palette.
            visible: Whether it is shown.
            touchable: Whether the probe collides with it while it is shown.
            touched_while_hidden: Whether the probe does so while it is hidden, too.
            shown_as: How it is drawn: from its voxels, as a surface, or both.

        Raises:
            OptionError: It lies on another grid than the scan, or there are too many segments.
        """
        if not isinstance(segment, Segment):
            raise OptionError(
                f"segment of type {type(segment).__name__} given; allowed: a Segment, as "
                "Volume.threshold and Volume.segment return it"
            )
        if segment.has_own_grid:
            shown_as = "surface"
        elif segment.volume.dimensions != self.volume.dimensions:
            raise OptionError(
                f"segment {segment.name!r} is of a scan of {segment.volume.dimensions} voxels; "
                f"allowed: {self.volume.dimensions}"
            )
        elif not lie_together(segment.volume, self.volume):
            apart = distance_of_grids(segment.volume, self.volume)
            raise OptionError(
                f"segment {segment.name!r} lies {apart:.2g} mm off the voxels of the scan; "
                "allowed: a segment of this scan, or one as an object (as_object)"
            )
        if len(self._segments) == MOST_SEGMENTS:
            raise OptionError(
                f"segment {segment.name!r} is one too many; allowed: {MOST_SEGMENTS} in a scene"
            )
        next_one = PALETTE[len(self._segments) % len(PALETTE)]
        names = [other.name for other in self._segments]
        chosen = colour or first_colour(segment.name, names, otherwise=next_one)
        look = new_appearance(
            segment.name,
            chosen,
            visible=visible,
            touched_while_hidden=touched_while_hidden,
            shown_as=shown_as,
        )
        added = SceneSegment(segment, look, touchable)
        self._segments.append(added)
        return added


def require_scene(scene: object) -> None:
    """Refuses what is no scene.

    Raises:
        OptionError: It is none.
    """
    if not isinstance(scene, Scene):
        raise OptionError(
            f"scene of type {type(scene).__name__} given; allowed: a Scene, as "
            "palpate.Scene(volume, [segment, …]) makes it"
        )


def choose_segment(scene: Scene, name: str | None) -> Segment:
    """Returns the segment of a name or, where none has this name, of a number from 1 on.

    Without a name, the only one there is.

    Raises:
        OptionError: There is none, or there are several; names and numbers are told.
    """
    segments = [one.segment for one in scene]
    names = [one.name for one in scene]
    if name is None and len(segments) == 1:
        return segments[0]
    if name is not None and names.count(name) == 1:
        return segments[names.index(name)]
    if name is not None and names.count(name) > 1:
        numbers = [str(number) for number, other in enumerate(names, start=1) if other == name]
        raise OptionError(
            f"{len(numbers)} segments are called {name!r}; allowed: a number, "
            f"{', '.join(numbers[:-1])} or {numbers[-1]}"
        )
    if name is not None and name.isdecimal() and 1 <= int(name) <= len(segments):
        return segments[int(name) - 1]
    given = "no segment" if name is None else f"segment {name!r}"
    numbered = [f"{number} {other}" for number, other in enumerate(names, start=1)]
    allowed = f"a name or a number of {', '.join(numbered)}" if names else "none in this scan"
    raise OptionError(f"{given} given; allowed: {allowed}")
