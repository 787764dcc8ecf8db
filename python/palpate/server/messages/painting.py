"""Strokes of the brush that pages paint: one at a time."""

from __future__ import annotations

from threading import Lock

from palpate import protocol
from palpate.segmentation.brush import Brush
from palpate.session.painted_stroke import PaintedStroke
from palpate.session.session import Session

__all__ = ["Painter"]


class Painter:
    """The stroke that is being painted; every method may be called from any thread."""

    def __init__(self, session: Session) -> None:
        """Paints segments of a session."""
        self._session = session
        self._lock = Lock()
        self._stroke: PaintedStroke | None = None
        self._page: object = None

    def paint(self, wanted: protocol.Paint, page: object) -> None:
        """Begins a stroke of a page, or goes on with it; one of another page ends.

        Raises:
            OptionError: It cannot be painted.
        """
        with self._lock:
            stroke = self._stroke
            if (
                stroke is None
                or self._page is not page
                or (stroke.segment_id, stroke.erases) != (wanted.id, wanted.erases)
            ):
                self._end(keep=True)
                stroke = PaintedStroke(self._session, wanted.id, erases=wanted.erases)
                self._stroke, self._page = stroke, page
            brush = Brush(radius=wanted.radius, normal=wanted.normal, values=wanted.values)
            stroke.along(brush, wanted.points)

    def fill(self, wanted: protocol.FillOutline) -> None:
        """Paints what an outline encloses; a stroke that is on ends.

        Raises:
            OptionError: It cannot be painted.
        """
        with self._lock:
            self._end(keep=True)
            stroke = PaintedStroke(self._session, wanted.id, erases=wanted.erases)
            stroke.inside(wanted.points, normal=wanted.normal, values=wanted.values)
            stroke.finish()

    def end(self, *, keep: bool = True) -> None:
        """Ends the stroke, where there is one."""
        with self._lock:
            self._end(keep=keep)

    def leave(self, page: object) -> None:
        """Ends the stroke of a page that has gone."""
        with self._lock:
            if self._page is page:
                self._end(keep=True)

    def _end(self, *, keep: bool) -> None:
        stroke, self._stroke, self._page = self._stroke, None, None
        if stroke is None:
            return
        if keep:
            stroke.finish()
        else:
            stroke.cancel()
