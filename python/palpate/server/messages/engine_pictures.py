"""Pictures of the 3-D view that the engine draws for pages: a thread for each page that asks.

Each page has a renderer of its own, with its own look and light, which follows the session's
voxels; these are shared. A newer request of a page gives up what is drawn for the one before, of
no other page. Coarse pictures are drawn at once, beside whatever is drawn; fine ones of several
pages in turn.
"""

from __future__ import annotations

import asyncio
import logging
import math
import time
from collections.abc import Iterator
from contextlib import nullcontext, suppress
from dataclasses import dataclass
from threading import Condition, Thread

import msgspec

from palpate import protocol
from palpate.base.errors import OptionError
from palpate.pictures.appearance import Appearance
from palpate.pictures.camera import Camera
from palpate.pictures.live_view import LiveView
from palpate.pictures.session_pictures import DrawnArrays, Fineness, SessionPictures
from palpate.pictures.still_pictures import StillPictures
from palpate.server.messages.encoded_picture import encoded_picture
from palpate.server.messages.fine_turn import FineTurn
from palpate.server.messages.outbox import Outbox
from palpate.server.messages.picture_coding import PictureCoder
from palpate.server.messages.picture_pace import PicturePace
from palpate.server.messages.table import MessageTable, Runs
from palpate.server.page_words import page_words
from palpate.session.session import Session

__all__ = ["EnginePictures"]

MOST_PIXELS = 1 << 23
"""Of one picture, as many as a 4K screen has; larger ones are drawn more coarsely. About half a
gigabyte while it is drawn, and one is drawn at a time."""
MOST_RENDERERS = 4
"""That are kept ready: the light of each takes up to 8 MB, its segments a byte for each voxel in
bricks that have any."""
HASTE_STEPS = 1.0
"""Steps for each smallest voxel edge of a picture in haste."""
COARSE = 2.0
"""Divisor of the first picture of a view at rest."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Stage:
    """One of the pictures that answer a request, each finer than that before."""

    divisor: float
    samples: int = 1
    haste: bool = False
    """With the light of the picture before and few steps, and at once."""
    to_end: bool = False
    """Drawn to its end, whatever is asked meanwhile, so that something of the request is seen."""
    last: bool = False


class AllPages(LiveView):
    """What is drawn for all pages."""

    def __init__(self, fine_turn: FineTurn) -> None:
        """Nothing was requested yet."""
        super().__init__()
        self._fine_turn = fine_turn

    @property
    def is_busy(self) -> bool:
        """Whether a fine picture is drawn, or another is likely to be requested."""
        return super().is_busy or self._fine_turn.is_taken


class PagePainter:
    """Draws what one page asks for last, in a thread of its own."""

    def __init__(
        self, session: Session, page: Outbox, *, fine_turn: FineTurn, every: AllPages
    ) -> None:
        """Sends pictures to a page; to be called on its event loop."""
        self._all = every
        self._own = SessionPictures(session)
        self._fine_turn = fine_turn
        self._page = page
        self._loop = asyncio.get_running_loop()
        self._changed = Condition()
        self._look: Appearance | None = None
        self._waiting: protocol.DrawPicture | None = None
        self._moved: tuple[object, float] | None = None
        self._ended = False
        self._rests = False
        self._pace = PicturePace()
        self._coder = PictureCoder()
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
        self._own.give_up()
        self._all.request()

    def end(self) -> None:
        """Ends the thread, once the picture that it draws is given up or done."""
        with self._changed:
            self._ended = True
            self._changed.notify()
        self._own.give_up()

    def rest(self) -> None:
        """Frees what is prepared, once nothing is drawn."""
        with self._changed:
            self._rests = True
            self._changed.notify()

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(
                    lambda: self._ended or self._rests or self._waiting is not None
                )
                request, self._waiting, look = self._waiting, None, self._look
                ended, self._rests = self._ended, False
            if ended:
                return
            if request is None:
                self._own.free()
                continue
            try:
                self._answer(request, look)
            except BaseException as error:  # noqa: BLE001  # a panic of the engine is no Exception
                self._fail(request, error)

    def _fail(self, request: protocol.DrawPicture, error: BaseException) -> None:
        """Tells the page why its pictures do not come."""
        if not isinstance(error, OptionError):
            _log.error("a picture of the engine failed", exc_info=error)
        text = str(error) or type(error).__name__
        if isinstance(error, MemoryError):
            text = "not enough memory for a picture of the engine"
        answer = protocol.PictureFailed(number=request.number, text=page_words(text))
        # the server may be ending
        with suppress(RuntimeError):
            self._loop.call_soon_threadsafe(self._page.put, answer)

    def _answer(self, request: protocol.DrawPicture, look: Appearance | None) -> None:
        if look is None:
            raise OptionError("picture requested before its look; allowed: picture_look first")
        if self._draw_edited(request, look) and self._superseded():
            return
        for stage in self._stages(request, look):
            if not self._draw(look, request, stage):
                return

    def _draw_edited(self, request: protocol.DrawPicture, look: Appearance) -> bool:
        """Draws and sends the part that was edited under what the page shows, if it is but one."""
        over = request.over
        if over is None or over.divisor > COARSE or len(request.cameras) > 1:
            return False
        began = time.perf_counter()
        stage = Stage(over.divisor)
        picture = self._own.draw_edited(
            look,
            self._cameras(request)[0],
            self._size(request, stage),
            since=over.state,
            fineness=self._fineness(request, stage),
        )
        if picture is None:
            return False
        self._send(picture, request, stage, seconds=time.perf_counter() - began, over=over.state)
        self._moved = (self._key(request, look), stage.divisor)
        return True

    def _draw(self, look: Appearance, request: protocol.DrawPicture, stage: Stage) -> bool:
        """Draws and sends one picture; False where a newer request waits."""
        turn = (
            nullcontext(enter_result=True)
            if stage.haste
            else self._fine_turn.taken(self._superseded)
        )
        with turn as has_turn:
            # what is asked after this number gives the picture up
            number = self._own.next_number()
            if not has_turn or (self._superseded() and not stage.to_end):
                return False
            began = time.perf_counter()
            picture = self._picture(look, request, stage, number=None if stage.to_end else number)
            if picture is None:
                return False
            seconds = time.perf_counter() - began
            size = self._send(picture, request, stage, seconds=seconds)
        if stage.haste:
            self._pace.learn(stage.divisor, seconds + size / self._page.picture_rate)
        if request.moving:
            self._moved = (self._key(request, look), stage.divisor)
        return not self._superseded()

    def _picture(
        self,
        look: Appearance,
        request: protocol.DrawPicture,
        stage: Stage,
        *,
        number: int | None,
    ) -> DrawnArrays | None:
        return self._own.draw_eyes(
            look,
            self._cameras(request),
            self._size(request, stage),
            fineness=self._fineness(request, stage),
            number=number,
        )

    @staticmethod
    def _cameras(request: protocol.DrawPicture) -> list[Camera]:
        return msgspec.convert(request.cameras, list[Camera], from_attributes=True)

    @staticmethod
    def _size(request: protocol.DrawPicture, stage: Stage) -> tuple[int, int]:
        columns, rows = (math.ceil(edge / stage.divisor) for edge in request.size)
        return columns, rows

    @staticmethod
    def _fineness(request: protocol.DrawPicture, stage: Stage) -> Fineness:
        return Fineness(
            steps_per_voxel=HASTE_STEPS if stage.haste else request.steps_per_voxel,
            samples=stage.samples,
            jitter=request.jitter,
            haste=stage.haste,
        )

    def _stages(self, request: protocol.DrawPicture, look: Appearance) -> Iterator[Stage]:
        """Yields what is drawn for a request, coarse to fine."""
        columns, rows = request.size
        pixels = columns * rows * len(request.cameras)
        finest = max(1.0, math.sqrt(pixels / MOST_PIXELS))
        if request.moving:
            yield Stage(max(finest, self._pace.divisor), haste=True, to_end=True)
            return
        # what changes under a view at rest may be an edit beyond a part of it, so this holds once
        (known, divisor), self._moved = self._moved or (None, math.inf), None
        is_seen = known == self._key(request, look)
        coarse = max(finest, COARSE)
        if not is_seen and self._pace.slows:
            # where that takes seconds, what has changed is seen by a coarser picture until then
            yield Stage(max(finest, self._pace.divisor), haste=True, to_end=True)
            yield Stage(coarse, haste=True)
        elif not is_seen or divisor > coarse:
            yield Stage(coarse, haste=True, to_end=not is_seen)
        yield Stage(finest, last=request.samples == 1)
        if request.samples > 1:
            yield Stage(finest, samples=request.samples, last=True)

    @staticmethod
    def _key(request: protocol.DrawPicture, look: Appearance) -> object:
        """Returns what a picture in haste depends on, but for voxels."""
        return request.cameras, request.size, look

    def _superseded(self) -> bool:
        with self._changed:
            return self._ended or self._waiting is not None

    def _send(
        self,
        picture: DrawnArrays,
        request: protocol.DrawPicture,
        stage: Stage,
        *,
        seconds: float,
        over: int | None = None,
    ) -> int:
        """Sends a picture; returns its bytes."""
        pixels, rate = picture.depths.size, self._page.picture_rate
        packing = self._coder.packing(pixels, rate, moving=request.moving, last=stage.last)
        message = encoded_picture(
            picture,
            number=request.number,
            divisor=stage.divisor,
            samples=stage.samples,
            finished=stage.last,
            seconds=seconds,
            over=over,
            packing=packing,
        )
        packed = protocol.encode_to_page(message)
        self._coder.learn(packing, pixels, len(packed))
        # the server may be ending
        with suppress(RuntimeError):
            self._loop.call_soon_threadsafe(self._page.put_picture, request.number, packed)
        return len(packed)


class EnginePictures:
    """Handles the messages of pages for which the engine draws; on the event loop."""

    def __init__(self, session: Session) -> None:
        """Draws what a session has."""
        self._session = session
        self._fine_turn = FineTurn()
        self._all = AllPages(self._fine_turn)
        self._painters: dict[Outbox, PagePainter] = {}
        """Those that drew last at the end."""

    def still(self) -> StillPictures:
        """Returns pictures of the session as it is now, for which no page has to wait."""
        return StillPictures(self._session, self._all)

    def add_to(self, table: MessageTable) -> None:
        """Adds the rows of pictures."""
        table.add(protocol.PictureLook, self.look, runs=Runs.ON_LOOP)
        table.add(protocol.DrawPicture, self.draw, runs=Runs.ON_LOOP)
        table.add(protocol.PictureTaken, self.taken, runs=Runs.ON_LOOP)

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
        painter = self._painter(page)
        self._painters[page] = self._painters.pop(page)
        for other in list(self._painters.values())[:-MOST_RENDERERS]:
            other.rest()
        painter.ask(request)

    def taken(self, _: protocol.PictureTaken, page: Outbox) -> None:
        """Notes that a part of a picture has come to a page."""
        page.picture_taken()

    def _painter(self, page: Outbox) -> PagePainter:
        if page not in self._painters:
            self._painters[page] = PagePainter(
                self._session, page, fine_turn=self._fine_turn, every=self._all
            )
        return self._painters[page]
