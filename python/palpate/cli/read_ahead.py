"""A scan that is read while the program still imports what shows it."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from threading import Thread
from typing import Generic, TypeVar

from palpate.base.progress import Progress, silent

__all__ = ["ReadAhead"]

Result = TypeVar("Result")


class ReadAhead(Generic[Result]):
    """Work in a thread of its own; its progress goes to whoever waits for the result."""

    def __init__(self, work: Callable[[Progress], Result]) -> None:
        """Begins the work.

        Args:
            work: Takes its progress; what it raises is raised by ``result``.
        """
        self._work = work
        self._progress: Progress = silent
        self._result: Future[Result] = Future()
        # the end of the process need not wait for it
        Thread(target=self._run, daemon=True).start()

    def result(self, progress: Progress) -> Result:
        """Waits for the result; an exception of ``progress`` ends the work."""
        self._progress = progress
        return self._result.result()

    def _run(self) -> None:
        try:
            self._result.set_result(self._work(self._told))
        except BaseException as error:  # noqa: BLE001  # whoever waits is told
            self._result.set_exception(error)

    def _told(self, what: str, share: float | None, /) -> None:
        self._progress(what, share)
