"""Pictures of a session as it was at one moment, which make way for those of a live view."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from palpate.pictures.appearance import Appearance
from palpate.pictures.camera import Camera
from palpate.pictures.live_view import LiveView
from palpate.pictures.session_pictures import DrawnArrays, Fineness, SessionPictures
from palpate.session.session import Session

__all__ = ["StillPictures"]

Drawn = TypeVar("Drawn")
PATIENCE = 1.0
"""Seconds that a picture makes way: a live view may never rest."""
LOOK_EVERY = 0.02
"""Seconds between two looks whether the live view rests."""


class StillPictures(SessionPictures):
    """A renderer of the voxels as they were when it drew first; edits after that are not seen."""

    follows_edits = False

    def __init__(self, session: Session, live: LiveView) -> None:
        """Draws nothing until it is asked to; all that is drawn ``live`` goes first."""
        super().__init__(session)
        self._live = live
        live.put_before(self)

    def close(self) -> None:
        """Nobody has to wait for it any more."""
        self._live.forget(self)

    def draw_at_rest(
        self, appearance: Appearance, camera: Camera, size: tuple[int, int], *, fineness: Fineness
    ) -> DrawnArrays:
        """Draws once the live view rests, or has had its way for a second.

        Raises:
            ValueError: Appearance, camera or size are not allowed.
            RuntimeError: The session had ended before the first picture.
        """
        return self._at_rest(
            lambda number: self.draw(appearance, camera, size, fineness=fineness, number=number)
        )

    def on_screen_at_rest(
        self, appearance: Appearance, camera: Camera, size: tuple[int, int], *, fineness: Fineness
    ) -> NDArray[np.uint8]:
        """Draws as ``draw_at_rest`` does, and returns the picture as ``on_screen`` does.

        Raises:
            ValueError: Appearance, camera or size are not allowed.
            RuntimeError: The session had ended before the first picture.
        """
        return self._at_rest(
            lambda number: self.on_screen(
                appearance, camera, size, fineness=fineness, number=number
            )
        )

    def _at_rest(self, draw: Callable[[int | None], Drawn | None]) -> Drawn:
        """Draws anew until no live picture came in between, or patience has ended."""
        until = time.monotonic() + PATIENCE
        picture = None
        while picture is None:
            while self._live.is_busy and time.monotonic() < until:
                time.sleep(LOOK_EVERY)
            picture = draw(self.next_number() if time.monotonic() < until else None)
        return picture
