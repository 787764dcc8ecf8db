"""A scan that is still being read while pages are served: how far it is, and how that ended."""

from __future__ import annotations

from collections.abc import Callable
from threading import Event
from typing import TYPE_CHECKING

from palpate.base.progress import Progress
from palpate.server.job import CancelledWorkError

if TYPE_CHECKING:
    from palpate.server.open_scan import OpenScan

__all__ = ["LoadingScan"]

SURE = ("reading", "making")
"""First words of the progress of reading values: files that hold no scan have failed before."""

LOOK_SECONDS = 0.1
"""Interval between progress reports to a page that waits [s]."""


class LoadingScan:
    """A scan that one thread reads and others follow."""

    def __init__(self, name: str, begin: Callable[[Progress], OpenScan]) -> None:
        """Takes what a person calls the scan, and what reads it and begins its session."""
        self.name = name
        self.failure: Exception | None = None
        """Why there is none; to be read once it has ended."""
        self._begin = begin
        self._now: tuple[str, float | None] = ("", None)
        self._recognised = Event()
        self._ended = Event()
        self._cancelled = Event()
        self._failure_shown = Event()

    def read(self) -> OpenScan | None:
        """Reads the scan; None where that failed or was cancelled."""
        try:
            return self._begin(self._report)
        except CancelledWorkError:
            return None
        except Exception as error:  # noqa: BLE001  # whoever waits raises it
            self.failure = error
            return None
        finally:
            self._ended.set()
            self._recognised.set()

    def cancel(self) -> None:
        """Has reading end as soon as it looks."""
        self._cancelled.set()

    def recognised(self) -> bool:
        """Waits until values are being read; says whether they are, or have been."""
        self._recognised.wait()
        return self.failure is None and not self._cancelled.is_set()

    def wait_until_failure_shown(self, seconds: float) -> None:
        """Waits at most so long [s] until a page has shown the failure."""
        self._failure_shown.wait(seconds)

    def follow(self, progress: Progress) -> None:
        """Reports how far it is until it has ended.

        Raises:
            Exception: Why there will be no scan, as reading raised it.
        """
        while not self._ended.wait(LOOK_SECONDS):
            progress(*self._now)
        if self.failure is not None:
            self._failure_shown.set()
            raise self.failure

    def _report(self, what: str, share: float | None, /) -> None:
        if self._cancelled.is_set():
            raise CancelledWorkError
        self._now = what, share
        if what.startswith(SURE):
            self._recognised.set()
