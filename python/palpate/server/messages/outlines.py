"""Outlines in slices for pages: paths of the live wire, and levels, one after another.

A page asks while the pointer moves; the paths from its last point are kept, so that only the first
of them takes time. Edges are those of the scan as it was read.
"""

from __future__ import annotations

import asyncio

from palpate import protocol
from palpate.base.errors import PalpateError
from palpate.segmentation.level_tracing import traced_level
from palpate.segmentation.live_wire import LiveWire
from palpate.server.messages.outbox import Outbox
from palpate.volumes.scan_slice import ScanSlice
from palpate.volumes.volume import Volume

__all__ = ["Outlines"]

Asked = protocol.Wire | protocol.TraceLevel


class Outlines:
    """Answers pages, beside all that else they ask for."""

    def __init__(self, volume: Volume) -> None:
        """Finds outlines in a scan."""
        self._volume = volume
        self._wire: tuple[object, LiveWire] | None = None
        self._turn = asyncio.Lock()
        self._answers: set[asyncio.Task[None]] = set()

    def take(self, message: protocol.FromPage, outbox: Outbox) -> bool:
        """Takes what a page asks for; says whether the message was for this."""
        if not isinstance(message, protocol.Wire | protocol.TraceLevel):
            return False
        task = asyncio.create_task(self._answer(message, outbox))
        self._answers.add(task)
        task.add_done_callback(self._answers.discard)
        return True

    async def _answer(self, asked: Asked, outbox: Outbox) -> None:
        async with self._turn:
            outbox.tell(await asyncio.to_thread(self._found, asked))

    def _found(self, asked: Asked) -> protocol.Outline:
        try:
            match asked:
                case protocol.Wire(begin=begin, end=end, normal=normal):
                    points = self._from(begin, normal).to(end)
                case protocol.TraceLevel(point=point, normal=normal):
                    points = traced_level(self._volume, point, normal=normal)
        except (PalpateError, MemoryError) as error:
            return protocol.Outline(asked.number, [], str(error) or "not enough memory")
        x_y_z: list[tuple[float, float, float]] = [(x, y, z) for x, y, z in points.tolist()]
        return protocol.Outline(asked.number, x_y_z, None)

    def _from(self, begin: protocol.Vector, normal: protocol.Vector) -> LiveWire:
        """Returns the paths from a point: those that are known, where it was the last one."""
        where = ScanSlice.through(self._volume, begin, normal=normal)
        key = begin, where.key()
        if self._wire is None or self._wire[0] != key:
            self._wire = key, LiveWire(where, begin)
        return self._wire[1]
