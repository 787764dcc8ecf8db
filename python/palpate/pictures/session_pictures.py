"""Pictures of a session as it is now, in one look after another: one is drawn at a time."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import count
from threading import Lock

import numpy as np
from numpy.typing import NDArray

from palpate import _core
from palpate.pictures.appearance import Appearance
from palpate.pictures.camera import Camera
from palpate.session.session import Session
from palpate.volumes.second_scan import SecondScan

__all__ = ["DrawnArrays", "Fineness", "SessionPictures"]

NEVER_GIVEN_UP = 2**64 - 1
"""Number of a picture that is newer than all others."""
MOST_OF_PICTURE = 0.3
"""Share of a picture from which on a part is not drawn sooner than all of it."""


@dataclass(frozen=True)
class DrawnArrays:
    """A picture; rows from the upper edge, columns from the left."""

    colours: NDArray[np.float32]
    """Linear RGB multiplied by opacity, and opacity; shape [rows, columns, 4]."""
    depths: NDArray[np.float32]
    """From the eye along the direction of view [mm], infinite where nothing is, negative where
    that of what is seen through; shape [rows, columns]."""
    state: int = 0
    """Number of what it shows, see ``_core.Renderer.state``."""
    part: tuple[int, int] | None = None
    """Column and row in the whole picture where it begins; None where it is all of it."""
    eyes: int = 1
    """Whose pictures these are, one below the other."""


@dataclass(frozen=True, kw_only=True)
class Fineness:
    """How finely a picture is drawn."""

    steps_per_voxel: float = 1.0
    """Steps for each smallest voxel edge."""
    samples: int = 1
    """Pictures that are averaged, with rays through other places of each pixel."""
    jitter: bool = False
    """Rays start at different fractions of a step."""
    haste: bool = False
    """Without the occlusion by the nearest voxels."""


class SessionPictures:
    """A renderer of a session; every method may be called from any thread."""

    follows_edits = True
    """Whether a picture shows the edits since the first."""

    def __init__(self, session: Session) -> None:
        """Draws nothing until it is asked to."""
        self._session = session
        self._turn = Lock()
        self._numbers = count(1)
        self._renderer: _core.Renderer | None = None
        self._second: tuple[SecondScan, _core.SecondScan] | None = None

    def next_number(self) -> int:
        """Returns the number of the next picture."""
        return next(self._numbers)

    def give_up(self) -> None:
        """Gives up the picture that is drawn, unless it is to be drawn to its end."""
        renderer = self._renderer
        if renderer is not None:
            renderer.supersede(next(self._numbers))

    def free(self) -> None:
        """Frees what is prepared; the next picture prepares it again."""
        with self._turn:
            self._renderer = None
            self._second = None

    def draw(
        self,
        appearance: Appearance,
        camera: Camera,
        size: tuple[int, int],
        *,
        fineness: Fineness,
        number: int | None,
    ) -> DrawnArrays | None:
        """Draws the voxels as they are, in columns and rows; returns None where it was given up.

        Without a number of its own it is drawn to its end.

        Raises:
            ValueError: Appearance, camera or size are not allowed.
            RuntimeError: The session has ended.
        """
        return self.draw_eyes(appearance, [camera], size, fineness=fineness, number=number)

    def draw_eyes(
        self,
        appearance: Appearance,
        cameras: Sequence[Camera],
        size: tuple[int, int],
        *,
        fineness: Fineness,
        number: int | None,
    ) -> DrawnArrays | None:
        """Draws what each camera sees of the same voxels, as ``draw`` does.

        Raises:
            ValueError: Appearance, camera or size are not allowed.
            RuntimeError: The session has ended.
        """
        with self._turn:
            renderer = self._ready(appearance)
            return _below(
                _drawn(renderer, camera, size, fineness=fineness, number=number)
                for camera in cameras
            )

    def on_screen(
        self,
        appearance: Appearance,
        camera: Camera,
        size: tuple[int, int],
        *,
        fineness: Fineness,
        number: int | None,
    ) -> NDArray[np.uint8] | None:
        """Draws as ``draw`` does, and returns the picture as a screen shows it.

        That is sRGB and opacity over nothing, shape [rows, columns, 4].

        Raises:
            ValueError: Appearance, camera or size are not allowed.
            RuntimeError: The session has ended.
        """
        with self._turn:
            renderer = self._ready(appearance)
            picture = _picture(renderer, camera, size, fineness=fineness, number=number)
        return None if picture is None else picture.on_screen()

    def draw_edited(
        self,
        appearance: Appearance,
        camera: Camera,
        size: tuple[int, int],
        *,
        since: int,
        fineness: Fineness,
    ) -> DrawnArrays | None:
        """Draws the part that shows what was edited since a state, to its end.

        It is lit by the light of the picture before. Returns None where more than a part of a
        picture of so many columns and rows may look different.

        Raises:
            ValueError: Appearance, camera or size are not allowed.
            RuntimeError: The session has ended.
        """
        with self._turn:
            renderer = self._ready(appearance)
            part = renderer.part_edited_since(since, camera, size)
            if part is None or part[2] * part[3] > MOST_OF_PICTURE * size[0] * size[1]:
                return None
            return _drawn(renderer, camera, size, fineness=fineness, part=part)

    def _ready(self, appearance: Appearance) -> _core.Renderer:
        """Returns the renderer with the voxels and the second scan as they are now, in a look."""
        renderer = self._following()
        renderer.set_appearance(appearance)
        renderer.show_second(self._second_scan(), appearance.second)
        return renderer

    def _second_scan(self) -> _core.SecondScan | None:
        """Returns the session's second scan as the renderer reads it."""
        shown = self._session.scene.second
        if shown is None:
            self._second = None
            return None
        if self._second is None or self._second[0].volume is not shown.volume:
            volume = shown.volume._internal  # noqa: SLF001  # the renderer reads the voxels itself
            self._second = shown, _core.SecondScan(volume, shown.second_from_first)
        elif self._second[0] is not shown:
            self._second = shown, self._second[1].moved(shown.second_from_first)
        return self._second[1]

    def _following(self) -> _core.Renderer:
        """Returns the renderer with the voxels as they are now."""
        engine = self._session._engine  # noqa: SLF001  # the binding reads the engine's voxels itself
        if self._renderer is None:
            self._renderer = _core.Renderer.of_session(engine, waits=not self.follows_edits)
        elif self.follows_edits:
            self._renderer.follow(engine)
        return self._renderer


def _below(pictures: Iterable[DrawnArrays | None]) -> DrawnArrays | None:
    """Returns pictures of several eyes as one; None as soon as one was given up."""
    drawn = []
    for picture in pictures:
        if picture is None:
            return None
        drawn.append(picture)
    if len(drawn) == 1:
        return drawn[0]
    return DrawnArrays(
        np.concatenate([picture.colours for picture in drawn]),
        np.concatenate([picture.depths for picture in drawn]),
        state=drawn[0].state,
        eyes=len(drawn),
    )


def _drawn(
    renderer: _core.Renderer,
    camera: Camera,
    size: tuple[int, int],
    *,
    fineness: Fineness,
    part: tuple[int, int, int, int] | None = None,
    number: int | None = None,
) -> DrawnArrays | None:
    """Returns a picture, or a part of it; None where it was given up."""
    picture = _picture(renderer, camera, size, fineness=fineness, part=part, number=number)
    if picture is None:
        return None
    return DrawnArrays(
        picture.colours(),
        picture.depths(),
        state=renderer.state,
        part=None if part is None else part[:2],
    )


def _picture(
    renderer: _core.Renderer,
    camera: Camera,
    size: tuple[int, int],
    *,
    fineness: Fineness,
    part: tuple[int, int, int, int] | None = None,
    number: int | None = None,
) -> _core.Picture | None:
    return renderer.draw(
        camera,
        size,
        part=part,
        steps_per_voxel=fineness.steps_per_voxel,
        samples=fineness.samples,
        jitter=fineness.jitter,
        haste=fineness.haste,
        number=NEVER_GIVEN_UP if number is None else number,
    )
