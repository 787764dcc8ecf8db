"""Messages on the session: undo, recordings, fences, and what an earlier session left."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from palpate import protocol
from palpate.base.errors import PalpateError
from palpate.saved.journal import Journal
from palpate.server.messages.outbox import Outbox
from palpate.server.messages.painting import Painter
from palpate.server.messages.segment_list import SegmentList
from palpate.server.messages.table import MessageTable, Runs
from palpate.server.recording import Recorder
from palpate.session.session import Session
from palpate.volumes.second_scan import SecondScan

__all__ = ["Recovery", "SessionMessages"]


class Recovery:
    """Changes that an earlier session left in the journal: pages bring them back or not."""

    def __init__(
        self,
        journal: Journal | None,
        segments: SegmentList,
        *,
        show_second: Callable[[SecondScan | None], None],
        publish: Callable[[protocol.ToPage], None],
    ) -> None:
        """Takes the journal, what shows a second scan, and what publishes to all pages."""
        self._journal = journal
        self._segments = segments
        self._show_second = show_second
        self._publish = publish

    def messages(self) -> Iterator[protocol.ToPage]:
        """Yields what is published to a page that connects."""
        if self._journal is not None:
            yield protocol.Recovery(_offer_of(self._journal))
            if self._journal.problem is not None:
                yield protocol.Notice(level="warning", text=self._journal.problem)

    def decide(self, *, bring_back: bool) -> None:
        """Brings back what an earlier session left, or keeps it aside, and publishes that."""
        if self._journal is None or self._journal.offer is None:
            return
        self._journal.decide(bring_back=bring_back)
        self.restore_appearances()
        if self._journal.second is not None:
            self._show_second(self._journal.second)
        if self._journal.lost_second is not None:
            self._publish(protocol.Notice(level="warning", text=self._journal.lost_second))
        self._publish(protocol.Recovery(None))
        if self._journal.problem is not None:
            self._publish(protocol.Notice(level="warning", text=self._journal.problem))

    def restore_appearances(self) -> None:
        """Gives segments the appearance that the journal has; without any, keeps theirs in it."""
        if self._journal is None or not self._journal.is_running:
            return
        if self._journal.looks is not None:
            try:
                self._segments.restore(self._journal.looks)
            except PalpateError as error:
                self._publish(protocol.Notice(level="warning", text=str(error)))
        else:
            self._segments.keep()


class SessionMessages:
    """Does what pages ask of the session as a whole."""

    def __init__(
        self,
        session: Session,
        *,
        painter: Painter,
        recorder: Recorder,
        recovery: Recovery,
        publish: Callable[[protocol.ToPage], None],
        flush: Callable[[], None],
    ) -> None:
        """Takes what undo, recordings and recovery need.

        ``publish`` publishes to all pages from any thread; ``flush``, which is called on the event
        loop, brings what was published so far into their outboxes.
        """
        self._session = session
        self._painter = painter
        self._recorder = recorder
        self._recovery = recovery
        self._publish = publish
        self._flush = flush

    def add_to(self, table: MessageTable) -> None:
        """Adds the rows of the session."""
        table.add(protocol.Undo, self._undo, runs=Runs.IN_ORDER)
        table.add(protocol.Redo, self._redo, runs=Runs.IN_ORDER)
        table.add(protocol.RecordSession, self._record, runs=Runs.IN_ORDER)
        table.add(protocol.Recover, self._recover, runs=Runs.IN_ORDER)
        table.add(protocol.Fence, self._fence, runs=Runs.ON_LOOP)

    def _undo(self, _message: protocol.Undo, _: Outbox) -> None:
        self._painter.end()
        self._session.undo()

    def _redo(self, _message: protocol.Redo, _: Outbox) -> None:
        self._painter.end()
        self._session.redo()

    def _record(self, message: protocol.RecordSession, _: Outbox) -> None:
        if message.on:
            self._recorder.start()
        else:
            summary = self._recorder.stop()
            self._publish(protocol.Notice(level="info", text=f"Recorded {summary}."))

    def _recover(self, message: protocol.Recover, _: Outbox) -> None:
        self._recovery.decide(bring_back=message.bring_back)

    def _fence(self, message: protocol.Fence, page: Outbox) -> None:
        # messages of a page are done one after another: answers go before
        self._flush()
        page.put(protocol.Passed(message.number, tick=self._following_tick()))

    def _following_tick(self) -> int:
        """Returns the first tick that follows every command given to the session until now."""
        # one has begun and may be past its commands; the next one takes them
        ticks: int = self._session.lateness()["servo"]["ticks"]
        return ticks + 1


def _offer_of(journal: Journal) -> protocol.Offer | None:
    offer = journal.offer
    if offer is None:
        return None
    when = offer.when.isoformat(timespec="seconds")
    return protocol.Offer(
        steps=offer.steps, when=when, lost_bytes=offer.lost_bytes, second=offer.second
    )
