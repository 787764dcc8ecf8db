"""Work that a page waits for: lines of JSON as it goes on, and an end when the page leaves.

The lines of one answer are objects with a ``kind``: ``progress`` as often as it moves, what the
work emits, and at last ``done`` or ``failed``. Whoever closes the connection cancels the work.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from threading import Event
from typing import Any

import msgspec
from starlette.concurrency import run_in_threadpool
from starlette.types import Receive, Scope, Send

from palpate.base.errors import PalpateError
from palpate.base.progress import Progress
from palpate.server.page_words import page_words

__all__ = ["CancelledWorkError", "Emit", "Job"]

Emit = Callable[[dict[str, Any]], None]
"""Takes a line for the page."""

Work = Callable[[Progress, Emit], None]


class CancelledWorkError(Exception):
    """The page that waited has left."""


class Job:
    """An ASGI answer: work in a thread, and the lines that it emits."""

    def __init__(self, work: Work) -> None:
        """Takes what is to be done; it is called once."""
        self._work = work
        self._cancelled = Event()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Does the work and answers, whatever was asked."""
        del scope
        loop = asyncio.get_running_loop()
        lines: asyncio.Queue[dict[str, Any] | None] = asyncio.Queue()

        def emit(line: dict[str, Any] | None) -> None:
            loop.call_soon_threadsafe(lines.put_nowait, line)

        await send(
            {
                "type": "http.response.start",
                "status": 200,
                "headers": [(b"content-type", b"application/x-ndjson")],
            }
        )
        watch = asyncio.create_task(self._watch(receive))
        work = asyncio.create_task(run_in_threadpool(self._run, emit))
        try:
            while (line := await lines.get()) is not None:
                body = msgspec.json.encode(line) + b"\n"
                await send({"type": "http.response.body", "body": body, "more_body": True})
            await work
            await send({"type": "http.response.body", "body": b"", "more_body": False})
        finally:
            self._cancelled.set()
            watch.cancel()

    async def _watch(self, receive: Receive) -> None:
        while (await receive())["type"] != "http.disconnect":
            pass
        self._cancelled.set()

    def _run(self, emit: Callable[[dict[str, Any] | None], None]) -> None:
        last: tuple[str, int | None] = ("", None)

        def progress(what: str, share: float | None, /) -> None:
            nonlocal last
            if self._cancelled.is_set():
                raise CancelledWorkError
            percent = None if share is None else int(100 * share)
            if (what, percent) != last:
                last = (what, percent)
                emit({"kind": "progress", "what": what, "share": share})

        try:
            self._work(progress, emit)
            emit({"kind": "done"})
        except CancelledWorkError:
            emit({"kind": "failed", "reason": "it was cancelled"})
        except MemoryError:
            reason = "not enough memory for this; allowed: a smaller scan, or a bigger machine"
            emit({"kind": "failed", "reason": reason})
        except (PalpateError, OSError, RuntimeError) as error:
            emit({"kind": "failed", "reason": _said(error)})
        finally:
            emit(None)


def _said(error: Exception) -> str:
    if isinstance(error, OSError) and error.strerror is not None:
        return page_words(f"{error.filename or 'the system'}: {error.strerror}")
    return page_words(str(error))
