"""Messages on painting: strokes of the brush, and outlines in slices that are filled.

A stroke is painted at a time. Outlines are asked for while the pointer moves; the paths of the live
wire from its last point are kept, so that only the first of them takes time.
"""

from __future__ import annotations

import asyncio
from threading import Lock

from palpate import protocol
from palpate.base.errors import PalpateError
from palpate.segmentation.brush import Brush
from palpate.segmentation.level_tracing import traced_level
from palpate.segmentation.live_wire import LiveWire
from palpate.server.messages.outbox import Outbox
from palpate.server.messages.table import MessageTable, Runs
from palpate.session.painted_stroke import PaintedStroke
from palpate.session.session import Session
from palpate.volumes.scan_slice import ScanSlice
from palpate.volumes.volume import Volume

__all__ = ["Outlines", "Painter"]

OutlineRequest = protocol.Wire | protocol.TraceLevel


class Painter:
    """The stroke that is being painted; every method may be called from any thread."""

    def __init__(self, session: Session) -> None:
        """Paints segments of a session."""
        self._session = session
        self._lock = Lock()
        self._stroke: PaintedStroke | None = None
        self._page: Outbox | None = None

    def add_to(self, table: MessageTable) -> None:
        """Adds the rows of strokes."""
        table.add(protocol.Paint, self._paint, runs=Runs.IN_ORDER)
        table.add(protocol.EndPaint, self._end_paint, runs=Runs.IN_ORDER)
        table.add(protocol.FillOutline, self._fill, runs=Runs.IN_ORDER)

    def end(self, *, keep: bool = True) -> None:
        """Ends the stroke, where there is one."""
        with self._lock:
            self._end(keep=keep)

    def leave(self, page: Outbox) -> None:
        """Ends the stroke of a page that has gone."""
        with self._lock:
            if self._page is page:
                self._end(keep=True)

    def _paint(self, wanted: protocol.Paint, page: Outbox) -> None:
        """Begins a stroke of a page, or goes on with it; one of another page ends."""
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

    def _end_paint(self, message: protocol.EndPaint, _: Outbox) -> None:
        self.end(keep=message.keep)

    def _fill(self, wanted: protocol.FillOutline, _: Outbox) -> None:
        """Paints what an outline encloses; a stroke that is on ends."""
        with self._lock:
            self._end(keep=True)
            stroke = PaintedStroke(self._session, wanted.id, erases=wanted.erases)
            stroke.inside(wanted.points, normal=wanted.normal, values=wanted.values)
            stroke.finish()

    def _end(self, *, keep: bool) -> None:
        stroke, self._stroke, self._page = self._stroke, None, None
        if stroke is None:
            return
        if keep:
            stroke.finish()
        else:
            stroke.cancel()


class Outlines:
    """Finds paths of the live wire and levels, one after another, beside the event loop.

    Edges are those of the scan as it was read.
    """

    def __init__(self, volume: Volume) -> None:
        """Finds outlines in a scan."""
        self._volume = volume
        self._wire: tuple[object, LiveWire] | None = None
        self._turn = asyncio.Lock()
        self._answers: set[asyncio.Task[None]] = set()

    def add_to(self, table: MessageTable) -> None:
        """Adds the rows of outlines."""
        table.add(protocol.Wire, self._begin, runs=Runs.BESIDE)
        table.add(protocol.TraceLevel, self._begin, runs=Runs.BESIDE)

    def _begin(self, request: OutlineRequest, page: Outbox) -> None:
        task = asyncio.create_task(self._answer(request, page))
        self._answers.add(task)
        task.add_done_callback(self._answers.discard)

    async def _answer(self, request: OutlineRequest, page: Outbox) -> None:
        async with self._turn:
            page.put(await asyncio.to_thread(self._outline, request))

    def _outline(self, request: OutlineRequest) -> protocol.Outline:
        try:
            match request:
                case protocol.Wire(begin=begin, end=end, normal=normal):
                    points = self._paths_from(begin, normal).to(end)
                case protocol.TraceLevel(point=point, normal=normal):
                    points = traced_level(self._volume, point, normal=normal)
        except (PalpateError, MemoryError) as error:
            return protocol.Outline(request.number, [], str(error) or "not enough memory")
        x_y_z: list[tuple[float, float, float]] = [(x, y, z) for x, y, z in points.tolist()]
        return protocol.Outline(request.number, x_y_z, None)

    def _paths_from(self, begin: protocol.Vector, normal: protocol.Vector) -> LiveWire:
        """Returns the paths from a point; those from the last point are kept."""
        where = ScanSlice.through(self._volume, begin, normal=normal)
        key = begin, where.key()
        if self._wire is None or self._wire[0] != key:
            self._wire = key, LiveWire(where, begin)
        return self._wire[1]
