"""Pictures of the 3-D view that the engine draws for pages: a thread for each page that asks.

All pages share one renderer, which follows the session's voxels, and one draws at a time. The first
picture of a request is drawn to its end, so that pictures come however often others are
requested; finer ones are given up at once for any newer request.
"""

from __future__ import annotations

import asyncio
import math
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from threading import Condition, Thread

import msgspec

from palpate import protocol
from palpate.base.errors import OptionError
from palpate.pictures.appearance import Appearance
from palpate.pictures.camera import Camera
from palpate.pictures.session_pictures import DrawnArrays, Fineness, SessionPictures
from palpate.pictures.still_pictures import StillPictures
from palpate.server.messages.encoded_picture import encoded_picture
from palpate.server.messages.outbox import Outbox
from palpate.server.messages.picture_pace import PicturePace
from palpate.server.messages.table import MessageTable, Runs
from palpate.session.session import Session

__all__ = ["EnginePictures"]

MOST_PIXELS = 1 << 24
"""Of one picture; about a gigabyte while it is drawn."""
HASTE_STEPS = 1.0
"""Steps for each smallest voxel edge of a picture in haste."""


@dataclass(frozen=True)
class Stage:
    """One of the pictures that answer a request, each finer than that before."""

    divisor: float
    samples: int = 1
    haste: bool = False
    """With the light of the picture before and few steps; drawn to its end, whatever is asked."""
    last: bool = False


class PagePainter:
    """Draws what one page asks for last, in a thread of its own."""

    def __init__(self, shared: SessionPictures, page: Outbox) -> None:
        """Sends pictures to a page; to be called on its event loop."""
        self._shared = shared
        self._page = page
        self._loop = asyncio.get_running_loop()
        self._changed = Condition()
        self._look: Appearance | None = None
        self._waiting: protocol.DrawPicture | None = None
        self._ended = False
        self._pace = PicturePace()
        self._thread = Thread(target=self._run, name="picture of a page", daemon=True)
        self._thread.start()

    def look(self, look: protocol.PictureLook) -> None:
        """Draws so from now on."""
        with self._changed:
            self._look = msgspec.convert(look, Appearance, from_attributes=True)

    def ask(self, request: protocol.DrawPicture) -> None:
        """Draws this next; what waits is forgotten."""
        with self._changed:
            self._waiting = request
            self._changed.notify()
        self._shared.give_up()

    def end(self) -> None:
        """Ends the thread, once the picture that it draws is given up or done."""
        with self._changed:
            self._ended = True
            self._changed.notify()
        self._shared.give_up()

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._ended or self._waiting is not None)
                if self._ended:
                    return
                request, self._waiting, look = self._waiting, None, self._look
            try:
                self._answer(request, look)
            except (ValueError, RuntimeError, MemoryError) as error:
                text = str(error) or "not enough memory for a picture of the engine"
                self._send(protocol.Notice(level="error", text=text))

    def _answer(self, request: protocol.DrawPicture | None, look: Appearance | None) -> None:
        if request is None or look is None:
            raise OptionError("picture requested before its look; allowed: picture_look first")
        columns, rows = request.size
        if columns * rows > MOST_PIXELS:
            raise OptionError(
                f"picture of {columns} × {rows} pixels given; allowed: {MOST_PIXELS} in all"
            )
        for stage in self._stages(request):
            if not self._draw(look, request, stage):
                return

    def _draw(self, look: Appearance, request: protocol.DrawPicture, stage: Stage) -> bool:
        """Draws and sends one picture; False where a newer request waits."""
        picture = None
        while picture is None:
            # what is asked after this number gives the picture up
            number = self._shared.next_number()
            if not stage.haste and self._is_superseded:
                return False
            began = time.perf_counter()
            # another page may have had it given up: then it is drawn again
            picture = self._picture(look, request, stage, number=None if stage.haste else number)
        seconds = time.perf_counter() - began
        if stage.haste:
            self._pace.learn(stage.divisor, seconds)
        self._send(
            encoded_picture(
                picture,
                number=request.number,
                divisor=stage.divisor,
                samples=stage.samples,
                finished=stage.last,
                seconds=seconds,
            )
        )
        return not self._is_superseded

    def _picture(
        self,
        look: Appearance,
        request: protocol.DrawPicture,
        stage: Stage,
        *,
        number: int | None,
    ) -> DrawnArrays | None:
        columns, rows = (math.ceil(edge / stage.divisor) for edge in request.size)
        fineness = Fineness(
            steps_per_voxel=HASTE_STEPS if stage.haste else request.steps_per_voxel,
            samples=stage.samples,
            jitter=request.jitter,
            haste=stage.haste,
        )
        return self._shared.draw(
            look,
            msgspec.convert(request.camera, Camera, from_attributes=True),
            (columns, rows),
            fineness=fineness,
            number=number,
        )

    def _stages(self, request: protocol.DrawPicture) -> Iterator[Stage]:
        """Yields what is drawn for a request, coarse to fine."""
        if request.moving:
            yield Stage(self._pace.divisor, haste=True)
            return
        yield Stage(2.0, haste=True)
        yield Stage(1.0, last=request.samples == 1)
        if request.samples > 1:
            yield Stage(1.0, samples=request.samples, last=True)

    @property
    def _is_superseded(self) -> bool:
        with self._changed:
            return self._ended or self._waiting is not None

    def _send(self, message: protocol.DrawnPicture | protocol.Notice) -> None:
        # the server may be ending
        with suppress(RuntimeError):
            self._loop.call_soon_threadsafe(self._page.put, message)


class EnginePictures:
    """Handles the messages of pages for which the engine draws; on the event loop."""

    def __init__(self, session: Session) -> None:
        """Draws what a session has."""
        self._shared = SessionPictures(session)
        self._session = session
        self._painters: dict[Outbox, PagePainter] = {}

    def still(self) -> StillPictures:
        """Returns pictures of the session as it is now, for which no page has to wait."""
        return StillPictures(self._session, self._shared)

    def add_to(self, table: MessageTable) -> None:
        """Adds the rows of pictures."""
        table.add(protocol.PictureLook, self.look, runs=Runs.ON_LOOP)
        table.add(protocol.DrawPicture, self.draw, runs=Runs.ON_LOOP)

    def leave(self, page: Outbox) -> None:
        """Ends what is drawn for a page that has gone."""
        painter = self._painters.pop(page, None)
        if painter is not None:
            painter.end()

    def look(self, look: protocol.PictureLook, page: Outbox) -> None:
        """Draws so for a page from now on."""
        self._painter(page).look(look)

    def draw(self, request: protocol.DrawPicture, page: Outbox) -> None:
        """Draws this next for a page."""
        self._painter(page).ask(request)

    def _painter(self, page: Outbox) -> PagePainter:
        if page not in self._painters:
            self._painters[page] = PagePainter(self._shared, page)
        return self._painters[page]
