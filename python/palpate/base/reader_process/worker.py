"""The worker: ``python -m palpate.base.reader_process.worker``, which reads for another process.

It ends with that process: when the pipe of requests closes, whatever it is doing then.
"""

from __future__ import annotations

import os
import pickle
import signal
import sys
import tempfile
import traceback
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from os import PathLike
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Thread
from time import monotonic
from typing import Any

from palpate.base.errors import PalpateError
from palpate.base.files_read import files_noted, note_read
from palpate.base.reader_process.channel import Sender, receive
from palpate.base.reader_process.exchange import packed
from palpate.base.reader_process.limits import BUSY, begin, end

__all__ = ["main"]

NEEDED = ("numpy", "palpate.io.scan_at")
"""Modules that most requests need."""
LIKELY = ("SimpleITK", "pydicom", "nibabel")
"""Modules that some need, imported once nothing was asked for a while."""
QUIET = 0.5
"""Such a while [s]."""
SELDOM = 0.05
"""Between two reports of the same work [s]."""

Request = dict[str, Any]


def main() -> None:
    """Answers requests until there are no more."""
    # Ctrl-C is for the process that asked
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # what libraries print must not come between messages
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    tell = Sender(answers)
    requests: SimpleQueue[Request] = SimpleQueue()
    Thread(target=_listen, args=(requests,), daemon=True).start()
    for module in NEEDED:
        import_module(module)
    likely = [] if BUSY in sys.argv else [*LIKELY]
    sys.addaudithook(_note_opened)
    while True:
        try:
            _answer(requests.get(timeout=QUIET if likely else None), tell)
        except Empty:
            # a request that needs it is told what is wrong with it
            with suppress(Exception):
                import_module(likely.pop(0))


def _listen(requests: SimpleQueue[Request]) -> None:
    listened = os.fdopen(os.dup(0), "rb")
    while (request := receive(listened)) is not None:
        requests.put(request)  # type: ignore[arg-type]  # of our own pool
    os._exit(0)


def _note_opened(event: str, arguments: tuple[Any, ...]) -> None:
    """Notes each file that Python opens for reading; what a call unpacks goes with it."""
    if event != "open":
        return
    path, mode, _ = arguments
    # the other kinds are files that are open already
    is_read = isinstance(path, str | PathLike) and (mode is None or mode.startswith("r"))
    if is_read and not str(path).startswith(tempfile.tempdir or os.sep):
        note_read(Path(path))


def _answer(request: Request, tell: Sender) -> None:
    try:
        if request["folder"] is not None:
            os.chdir(request["folder"])
        tempfile.tempdir = request["scratch"]
        function, arguments, options = pickle.loads(request["call"])  # noqa: S301
        if request["reports"]:
            options["progress"] = _progress(tell)
        begin(tell, file_bytes=request["file_bytes"])
        with files_noted() as read:
            result = function(*arguments, **options)
            if request["each"]:
                for item in result:
                    tell(("item", item))
                result = None
        # what is sent may be as large as it is
        end()
        tell(("read", read))
        tell(("done", *packed(result, request["shared"])))
    except (PalpateError, OSError, MemoryError) as error:
        end()
        tell(("failed", _plain(error)))
    except BaseException as error:  # noqa: BLE001  # whatever it is, it is told
        end()
        tell(("broken", f"{type(error).__name__}: {error}", traceback.format_exc()))


def _progress(tell: Sender) -> Callable[[str, float | None], None]:
    last, when = "", 0.0

    def progress(what: str, share: float | None, /) -> None:
        nonlocal last, when
        now = monotonic()
        if what != last or now - when > SELDOM:
            last, when = what, now
            tell(("progress", what, share))

    return progress


def _plain(error: Exception) -> Exception:
    """Returns an error that can be sent: its own text is what matters."""
    try:
        pickle.loads(pickle.dumps(error))  # noqa: S301
    except Exception:  # noqa: BLE001  # of any library
        return OSError(str(error))
    return error


if __name__ == "__main__":
    main()
