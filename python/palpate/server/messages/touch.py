"""What pages are told of a needle, besides its state: what happened to it."""

from __future__ import annotations

import msgspec

from palpate import protocol
from palpate.session.session import Session

__all__ = ["ToldNeedle"]

MOST = 100
"""Events that are told."""


class ToldNeedle:
    """The events of a session's needle, and how many of them pages know."""

    def __init__(self, session: Session) -> None:
        """Knows of none."""
        self._session = session
        self._known = 0

    def message(self, count: int) -> protocol.NeedleEvents | None:
        """Returns what pages are to be told where there were so many events; None if nothing."""
        if count == self._known:
            return None
        self._known = count
        events = self._session.needle_events()[-MOST:]
        return protocol.NeedleEvents(
            msgspec.convert(events, list[protocol.NeedleEvent], from_attributes=True)
        )
