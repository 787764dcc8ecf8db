"""The live view of a session's pages: pictures that are saved make way for it."""

from __future__ import annotations

import time

from palpate.pictures.session_pictures import SessionPictures

__all__ = ["LiveView"]

REST = 0.15
"""Seconds without a request after which nobody is taken to turn the view."""


class LiveView:
    """Knows when pictures of the view are requested; every method may be called from any thread."""

    def __init__(self) -> None:
        """Nothing was requested yet."""
        self._lesser: tuple[SessionPictures, ...] = ()
        self._requested = -REST

    @property
    def is_busy(self) -> bool:
        """Whether another picture is likely to be requested."""
        return time.monotonic() - self._requested < REST

    def request(self) -> None:
        """Notes that a picture is requested, and gives up those that make way for it."""
        self._requested = time.monotonic()
        for others in self._lesser:
            others.give_up()

    def put_before(self, others: SessionPictures) -> None:
        """Has pictures of others make way from now on."""
        self._lesser = (*self._lesser, others)

    def forget(self, others: SessionPictures) -> None:
        """Lets others draw on."""
        self._lesser = tuple(each for each in self._lesser if each is not others)
