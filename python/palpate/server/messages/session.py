"""What an earlier session left, as pages are asked about it and told of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from palpate import protocol
from palpate.base.errors import PalpateError
from palpate.saved.journal import Journal
from palpate.server.messages.segment_list import ShownSegments
from palpate.volumes.second_scan import SecondScan

__all__ = ["Recovering"]


class Recovering:
    """The journal of a session, as pages see it."""

    def __init__(
        self,
        journal: Journal | None,
        segments: ShownSegments,
        *,
        show_second: Callable[[SecondScan | None], None],
        tell: Callable[[protocol.ToPage], None],
    ) -> None:
        """Takes the journal, and what shows the things that it brings back."""
        self._journal = journal
        self._segments = segments
        self._show_second = show_second
        self._tell = tell

    def messages(self) -> Iterator[protocol.ToPage]:
        """Yields what a page is told that comes."""
        if self._journal is not None:
            yield protocol.Recovery(_offer_of(self._journal))
            if self._journal.problem is not None:
                yield protocol.Notice(level="warning", text=self._journal.problem)

    def decide(self, *, bring_back: bool) -> None:
        """Brings back what an earlier session left, or keeps it aside, and tells pages so."""
        if self._journal is None or self._journal.offer is None:
            return
        self._journal.decide(bring_back=bring_back)
        self.restore_looks()
        if self._journal.second is not None:
            self._show_second(self._journal.second)
        if self._journal.lost_second is not None:
            self._tell(protocol.Notice(level="warning", text=self._journal.lost_second))
        self._tell(protocol.Recovery(None))
        if self._journal.problem is not None:
            self._tell(protocol.Notice(level="warning", text=self._journal.problem))

    def restore_looks(self) -> None:
        """Has segments look as the journal says, or keeps there how they look."""
        if self._journal is None or not self._journal.is_running:
            return
        if self._journal.looks is not None:
            try:
                self._segments.restore(self._journal.looks)
            except PalpateError as error:
                self._tell(protocol.Notice(level="warning", text=str(error)))
        else:
            self._segments.keep()


def _offer_of(journal: Journal) -> protocol.Offer | None:
    offer = journal.offer
    if offer is None:
        return None
    when = offer.when.isoformat(timespec="seconds")
    return protocol.Offer(
        steps=offer.steps, when=when, lost_bytes=offer.lost_bytes, second=offer.second
    )
