"""Calls of functions in a worker, and what is said where that does not survive them."""

from __future__ import annotations

import pickle
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic
from typing import Any, ParamSpec, TypeVar, cast

from palpate.base.errors import PalpateError, VolumeFormatError
from palpate.base.files_read import note_files, note_read
from palpate.base.progress import Progress
from palpate.base.reader_process import pool
from palpate.base.reader_process.exchange import shared_file, unpacked
from palpate.base.reader_process.limits import (
    PATIENCE,
    SECONDS_PER_BYTE,
    SECONDS_PER_VOXEL,
    inside,
    room_for,
)

__all__ = ["apart", "apart_each"]

LOOK_SECONDS = 0.1
"""Between two looks whether the work is still wanted [s]."""
MOST_NAMED = 3
"""Files in one message."""

Given = ParamSpec("Given")
Result = TypeVar("Result")


class _WorkerTracebackError(Exception):
    """Where a reader failed, for whoever mends it."""


def apart(
    function: Callable[..., Result],
    *given: Any,  # noqa: ANN401  # those of the function
    path: Path,
    progress: Progress | None = None,
    error: type[PalpateError] = VolumeFormatError,
    **options: Any,  # noqa: ANN401
) -> Result:
    """Calls a function of a module in a worker, and returns its result.

    Args:
        function: What to call; within a worker it is called as it is.
        given: Its arguments. They and the result can be pickled.
        path: What is read, for messages.
        progress: Takes the progress, which the function takes as ``progress``; by raising an
            exception it ends the worker.
        error: Raised where the worker does not survive.
        options: Keyword arguments of the function.

    Where this interpreter cannot be started again, as in some programs that embed it, the function
    is called here.

    Raises:
        PalpateError: As the function raises it, or because it ended the worker, hung or took too
            much memory.
    """
    # libraries that are not Python's open it unseen
    note_read(path)
    reported = {} if progress is None else {"progress": progress}
    if inside() or not sys.executable:
        return function(*given, **options, **reported)
    call = _Call(path, progress, error)
    for kind, result in call.messages((function, given, options), each=False):
        if kind == "done":
            return cast("Result", result)
    raise AssertionError("a worker ends with a result or an error")


def apart_each(
    function: Callable[..., Iterator[Result]],
    *given: Any,  # noqa: ANN401
    path: Path,
    progress: Progress | None = None,
    **options: Any,  # noqa: ANN401
) -> Iterator[Result]:
    """Yields what a generator function of a module yields in a worker; see ``apart``.

    Raises:
        PalpateError: As the function raises it, or because it ended the worker.
    """
    reported = {} if progress is None else {"progress": progress}
    if inside() or not sys.executable:
        yield from function(*given, **options, **reported)
        return
    call = _Call(path, progress, VolumeFormatError)
    for kind, result in call.messages((function, given, options), each=True):
        if kind == "item":
            yield cast("Result", result)


class _Call:
    """One call, and what is known of it."""

    def __init__(self, path: Path, progress: Progress | None, error: type[PalpateError]) -> None:
        self._path = path
        self._progress = progress
        self._error = error
        self._file_bytes = path.stat().st_size if path.is_file() else 0
        self._voxels = 0
        self._at: dict[int, str] = {}
        """Files that are being read."""

    def messages(
        self, call: tuple[Callable[..., Any], Sequence[Any], dict[str, Any]], *, each: bool
    ) -> Iterator[tuple[str, Any]]:
        """Yields items, and the result."""
        with (
            TemporaryDirectory(prefix="palpate-") as scratch,
            shared_file(scratch) as (descriptor, shared),
        ):
            worker = self._asked(
                {
                    "call": pickle.dumps(call, protocol=5),
                    "folder": _here(),
                    "scratch": scratch,
                    "shared": shared,
                    "file_bytes": self._file_bytes,
                    "reports": self._progress is not None,
                    "each": each,
                }
            )
            whole = False
            try:
                while not whole:
                    kind, *told = self._next(worker)
                    whole = kind in ("done", "failed", "broken")
                    if kind == "item":
                        yield kind, told[0]
                    elif kind == "done":
                        rest, places = told
                        yield kind, unpacked(rest, places, descriptor=descriptor)
                    else:
                        self._take(kind, told)
            finally:
                # a worker in the midst of something is no use to anybody
                if whole:
                    pool.give_back(worker)
                else:
                    worker.end()

    def _asked(self, request: dict[str, Any]) -> pool.Worker:
        """Returns a worker that has taken a request; one that waited may have ended meanwhile."""
        while True:
            worker = pool.take()
            try:
                worker.ask(request)
            except OSError:
                worker.end()
                continue
            return worker

    def _next(self, worker: pool.Worker) -> tuple[Any, ...]:
        """Returns what a worker tells next; lets whoever waits end it."""
        begun = monotonic()
        while True:
            try:
                message = worker.next(LOOK_SECONDS)
            except TimeoutError:
                if self._progress is not None:
                    self._progress(*self._said)
                if monotonic() - begun > self._patience:
                    raise self._error(
                        f"{self._what} kept its reader busy for {self._patience:.0f} s without "
                        "progress, and was given up; allowed: complete, undamaged files"
                    ) from None
                continue
            if message is None:
                raise self._error(_ended(self._what, worker.end()))
            return message

    _said: tuple[str, float | None] = ("opening", None)

    def _take(self, kind: str, told: list[Any]) -> None:
        """Notes what a worker tells.

        Raises:
            Exception: What the function raised.
        """
        if kind == "progress":
            what, share = told
            self._said = what, share
            if self._progress is not None:
                self._progress(what, share)
        elif kind == "read":
            note_files(told[0])
        elif kind == "expect":
            self._voxels = max(self._voxels, told[0])
        elif kind == "at":
            number, path, form = told
            self._at[number] = f"{path} ({form})"
        elif kind == "left":
            self._at.pop(told[0], None)
        elif kind == "failed":
            if isinstance(told[0], MemoryError):
                raise self._error(
                    f"{self._what} takes more than the {self._room / 2**30:.1f} GiB that its size "
                    "allows; allowed: complete, undamaged files"
                )
            raise told[0]
        elif kind == "broken":
            why, trace = told
            raise self._error(
                f"{self._what} cannot be read ({' '.join(why.split())[:200]}); allowed: complete, "
                "undamaged files"
            ) from _WorkerTracebackError(trace)

    @property
    def _what(self) -> str:
        """The file, or files, that are being read, and as what."""
        return " or ".join([*self._at.values()][:MOST_NAMED]) or str(self._path)

    @property
    def _room(self) -> int:
        return room_for(self._voxels, self._file_bytes)

    @property
    def _patience(self) -> float:
        return PATIENCE + SECONDS_PER_VOXEL * self._voxels + SECONDS_PER_BYTE * self._file_bytes


def _here() -> str | None:
    """Returns the folder of this process; None where it is gone."""
    try:
        return str(Path.cwd())
    except OSError:
        return None


def _ended(what: str, code: int) -> str:
    """Says how a worker ended."""
    try:
        how = f"by {signal.Signals(-code).name}" if code < 0 else f"with code {code}"
    except ValueError:
        how = f"by signal {-code}"
    return (
        f"{what} ended its reader {how}: it is damaged, or made to do harm; allowed: complete, "
        "undamaged files"
    )
