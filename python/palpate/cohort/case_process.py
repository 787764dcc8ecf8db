"""Starts the process of a case and waits for it; a case that ends it harms no other one."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

from palpate.base.own_process import own_process

__all__ = ["CaseProcess", "CaseProcesses"]

THREADS = (
    "MKL_NUM_THREADS",
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "RAYON_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)
"""What libraries take their number of threads from: algebra, the engine."""

ALWAYS = {"ITK_GLOBAL_DEFAULT_NUMBER_OF_THREADS": "1"}
"""Several threads of ITK add up mutual information in the order in which they end, so that the last
digits of a transform differ from run to run; the same case makes the same bytes."""


class CaseProcess:
    """A process that waits for one case; started early, it has its modules ready by then."""

    def __init__(self, threads: int | None = None) -> None:
        """Starts it.

        Args:
            threads: Of the libraries that compute, each; None: as each takes them.

        Raises:
            OSError: No process can be started.
        """
        # Ctrl-C is for the one that waits: it ends this one in its own time
        chosen = {} if threads is None else dict.fromkeys(THREADS, str(threads))
        self._process = own_process(
            "palpate.cohort.worker", settings={**chosen, **ALWAYS}, own_session=True
        )

    def run(self, request: dict[str, Any], part: Path, *, timeout: float | None) -> str | None:
        """Runs a case into its folder.

        Returns:
            Why it failed; None where it is done.
        """
        assert self._process.stdin is not None  # noqa: S101  # it is a pipe
        try:
            with suppress(OSError):
                self._process.stdin.write(json.dumps(request).encode() + b"\n")
                self._process.stdin.flush()
            code = self._process.wait(timeout)
        except subprocess.TimeoutExpired:
            return f"took longer than the time limit of {timeout:g} s; a higher limit gives it more"
        finally:
            self.end()
        if (part / "failed.json").is_file():
            told = json.loads((part / "failed.json").read_text("utf-8"))
            return str(told["reason"])
        if code == 0 and (part / "done.json").is_file():
            return None
        return _ended(code)

    def end(self) -> None:
        """Ends it and what it started."""
        with suppress(OSError):
            if sys.platform == "win32":
                self._process.kill()
            else:
                os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        with suppress(OSError):
            self._process.stdin.close()  # type: ignore[union-attr]  # it is a pipe


class CaseProcesses:
    """Processes of cases: one runs, the next one starts meanwhile."""

    def __init__(self, threads: int | None = None) -> None:
        """Starts the first one.

        Args:
            threads: Of the libraries that compute, each; None: as each takes them.

        Raises:
            OSError: No process can be started.
        """
        self._threads = threads
        self._waiting = CaseProcess(threads)

    def next(self) -> CaseProcess:
        """Returns one that waits for its case."""
        taken, self._waiting = self._waiting, CaseProcess(self._threads)
        return taken

    def end(self) -> None:
        """Ends the one that waits."""
        self._waiting.end()


def _ended(code: int) -> str:
    if code >= 0:
        return f"its process ended with code {code}, without a reason; memory or disk may be full"
    try:
        how = signal.Signals(-code).name
    except ValueError:
        how = f"signal {-code}"
    return f"its process was ended by {how}; the system does so where memory runs out"
