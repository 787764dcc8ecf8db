"""The workbench: it holds at most one open scan, and exchanges it for another.

An ASGI application below ``/api`` that hands requests on to the scan that is open. The force of
the old scan is gone before anything of the new one begins; its pages are sent away with a code of
their own, and load themselves anew. The first scan may still be read while pages come: what they
ask of it waits.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from starlette.concurrency import run_in_threadpool
from starlette.responses import PlainTextResponse
from starlette.types import Receive, Scope, Send

from palpate.server.loading_scan import LoadingScan
from palpate.server.open_scan import OpenScan

__all__ = ["Workbench"]


class Workbench:
    """At most one open scan; all but ``end`` belongs to the event loop that serves it."""

    def __init__(
        self,
        opened: OpenScan | None = None,
        *,
        loading: LoadingScan | None = None,
        fixed: bool = False,
        rate: int = 1000,
        journalled: bool = True,
    ) -> None:
        """Begins with a scan, or without one.

        Args:
            opened: What is shown first.
            loading: What is shown first, once it is read.
            fixed: Whether that stays, as while it is recorded.
            rate: Servo ticks a second, for scans that are opened later.
            journalled: Whether their changes are kept on disk.
        """
        self.opened = opened
        self.loading = loading
        self.given_up: Callable[[], None] = lambda: None
        """Called where the first scan cannot be loaded."""
        self.page_seconds = 0.0
        """How long a page is waited for to show the failure of loading [s]."""
        self.fixed = fixed
        self.rate = rate
        self.journalled = journalled
        self._notices: list[str] = []
        self._exchange = asyncio.Lock()
        self._bringing: asyncio.Task[None] | None = None

    def notify(self, sentence: str) -> None:
        """Keeps a sentence for the next page that asks."""
        self._notices.append(sentence)

    def take_notices(self) -> list[str]:
        """Returns the sentences that no page was shown yet."""
        notices, self._notices = self._notices, []
        return notices

    async def start(self) -> None:
        """Begins to serve what is open, or to read what is to come."""
        if self.opened is not None:
            await self.opened.start()
        elif self.loading is not None:
            # until it is there, whoever asks for it waits
            await self._exchange.acquire()
            self._bringing = asyncio.create_task(self._bring(self.loading))

    async def _bring(self, loading: LoadingScan) -> None:
        try:
            self.opened = await run_in_threadpool(loading.read)
            if self.opened is not None:
                await self.opened.start()
                self.loading = None
        finally:
            self._exchange.release()
        if self.opened is None:
            if loading.failure is not None:
                await run_in_threadpool(loading.wait_until_failure_shown, self.page_seconds)
            self.given_up()

    async def stop(self) -> None:
        """Takes the force away and ends all messages."""
        if self.loading is not None:
            self.loading.cancel()
        async with self._exchange:
            if self.opened is not None:
                await self.opened.stop()

    def end(self) -> None:
        """Keeps what is kept of the open scan; to be called once nothing is served any more."""
        if self.opened is not None:
            self.opened.end()

    async def settled(self) -> OpenScan | None:
        """Returns what is open, once no exchange is under way."""
        async with self._exchange:
            return self.opened

    async def exchange(self, begin: Callable[[], OpenScan]) -> None:
        """Closes the open scan and begins another; nothing is open where that fails."""
        async with self._exchange:
            old, self.opened = self.opened, None
            if old is not None:
                await old.stop(exchanged=True)
                try:
                    await run_in_threadpool(old.end)
                except OSError as error:
                    # what cannot be kept of the old one does not hold the new one up
                    self.notify(f"Not all of {old.name} could be kept: {error}")
            opened = await run_in_threadpool(begin)
            await opened.start()
            self.opened = opened

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Hands a request on to the scan that is open."""
        opened = await self.settled()
        if opened is not None:
            await opened(scope, receive, send)
        elif scope["type"] == "websocket":
            # closed before it was accepted: the browser sees 403
            await receive()
            await send({"type": "websocket.close", "code": 1013, "reason": "no scan is open"})
        else:
            answer = PlainTextResponse("no scan is open. Open one first", status_code=409)
            await answer(scope, receive, send)
