"""Workers that wait for work: processes that are kept warm, and end with this one."""

from __future__ import annotations

import atexit
import os
import subprocess
from contextlib import suppress
from queue import Empty, SimpleQueue
from threading import Lock, Thread
from typing import Any

from palpate.base.own_process import own_process
from palpate.base.reader_process.channel import Sender, receive
from palpate.base.reader_process.limits import BUSY

__all__ = ["Worker", "give_back", "take", "warm"]

MOST_IDLE = 2
"""Workers that wait."""
LAST_SECONDS = 2.0
"""For a worker to end by itself [s]."""
SETTINGS = {
    # a process that reads multiplies no matrices, and few threads need little memory
    "OPENBLAS_NUM_THREADS": "1",
    "ITK_GLOBAL_DEFAULT_NUMBER_OF_THREADS": "8",
    "MALLOC_ARENA_MAX": "8",
}


class Worker:
    """One process, and what it sends."""

    def __init__(self, *arguments: str) -> None:
        """Starts it.

        Raises:
            OSError: No process can be started.
        """
        self._process = own_process(
            "palpate.base.reader_process.worker",
            arguments=arguments,
            settings=SETTINGS,
            answers=True,
        )
        assert self._process.stdin is not None  # noqa: S101  # it is a pipe
        self._send = Sender(self._process.stdin)
        self._messages: SimpleQueue[tuple[Any, ...] | None] = SimpleQueue()
        Thread(target=self._listen, daemon=True).start()

    @property
    def alive(self) -> bool:
        """Says whether it can be asked."""
        return self._process.poll() is None

    def ask(self, request: dict[str, Any]) -> None:
        """Sends a request.

        Raises:
            OSError: It has ended.
        """
        self._send(request)

    def next(self, seconds: float) -> tuple[Any, ...] | None:
        """Returns what it sends next; None where it has ended.

        Raises:
            TimeoutError: Nothing has come for so long.
        """
        try:
            return self._messages.get(timeout=seconds)
        except Empty:
            raise TimeoutError from None

    def end(self) -> int:
        """Ends it at once; returns its exit code, below 0 that of a signal."""
        # what has ended keeps its own code
        self._process.kill()
        return self._wait()

    def close(self) -> None:
        """Lets it end by itself."""
        with suppress(OSError):
            self._process.stdin.close()  # type: ignore[union-attr]  # it is a pipe
        try:
            self._process.wait(LAST_SECONDS)
        except subprocess.TimeoutExpired:
            self._process.kill()
        self._wait()

    def forget(self) -> None:
        """Leaves it to the process from which this one was forked."""
        self._process.returncode = 0
        for pipe in (self._process.stdin, self._process.stdout):
            with suppress(OSError, AttributeError):
                os.close(pipe.fileno())  # type: ignore[union-attr]  # they are pipes

    def _wait(self) -> int:
        code = self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            with suppress(OSError):
                pipe.close()  # type: ignore[union-attr]  # they are pipes
        return code

    def _listen(self) -> None:
        assert self._process.stdout is not None  # noqa: S101  # it is a pipe
        while (message := receive(self._process.stdout)) is not None:
            self._messages.put(message)  # type: ignore[arg-type]  # of our own worker
        self._messages.put(None)


class _Idle:
    """Those that wait, of this process."""

    workers: list[Worker] = []  # noqa: RUF012  # there is one list
    lock = Lock()


def take(*arguments: str) -> Worker:
    """Returns a worker that waits, or a new one with these arguments.

    Raises:
        OSError: No process can be started.
    """
    with _Idle.lock:
        while _Idle.workers:
            worker = _Idle.workers.pop()
            if worker.alive:
                return worker
            worker.close()
    return Worker(*arguments)


def give_back(worker: Worker) -> None:
    """Has a worker wait for more work."""
    with _Idle.lock:
        if len(_Idle.workers) < MOST_IDLE:
            _Idle.workers.append(worker)
            return
    worker.close()


def warm(*, idle: bool = True) -> None:
    """Starts a worker where none waits, so that the first file need not wait for it.

    Args:
        idle: Whether the machine is idle meanwhile: then it imports what only some files need.
    """
    with suppress(OSError):
        give_back(take() if idle else take(BUSY))


def _close_all() -> None:
    while _Idle.workers:
        _Idle.workers.pop().close()


def _forget_all() -> None:
    """Begins anew in a forked child: workers belong to its parent."""
    _Idle.lock = Lock()
    for worker in _Idle.workers:
        worker.forget()
    _Idle.workers = []


atexit.register(_close_all)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget_all)
