"""Closing the connections of pages, with codes that tell them why, and ending tasks.

One that fails holds up none of the others.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Iterable

from starlette.websockets import WebSocket, WebSocketDisconnect

__all__ = ["ENDED", "EXCHANGED", "STOOD_STILL", "TOO_MANY", "close_all", "end_all"]

EXCHANGED = 4001
"""Code with which pages of a scan are sent away that makes room for another."""
STOOD_STILL = 4002
"""Code with which pages are sent away, to come again at once, whose messages are too old to be
done; the reason is how many seconds the process stood still."""
ENDED = 4003
"""Code with which pages are sent away whose session has ended, or whose server is being stopped."""
TOO_MANY = 1013
"""Code with which a page is turned away while many others are open: "try again later"."""

_log = logging.getLogger(__name__)


async def close_all(websockets: Iterable[WebSocket], code: int, reason: str) -> None:
    """Closes the connections of pages at the same time: one may be slow, or gone already."""
    closings = [websocket.close(code, reason) for websocket in websockets]
    for outcome in await asyncio.gather(*closings, return_exceptions=True):
        # starlette says so of one that is gone
        if not isinstance(outcome, RuntimeError | WebSocketDisconnect):
            _tell("closing the connection of a page", outcome)


async def end_all(tasks: Iterable[asyncio.Task[None]]) -> None:
    """Cancels tasks and waits until all of them have ended; what went wrong in one is logged."""
    ending = list(tasks)
    for task in ending:
        task.cancel()
    outcomes = await asyncio.gather(*ending, return_exceptions=True)
    for task, outcome in zip(ending, outcomes, strict=True):
        _tell(task.get_name(), outcome)


def _tell(what: str, outcome: object) -> None:
    """Logs what went wrong, if something did; being cancelled is not wrong."""
    if isinstance(outcome, Exception):
        _log.error("%s failed", what, exc_info=outcome)
