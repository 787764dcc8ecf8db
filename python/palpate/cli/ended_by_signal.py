"""Signals that end a command as Ctrl-C does, so that what it keeps is kept and nothing is left.

SIGTERM comes where a system or a service ends it, SIGHUP where its terminal is closed.
"""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NoReturn

__all__ = ["signals_as_ctrl_c"]


@contextmanager
def signals_as_ctrl_c() -> Iterator[None]:
    """Has SIGTERM and SIGHUP raise ``KeyboardInterrupt``, once; to be used in the main thread."""
    hang_up = getattr(signal, "SIGHUP", None)
    numbers = [signal.SIGTERM]
    # who starts it with nohup wants it to go on
    if hang_up is not None and signal.getsignal(hang_up) is not signal.SIG_IGN:
        numbers.append(hang_up)

    def end(*_: object) -> NoReturn:
        # it ends already: more of them change nothing
        for each in numbers:
            signal.signal(each, signal.SIG_IGN)
        raise KeyboardInterrupt

    def close_terminal(*_: object) -> None:
        # what is printed from now on has no place any more
        nowhere = os.open(os.devnull, os.O_RDWR)
        for stream in (1, 2):
            os.dup2(nowhere, stream)
        os.close(nowhere)
        # a server that runs ends by this one in its own time
        signal.raise_signal(signal.SIGTERM)

    before = {each: signal.getsignal(each) for each in numbers}
    for each in numbers:
        signal.signal(each, close_terminal if each == hang_up else end)
    try:
        yield
    finally:
        for each, handler in before.items():
            signal.signal(each, handler)
