"""One session and all pages that show it.

The engine's threads never wait for this: states are read while pages look, and what may take
its time runs beside the event loop.
"""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import suppress
from queue import SimpleQueue
from typing import Literal

import msgspec
from starlette.websockets import WebSocket, WebSocketDisconnect

from palpate import protocol
from palpate.base.errors import PalpateError
from palpate.saved.journal import Journal
from palpate.server.changes import messages_of
from palpate.server.gap import GapWatch
from palpate.server.needle import ToldNeedle
from palpate.server.outbox import Missed, Outbox
from palpate.server.outlines import Outlines
from palpate.server.paint import Painter
from palpate.server.picture import ToldPicture, labels_anew
from palpate.server.recording import Recorder
from palpate.server.recovery import Recovering
from palpate.server.registration import Registering
from palpate.server.requests import Requests
from palpate.server.second_scan import second_message
from palpate.server.segment_work import SegmentWork
from palpate.server.segments import ShownSegments
from palpate.server.soft_tissue import parts_of
from palpate.server.thresholds import ThresholdJobs
from palpate.session.session import Session
from palpate.volumes.second_scan import SecondScan

__all__ = ["EXCHANGED", "Live"]

STATES_HZ = 60.0
"""States a second while pages look."""
PATIENCE = 0.1
"""Seconds that a thread waits for changes: so long may it outlive the server."""
IDLE_HZ = 5.0
"""States a second while none does: enough for notices and counters."""
EXCHANGED = 4001
"""Code with which pages of a scan are sent away that makes room for another."""


class Live:
    """Tells pages what is, and the session what they want."""

    def __init__(
        self,
        session: Session,
        hello: protocol.Hello,
        recorder: Recorder,
        *,
        journal: Journal | None = None,
        looks: bytes | None = None,
    ) -> None:
        """Shows a session; ``hello`` is what each page is told first.

        ``looks`` are those of a scene that was opened.
        """
        self._from_threads: SimpleQueue[protocol.ToPage] = SimpleQueue()
        self.session = session
        self.recorder = recorder
        self.journal = journal
        self.segments = ShownSegments(session, None if journal is None else journal.note)
        if looks is not None:
            self.segments.restore(looks)
        self._recovery = Recovering(
            journal, self.segments, show_second=self.show_second, tell=self._from_threads.put
        )
        self._recovery.restore_looks()
        self._hello = hello
        self.picture = ToldPicture(session.scene.volume.array)
        self._outboxes: set[Outbox] = set()
        self._sockets: set[WebSocket] = set()
        self._thresholds = ThresholdJobs(self._make_threshold)
        self._segment_work = SegmentWork(session, self.segments, self._from_threads.put)
        self._presses: Outbox | None = None
        self._painter = Painter(session)
        self._outlines = Outlines(session.scene.volume)
        self._paces: dict[Outbox, int] = {}
        self._needle = ToldNeedle(session)
        self._parts_for: set[Outbox] = set()
        self._gaps = GapWatch(session, self._from_threads.put)
        self._requests = Requests(
            session,
            self.segments,
            painter=self._painter,
            recorder=recorder,
            gaps=self._gaps,
            recovery=self._recovery,
            settings=hello.settings,
            tell=self._from_threads.put,
        )
        self._scene_of_now: object = None
        self._second = second_message(session.scene.second, version=0)
        self.registering = Registering(session, show=self.show_second, tell=self._from_threads.put)

    async def run(self) -> None:
        """Tells all pages what is, until it is cancelled or the session ends by itself."""
        worker = asyncio.create_task(self._thresholds.run())
        segment_worker = asyncio.create_task(self._segment_work.run())
        gaps = asyncio.create_task(self._gaps.run(lambda: self._scene_of_now))
        changes = asyncio.create_task(self._follow_changes())
        try:
            while self._tell_state():
                await asyncio.sleep(1.0 / (STATES_HZ if self._outboxes else IDLE_HZ))
        finally:
            worker.cancel()
            self._segment_work.stop()
            self.registering.stop()
            segment_worker.cancel()
            gaps.cancel()
            changes.cancel()

    async def serve(self, websocket: WebSocket) -> None:
        """Serves one page until it leaves."""
        await websocket.accept()
        # it knows no surface yet; the voxels it asks for
        outbox = Outbox(missed=Missed())
        outbox.tell(
            msgspec.structs.replace(
                self._hello,
                segments=self.segments.message.segments,
                settings=self._requests.settings,
            )
        )
        outbox.tell(self.segments.message)
        if self._second.scan is not None:
            outbox.tell(self._second)
            outbox.tell(self.registering.message)
        for message in self._recovery.messages():
            outbox.tell(message)
        self._outboxes.add(outbox)
        self._sockets.add(websocket)
        sender = asyncio.create_task(self._send(websocket, outbox))
        try:
            while True:
                await self._take(await _receive(websocket), outbox)
        except WebSocketDisconnect:
            pass
        finally:
            self._outboxes.discard(outbox)
            self._sockets.discard(websocket)
            self._paces.pop(outbox, None)
            self._follow_edits()
            self._show_parts(outbox, on=False)
            if not self._outboxes:
                # nobody looks at the gap any more, nor lets go of what is in the hand
                self._gaps.choose(None)
                with suppress(PalpateError, RuntimeError):
                    await asyncio.to_thread(self.session.grab, None)
                    await asyncio.to_thread(self.session.clutch, on=False)
            sender.cancel()
            with suppress(PalpateError, RuntimeError):
                await asyncio.to_thread(self._painter.leave, outbox)
            if self._presses is outbox:
                # nobody is left to release the tool
                await asyncio.to_thread(self._release)

    def notify(self, level: Literal["info", "warning"], text: str) -> None:
        """Tells all pages a sentence; for any thread."""
        self._from_threads.put(protocol.Notice(level=level, text=text))

    def show_second(self, second: SecondScan | None) -> None:
        """Shows another scan with the first, or the same one elsewhere; from any thread."""
        scene = self.session.scene
        same = (
            second is not None and scene.second is not None and second.volume is scene.second.volume
        )
        version = self._second.version + (0 if same else 1)
        scene.second = second
        self._second = second_message(second, version=version)
        if self.journal is not None:
            self.journal.note_second(second)
        self._from_threads.put(self._second)
        self.registering.follow(second)

    async def send_away(self) -> None:
        """Has all pages load themselves anew: another scan takes the place of this one."""
        for websocket in list(self._sockets):
            with suppress(RuntimeError):
                await websocket.close(EXCHANGED, "another scan")

    # --- to pages -------------------------------------------------------------------------

    def _tell(self, message: protocol.ToPage) -> None:
        for outbox in self._outboxes:
            outbox.tell(message)

    def _tell_from_threads(self) -> None:
        while not self._from_threads.empty():
            self._tell(self._from_threads.get())

    def _tell_state(self) -> bool:
        """Tells what is now and what changed; False where the session has ended."""
        frame = self.session.frame()
        for level, text in frame["notices"]:
            self._tell(protocol.Notice(level=level, text=text))
        self._tell_from_threads()
        if not self.session.is_running:
            self._tell(protocol.Notice(level="error", text="the session has ended: start it again"))
            return False
        self._scene_of_now = (frame["edit"], frame["poses"])
        versions, voxels = frame["segments_version"], frame["voxels_version"]
        if self.segments.refresh(versions, voxels_version=voxels, pending=frame["pending"]):
            self._tell(self.segments.message)
            for text in self.segments.take_notices():
                self._tell(protocol.Notice(level="info", text=text))
        self._tell_changes()
        needle = self._needle.message(frame["needle"]["events"])
        if needle is not None:
            self._tell(needle)
        try:
            fields = protocol.State.__struct_fields__
            told = {name: value for name, value in frame.items() if name in fields}
            state = msgspec.convert(told, protocol.State)
        except msgspec.ValidationError as error:
            self._tell(protocol.Notice(level="error", text=f"the engine is out of order: {error}"))
            return False
        self._tell(state)
        self._tell_parts()
        return True

    def _tell_parts(self) -> None:
        parts = self.session.model_parts() if self._parts_for else None
        if parts is not None:
            message = parts_of(parts)
            for outbox in self._parts_for:
                outbox.tell(message)

    async def _follow_changes(self) -> None:
        """Tells changes of voxels and surfaces as soon as they are made."""
        heard = 0
        while True:
            heard = await asyncio.to_thread(self.session.wait_for_changes, heard, PATIENCE)
            self._tell_changes()

    def _tell_changes(self) -> None:
        for change in self.session.picture_changes():
            for message in messages_of(change):
                self.picture.take(message)
                self._tell(message)

    async def _send(self, websocket: WebSocket, outbox: Outbox) -> None:
        """Sends what a page is to be told, as fast as it takes it."""
        # a page that leaves is noticed where its messages are received
        with suppress(WebSocketDisconnect, RuntimeError):
            while True:
                told = await outbox.next()
                if isinstance(told, Missed):
                    async for message in self._anew(told):
                        await websocket.send_bytes(protocol.encode_to_page(message))
                else:
                    await websocket.send_bytes(told)

    async def _anew(self, missed: Missed) -> AsyncIterator[protocol.Changed]:
        """Yields what a page has missed, as it is now.

        Changes that are told meanwhile wait, and come after it: of voxels and surfaces in both
        the later ones hold in the end.
        """
        edit = self.picture.edit
        whole = await asyncio.to_thread(self.session.whole_surfaces)
        for message in self.picture.surfaces_anew(whole, edit=edit):
            yield message
        for message in self.picture.values_anew(missed.stored, edit=edit):
            yield message
        if not missed.labels.is_empty:
            with suppress(
                PalpateError, RuntimeError
            ):  # a session that has ended has no more voxels
                labels = await asyncio.to_thread(self.segments.labels)
                for message in labels_anew(missed.labels, labels, edit=edit):
                    yield message

    # --- from pages -----------------------------------------------------------------------

    async def _take(self, packed: bytes, outbox: Outbox) -> None:
        """Does what a page asks; tells that page where it cannot be done."""
        try:
            message = protocol.decode_from_page(packed)
            if self._begin(message) or self._outlines.take(message, outbox):
                return
            match message:
                case protocol.Hand(target):
                    # the most frequent message, and wait-free
                    self.session.hand(target)
                case protocol.FollowEdits(every):
                    self._paces[outbox] = every
                    self._follow_edits()
                case protocol.ShowParts(on):
                    self._show_parts(outbox, on=on)
                case protocol.Stroke(on):
                    await asyncio.to_thread(self.session.stroke, on=on)
                    self._presses = outbox if on else None
                case protocol.Fence(number):
                    # messages of a page are done one after another: answers go before
                    self._tell_from_threads()
                    outbox.tell(protocol.Passed(number, tick=self._following_tick()))
                case _:
                    await asyncio.to_thread(self._requests.do, message, outbox)
        except msgspec.DecodeError as error:
            outbox.tell(protocol.Notice(level="error", text=f"message not understood: {error}"))
        except (PalpateError, OSError) as error:
            outbox.tell(protocol.Notice(level="error", text=str(error)))
        except RuntimeError as error:
            outbox.tell(protocol.Notice(level="error", text=str(error)))

    def _begin(self, message: protocol.FromPage) -> bool:
        """Hands on what is done beside all else; says whether the message was that."""
        if isinstance(message, protocol.Threshold):
            self._thresholds.ask(message)
            return True
        return self._segment_work.take(message) or self.registering.take(message)

    def _following_tick(self) -> int:
        """Returns the first tick that follows all that the session was told until now."""
        # one has begun and may be past its commands; the next one takes them
        ticks = self.session.lateness()["servo"]["ticks"]
        return ticks + 1

    def _follow_edits(self) -> None:
        """Has the engine follow edits at the pace of the slowest page."""
        self.session.follow_edits(max(self._paces.values(), default=1))

    def _show_parts(self, outbox: Outbox, *, on: bool) -> None:
        """Tells a page the parts of the model from now on, or no more."""
        if on:
            self._parts_for.add(outbox)
        else:
            self._parts_for.discard(outbox)
        self.session.show_model_parts(on=bool(self._parts_for))

    def _release(self) -> None:
        self._presses = None
        with suppress(RuntimeError):
            self.session.stroke(on=False)

    def _make_threshold(self, wanted: protocol.Threshold) -> None:
        try:
            self.segments.threshold(wanted)
        except (PalpateError, RuntimeError) as error:
            self._from_threads.put(protocol.Notice(level="error", text=str(error)))


async def _receive(websocket: WebSocket) -> bytes:
    """Returns the next message of a page; a text counts as one, which is never understood."""
    message = await websocket.receive()
    if message["type"] == "websocket.disconnect":
        raise WebSocketDisconnect(message["code"])
    return message.get("bytes") or (message.get("text") or "").encode()
