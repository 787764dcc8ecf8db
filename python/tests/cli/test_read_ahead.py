"""Reading that begins before anybody waits for it."""

from __future__ import annotations

from threading import Event
from time import sleep

import pytest
from palpate.base.errors import VolumeFormatError
from palpate.base.progress import Progress, silent
from palpate.cli.read_ahead import ReadAhead


class CancelledError(Exception):
    """Raised by whoever waits."""


def test_progress_goes_to_whoever_waits_and_may_end_the_work() -> None:
    begun = Event()
    shown: list[str] = []

    def work(progress: Progress) -> int:
        begun.set()
        for _ in range(10_000):
            progress("reading", 0.5)
            sleep(0.001)
        return 7

    def progress(what: str, _: float | None, /) -> None:
        shown.append(what)
        raise CancelledError

    ahead = ReadAhead(work)
    # it runs before it is waited for
    assert begun.wait(10.0)
    with pytest.raises(CancelledError):
        ahead.result(progress)
    assert shown == ["reading"]


def test_what_the_work_raises_is_raised_where_it_is_waited_for() -> None:
    def work(_: Progress) -> int:
        raise VolumeFormatError("damaged; allowed: whole files")

    with pytest.raises(VolumeFormatError, match="damaged"):
        ReadAhead(work).result(silent)
    assert ReadAhead(lambda _: 7).result(silent) == 7
