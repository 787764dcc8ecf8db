"""Processes of this program that run one of its own modules."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping, Sequence

__all__ = ["own_process"]

ALWAYS = {"RUST_BACKTRACE": "0"}
"""Nobody would see one, and where memory runs out within it the engine stands still for good."""


def own_process(
    module: str,
    *,
    arguments: Sequence[str] = (),
    settings: Mapping[str, str] | None = None,
    answers: bool = False,
    own_session: bool = False,
) -> subprocess.Popen[bytes]:
    """Starts a module in a process that this one writes to; what it complains of is not shown.

    Args:
        module: Its name, such as "palpate.cohort.worker".
        arguments: Of its command line.
        settings: Variables of its environment beside those of this process.
        answers: Whether this process reads what it writes.
        own_session: Whether Ctrl-C in a terminal passes it by.

    Raises:
        OSError: No process can be started.
    """
    folders = os.pathsep.join(folder for folder in sys.path if folder)
    # without -P what lies in the folder that is read could be taken for a module
    return subprocess.Popen(  # noqa: S603  # of this interpreter
        [sys.executable, "-P", "-m", module, *arguments],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE if answers else subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env={**os.environ, **ALWAYS, **(settings or {}), "PYTHONPATH": folders},
        start_new_session=own_session,
    )
