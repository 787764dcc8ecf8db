"""How long, and for how many, the server waits: connections that say nothing are let go.

Who is let in is known only once a request's head is there. Until then a connection costs
something and may be anybody's, so its time is limited, and when many wait, the oldest goes for
the newest: nobody can take all places away from the person's browser. Bodies may take long, but
must go on. Open pages are no concern of this: the browser answers pings of their WebSockets, also
for pages that are hidden.
"""

from __future__ import annotations

from asyncio import BaseTransport, TimerHandle

from uvicorn.protocols.http.h11_impl import H11Protocol

__all__ = ["PatientProtocol"]


class PatientProtocol(H11Protocol):
    """HTTP/1.1 for clients that say what they want."""

    HEAD_SECONDS = 15.0
    """How long the head of a request may take [s]."""
    BODY_SECONDS = 120.0
    """How long nothing of a body may come [s]: a folder on a slow network may be read there."""
    MOST_WAITING = 64
    """Connections whose requests have not come."""

    _deadline: TimerHandle | None = None
    _waits_for_head = False

    def connection_made(self, transport: BaseTransport) -> None:
        """Waits for a first request."""
        super().connection_made(transport)  # type: ignore[arg-type]  # as uvicorn narrows it
        self._watch()
        self._make_room()

    def data_received(self, data: bytes) -> None:
        """Takes what came."""
        super().data_received(data)
        self._watch()

    def on_response_complete(self) -> None:
        """Waits for the next request."""
        super().on_response_complete()
        self._watch()

    def connection_lost(self, exc: Exception | None) -> None:
        """Waits no longer."""
        self._wait(None)
        super().connection_lost(exc)

    def _make_room(self) -> None:
        """Lets go of who has waited longest, where too many wait."""
        others = (one for one in self.connections if isinstance(one, PatientProtocol))
        waiting = [one for one in others if one._waits_for_head]  # noqa: SLF001  # of this class
        if len(waiting) > self.MOST_WAITING:
            oldest = min(waiting, key=PatientProtocol._ends)
            # it no longer counts before it is closed
            oldest._wait(None)  # noqa: SLF001
            oldest.transport.close()

    def _watch(self) -> None:
        """Waits for what has to come next, if anything has to."""
        upgraded = self not in self.connections
        answered = self.cycle is None or self.cycle.response_complete
        if upgraded or self.transport.is_closing():
            self._wait(None)
        elif answered:
            # bytes that come meanwhile give no more time
            if not self._waits_for_head:
                self._wait(self.HEAD_SECONDS)
                self._waits_for_head = True
        else:
            self._wait(self.BODY_SECONDS if self.cycle.more_body else None)

    def _wait(self, seconds: float | None) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
        self._waits_for_head = False
        self._deadline = None if seconds is None else self.loop.call_later(seconds, self._give_up)

    def _give_up(self) -> None:
        if not self._waits_for_head and self.flow.read_paused:
            # what came is still being taken
            self._watch()
        else:
            self.transport.close()

    def _ends(self) -> float:
        return self._deadline.when() if self._deadline is not None else 0.0
