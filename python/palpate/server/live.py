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
from palpate.saved.kept_with_scan import KeptWithScan
from palpate.server.closing import ENDED, STOOD_STILL, TOO_MANY, close_all, end_all
from palpate.server.messages.engine_pictures import EnginePictures
from palpate.server.messages.kept import KeptMessages
from palpate.server.messages.outbox import Missed, Outbox
from palpate.server.messages.painting import Outlines, Painter
from palpate.server.messages.picture import (
    EditPace,
    PublishedPicture,
    change_messages,
    label_messages,
)
from palpate.server.messages.registration import RegistrationMessages
from palpate.server.messages.segment_list import SegmentList
from palpate.server.messages.segment_work import SegmentWork, ThresholdJobs
from palpate.server.messages.segments import GapWatch, SegmentMessages
from palpate.server.messages.session import Recovery, SessionMessages
from palpate.server.messages.soft_tissue import ModelParts, SoftTissueMessages
from palpate.server.messages.table import MessageTable
from palpate.server.messages.touch import PublishedNeedle, TouchMessages
from palpate.server.page_words import page_words
from palpate.server.recording import Recorder
from palpate.server.second_scan import second_message
from palpate.server.standstill import Standstill
from palpate.session.session import Session
from palpate.volumes.second_scan import SecondScan

__all__ = ["MOST_PAGES", "Live"]

STATES_HZ = 60.0
"""States a second while pages look."""
PATIENCE = 0.1
"""Seconds that a thread waits for changes: so long may it outlive the server. Also how long pages
have to take what was told before the end of the session."""
GOODBYE = 5.0
"""Seconds that pages have at most to take leave: one on a busy machine may be late."""
KEEPING_PAUSE = 0.5
"""Seconds after which a change of what is kept with the scan is on disk: a drag has many."""
MOST_PAGES = 64
"""Pages that one session is shown on."""
IDLE_HZ = 5.0
"""States a second while none does: enough for notices and counters."""


class Live:
    """Publishes the state of a session to its pages, and has their messages handled."""

    def __init__(
        self,
        session: Session,
        hello: protocol.Hello,
        recorder: Recorder,
        *,
        journal: Journal | None = None,
        looks: bytes | None = None,
        kept: KeptWithScan | None = None,
    ) -> None:
        """Shows a session; ``hello`` is the first message to each page.

        ``looks`` are those of a scene that was opened; ``kept`` is what is kept with the scan.
        """
        self._from_threads: SimpleQueue[protocol.ToPage] = SimpleQueue()
        publish = self._from_threads.put
        self.session = session
        self.recorder = recorder
        self.journal = journal
        self.segments = SegmentList(session, None if journal is None else journal.note)
        if looks is not None:
            self.segments.restore(looks)
        self._recovery = Recovery(
            journal, self.segments, show_second=self.show_second, publish=publish
        )
        self._recovery.restore_appearances()
        self._hello = hello
        self.picture = PublishedPicture(session.scene.volume.array)
        self._needle = PublishedNeedle(session)
        self._outboxes: set[Outbox] = set()
        self.kept = KeptWithScan(session.scene) if kept is None else kept
        self._kept_messages = KeptMessages(self.kept, self._outboxes)
        self._sockets: set[WebSocket] = set()
        self._serving: set[asyncio.Task[None]] = set()
        self._standstill = Standstill()
        self._greeting_pages_anew: asyncio.Task[None] | None = None
        self._scene_of_now: object = None
        self._second = second_message(session.scene.volume, session.scene.second, version=0)
        # subjects of messages
        self._segment_work = SegmentWork(session, self.segments, publish)
        self._thresholds = ThresholdJobs(self._make_threshold, elsewhere=self._segment_work.takes)
        self._painter = Painter(session)
        self._pace = EditPace(session)
        self._parts = ModelParts(session)
        self.engine_pictures = EnginePictures(session)
        self._gaps = GapWatch(session, publish)
        self._touch = TouchMessages(session, hello.settings, publish)
        self.registration = RegistrationMessages(session, show=self.show_second, publish=publish)
        self.table = MessageTable(
            self._touch,
            self._thresholds,
            self._segment_work,
            self._painter,
            Outlines(session.scene.volume),
            self._pace,
            self._parts,
            self.engine_pictures,
            SoftTissueMessages(session),
            self._kept_messages,
            SegmentMessages(session, self.segments, self._gaps, publish=publish),
            SessionMessages(
                session,
                painter=self._painter,
                recorder=recorder,
                recovery=self._recovery,
                publish=publish,
                flush=self._publish_from_threads,
            ),
            self.registration,
        )
        """Who handles what pages ask."""
        self.table.check()

    async def run(self) -> None:
        """Tells all pages what is, until it is cancelled or the session ends by itself."""
        beside = [
            asyncio.create_task(self._thresholds.run(), name="making thresholds"),
            asyncio.create_task(self._segment_work.run(), name="working on segments"),
            asyncio.create_task(
                self._gaps.run(lambda: self._scene_of_now), name="measuring the gap"
            ),
            asyncio.create_task(self._follow_changes(), name="following changes"),
            asyncio.create_task(self._write_kept(), name="keeping marks and looks"),
            asyncio.create_task(self._settle_labels(), name="comparing segments"),
        ]
        for task in beside:
            task.add_done_callback(self._tell_failure)
        try:
            while self._publish_state():
                self._beat()
                await asyncio.sleep(1.0 / (STATES_HZ if self._outboxes else IDLE_HZ))
            # what was told last, which may say why, goes out first
            await asyncio.sleep(PATIENCE)
            await self.send_away(ENDED, "the session has ended")
        finally:
            self._segment_work.stop()
            self.registration.stop()
            await end_all(beside)

    async def serve(self, websocket: WebSocket) -> None:
        """Serves one page until it leaves."""
        serving = asyncio.ensure_future(self._serve(websocket))
        self._serving.add(serving)
        serving.add_done_callback(self._serving.discard)
        await serving

    async def _serve(self, websocket: WebSocket) -> None:
        await websocket.accept()
        if not self.session.is_running:
            await websocket.close(ENDED, "the session has ended")
            return
        if len(self._outboxes) >= MOST_PAGES:
            reason = f"{MOST_PAGES} pages show this scan; allowed: fewer, so close one"
            await websocket.close(TOO_MANY, reason)
            return
        # it knows no surface yet; the voxels it asks for
        is_near = websocket.client is not None and websocket.client.host in {"127.0.0.1", "::1"}
        outbox = Outbox(missed=Missed(), is_near=is_near)
        self._greet(outbox)
        self._outboxes.add(outbox)
        self._touch.join(outbox)
        self._sockets.add(websocket)
        sender = asyncio.create_task(self._send(websocket, outbox))
        try:
            while True:
                packed = await _receive(websocket)
                self._beat()
                # one that was sent away is read to its end, and not listened to
                if outbox in self._outboxes:
                    await self._take(packed, outbox)
        except WebSocketDisconnect:
            pass
        finally:
            self._outboxes.discard(outbox)
            self._touch.part(outbox)
            self._sockets.discard(websocket)
            self._pace.leave(outbox)
            self._parts.leave(outbox)
            self.engine_pictures.leave(outbox)
            if not self._outboxes:
                # nobody looks at the gap any more, nor lets go of what is in the hand
                self._gaps.choose(None)
                with suppress(PalpateError, RuntimeError):
                    await asyncio.to_thread(self.session.grab, None)
                    await asyncio.to_thread(self.session.clutch, on=False)
            sender.cancel()
            with suppress(PalpateError, RuntimeError):
                await asyncio.to_thread(self._painter.leave, outbox)
            await asyncio.to_thread(self._touch.leave, outbox)

    def _greet(self, outbox: Outbox) -> None:
        """Tells a page that was opened what is."""
        outbox.put(
            msgspec.structs.replace(
                self._hello,
                kept=self._kept_messages.message,
                segments=self.segments.message.segments,
                settings=self._touch.settings,
            )
        )
        outbox.put(self.segments.message)
        if self._touch.clip.planes:
            outbox.put(self._touch.clip)
        if self._second.scan is not None:
            outbox.put(self._second)
            outbox.put(self.registration.message)
        for message in (*self._recovery.messages(), *self._segment_work.previews()):
            outbox.put(message)

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
        self._second = second_message(scene.volume, second, version=version)
        if self.journal is not None:
            self.journal.note_second(second)
        self._from_threads.put(self._second)
        self.registration.follow(second)

    async def send_away(self, code: int, reason: str) -> None:
        """Closes the connections of all pages, and waits a moment until they have heard why.

        A server that ends sooner takes the reason with it.
        """
        await close_all(self._forget_pages(), code, reason)
        if self._serving:
            await asyncio.wait(self._serving, timeout=GOODBYE)

    def _forget_pages(self) -> set[WebSocket]:
        """Listens to no page any more; returns their connections."""
        sockets, self._sockets = self._sockets, set()
        self._outboxes.clear()
        return sockets

    def _tell_failure(self, task: asyncio.Task[None]) -> None:
        """Tells pages that what is done beside the event loop is done no more."""
        if not task.cancelled() and (error := task.exception()) is not None:
            text = f"{task.get_name()} has failed ({error}). Restart Palpate"
            self._publish(protocol.Notice(level="error", text=text[:1].upper() + text[1:]))

    def _beat(self) -> None:
        """Sends all pages away to be greeted anew, where this process stood still.

        What they asked meanwhile goes with their connections.
        """
        seconds = self._standstill.beat()
        if seconds > 0.0:
            self._greeting_pages_anew = asyncio.create_task(
                close_all(self._forget_pages(), STOOD_STILL, f"{seconds:.0f}")
            )

    # --- to pages -------------------------------------------------------------------------

    def _publish(self, message: protocol.ToPage) -> None:
        for outbox in self._outboxes:
            outbox.put(message)

    def _publish_from_threads(self) -> None:
        while not self._from_threads.empty():
            self._publish(self._from_threads.get())

    def _publish_state(self) -> bool:
        """Tells what is now and what changed; False where the session has ended."""
        frame = self.session.frame()
        for level, text in frame["notices"]:
            self._publish(protocol.Notice(level=level, text=text))
        self._publish_from_threads()
        if not self.session.is_running:
            return False
        self._scene_of_now = (frame["edit"], frame["poses"])
        versions, voxels = frame["segments_version"], frame["voxels_version"]
        if self.segments.refresh(
            versions, voxels_version=voxels, pending=frame["pending"], edit=frame["edit"]
        ):
            self._publish(self.segments.message)
            for text in self.segments.take_notices():
                self._publish(protocol.Notice(level="info", text=text))
        self._publish_changes()
        needle = self._needle.message(frame["needle"]["events"])
        if needle is not None:
            self._publish(needle)
        try:
            fields = protocol.State.__struct_fields__
            told = {name: value for name, value in frame.items() if name in fields}
            state = msgspec.convert(told, protocol.State)
        except msgspec.ValidationError as error:
            self._publish(
                protocol.Notice(level="error", text=f"the engine is out of order: {error}")
            )
            return False
        self._publish(state)
        self._parts.publish()
        return True

    async def _follow_changes(self) -> None:
        """Tells changes of voxels and surfaces as soon as they are made."""
        heard = 0
        while True:
            heard = await asyncio.to_thread(self.session.wait_for_changes, heard, PATIENCE)
            self._publish_changes()

    async def _write_kept(self) -> None:
        """Writes what pages have changed of what is kept with the scan, a moment later."""
        while True:
            await asyncio.sleep(KEEPING_PAUSE)
            await asyncio.to_thread(self.kept.write)

    async def _settle_labels(self) -> None:
        """Finds out whether pages need other labels, where segments came before others."""
        while True:
            if self.segments.is_unsure_of_labels:
                # a session that has ended, or a segment that has gone meanwhile
                with suppress(PalpateError, RuntimeError):
                    await asyncio.to_thread(self.segments.labels)
            await asyncio.sleep(1.0 / (STATES_HZ if self._outboxes else IDLE_HZ))

    def _publish_changes(self) -> None:
        for change in self.session.picture_changes():
            for message in change_messages(change):
                self.picture.take(message)
                self._publish(message)

    async def _send(self, websocket: WebSocket, outbox: Outbox) -> None:
        """Sends the messages of a page as fast as it takes them."""
        # a page that leaves is noticed where its messages are received
        with suppress(WebSocketDisconnect, RuntimeError):
            while True:
                waiting = await outbox.next()
                if isinstance(waiting, Missed):
                    async for message in self._missed_messages(waiting):
                        await websocket.send_bytes(protocol.encode_to_page(message))
                else:
                    await websocket.send_bytes(waiting)

    async def _missed_messages(self, missed: Missed) -> AsyncIterator[protocol.Changed]:
        """Yields what a page has missed, as it is now.

        Changes that are published meanwhile come after it, and the later ones hold in the end.
        """
        edit = self.picture.edit
        whole = await asyncio.to_thread(self.session.whole_surfaces)
        for message in self.picture.surface_messages(whole, edit=edit):
            yield message
        for message in self.picture.value_messages(missed.stored, edit=edit):
            yield message
        if not missed.labels.is_empty:
            with suppress(
                PalpateError, RuntimeError
            ):  # a session that has ended has no more voxels
                labels = await asyncio.to_thread(self.segments.labels)
                for message in label_messages(missed.labels, labels, edit=edit):
                    yield message

    # --- from pages -----------------------------------------------------------------------

    async def _take(self, packed: bytes, outbox: Outbox) -> None:
        """Has a message handled; a failure becomes a notice for its page."""
        try:
            await self.table.handle(protocol.decode_from_page(packed), outbox)
        except msgspec.DecodeError as error:
            outbox.put(protocol.Notice(level="error", text=f"message not understood: {error}"))
        except (PalpateError, OSError, RuntimeError) as error:
            outbox.put(protocol.Notice(level="error", text=page_words(str(error))))

    def _make_threshold(self, wanted: protocol.Threshold) -> None:
        try:
            self.segments.threshold(wanted)
        except (PalpateError, RuntimeError) as error:
            self._from_threads.put(protocol.Notice(level="error", text=page_words(str(error))))


async def _receive(websocket: WebSocket) -> bytes:
    """Returns the next message of a page; a text counts as one, which is never understood."""
    message = await websocket.receive()
    if message["type"] == "websocket.disconnect":
        raise WebSocketDisconnect(message["code"])
    return message.get("bytes") or (message.get("text") or "").encode()
