"""Progress and errors on the command line: one line on stderr.

Progress is shown for work longer than a second, and only where stderr is a terminal.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from threading import Lock, Timer
from types import TracebackType
from typing import TYPE_CHECKING, Self

from palpate.base.harmless_text import HarmlessStream, harmless, terminal

if TYPE_CHECKING:
    from rich.progress import Progress as Bar

__all__ = [
    "WRONG_INPUT",
    "Display",
    "clear_line",
    "fail",
    "quiet_libraries",
    "replace_line",
    "spoken",
    "told_by",
    "warn",
]

QUIET_SECONDS = 1.0
"""Work shorter than this is not shown [s]."""

WRONG_INPUT = 2
"""Exit code for invalid input."""


_TELL: ContextVar[Callable[[str], str]] = ContextVar("_TELL", default=str)
"""Tells a message in the words of the command that runs."""


@contextmanager
def told_by(tell: Callable[[str], str]) -> Iterator[None]:
    """Within it, messages are told in other words, such as a command's."""
    before = _TELL.set(tell)
    try:
        yield
    finally:
        _TELL.reset(before)


def spoken(message: str) -> str:
    """Returns a message in the words of the command that runs."""
    return _TELL.get()(message)


def fail(message: str) -> int:
    """Prints an error in one line; returns the exit code."""
    clear_line()
    sys.stderr.write(f"palpate: {_one_line(spoken(message))}\n")
    return WRONG_INPUT


def warn(message: str) -> None:
    """Prints a warning in one line."""
    clear_line()
    sys.stderr.write(f"palpate: warning: {_one_line(spoken(message))}\n")


def _one_line(message: str) -> str:
    """Returns a message without line breaks and control characters."""
    return harmless(" ".join(message.split()))


class _Line:
    """A terminal's last line."""

    replaceable = False
    """Whether a text stands there that the next one replaces."""


def replace_line(text: str, *, last: bool) -> None:
    """Shows a text on a terminal's last line, in place of what stands there."""
    _order(f"\r{_one_line(text)}\x1b[K" + ("\n" if last else ""))
    _Line.replaceable = not last


def clear_line() -> None:
    """Takes away what ``replace_line`` shows, so that other words begin the line."""
    if _Line.replaceable:
        _order("\r\x1b[K")
        _Line.replaceable = False


def _order(text: str) -> None:
    """Writes what moves a terminal's cursor."""
    # which is taken out of what others write
    stream = getattr(sys.stderr, "rich_proxied_file", sys.stderr)
    stream.write(text)
    stream.flush()


@contextmanager
def quiet_libraries() -> Iterator[None]:
    """Keeps messages of image libraries off stderr; those of Palpate are still shown."""
    shown = sys.stderr
    shown.flush()
    kept = os.dup(2)
    try:
        with (
            Path(os.devnull).open("wb") as nothing,
            os.fdopen(os.dup(2), "w", buffering=1) as ours,
        ):
            os.dup2(nothing.fileno(), 2)
            sys.stderr = HarmlessStream.over(ours)
            yield
    finally:
        sys.stderr = shown
        os.dup2(kept, 2)
        os.close(kept)


class Display:
    """Shows progress as a line with a bar, once a second has passed."""

    def __init__(self) -> None:
        """Shows nothing yet."""
        self._lock = Lock()
        self._bar: Bar | None = None
        self._ended = False
        self._now: tuple[str, float | None] = ("", None)
        self._timer = Timer(QUIET_SECONDS, self._show)
        self._timer.daemon = True

    def __enter__(self) -> Self:
        self._timer.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._timer.cancel()
        with self._lock:
            # the timer may be on its way already
            self._ended = True
            if self._bar is not None:
                self._bar.stop()

    def __call__(self, what: str, share: float | None, /) -> None:
        """Takes what is being done and which fraction of it is done."""
        with self._lock:
            self._now = (what, share)
            self._update()

    def _update(self) -> None:
        # before its width is measured
        what, share = harmless(self._now[0]), self._now[1]
        if self._bar is not None:
            total = None if share is None else 1.0
            task = self._bar.task_ids[0]
            self._bar.update(task, description=what, total=total, completed=share or 0.0)

    def _show(self) -> None:
        from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn

        console = terminal(stderr=True)
        with self._lock:
            if self._ended:
                return
            self._bar = Progress(
                SpinnerColumn(),
                TextColumn("{task.description}", markup=False),
                BarColumn(),
                console=console,
                transient=True,
                disable=not console.is_terminal,
            )
            self._bar.add_task(self._now[0], total=None)
            self._update()
            self._bar.start()
