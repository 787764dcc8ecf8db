"""Cases that are run are locked, so that two runs of one folder do not mix.

A case is one byte of the lock file, at a place that its name gives: shares of all cases run beside
one another, and a run that is killed leaves no lock behind. Machines that share a disk see one
another's locks, where that disk has any.
"""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from hashlib import sha256

from palpate.base.errors import OptionError
from palpate.cohort.case import Case
from palpate.cohort.output_folder import CohortFolder

__all__ = ["locked_cases", "page_lock"]

LOCK = "cohort.lock"
PAGE = 0
"""The byte of the page and the table."""

HELD = (errno.EACCES, errno.EAGAIN, errno.EDEADLK)
"""What the system says where another one has the lock."""

if sys.platform == "win32":
    import msvcrt

    def _lock(file: int, byte: int, *, wait: bool) -> None:
        os.lseek(file, byte, os.SEEK_SET)
        msvcrt.locking(file, msvcrt.LK_LOCK if wait else msvcrt.LK_NBLCK, 1)
else:
    import fcntl

    def _lock(file: int, byte: int, *, wait: bool) -> None:
        fcntl.lockf(file, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB), 1, byte)


@contextmanager
def locked_cases(
    folder: CohortFolder, cases: Sequence[Case], *, warned: Callable[[str], None]
) -> Iterator[None]:
    """Has cases locked within it.

    Args:
        folder: Where they are run to.
        cases: What is run.
        warned: Takes what a person should know: that the disk has no locks.

    Raises:
        OptionError: Another run has one of them.
        OSError: The lock file cannot be written.
    """
    with _lock_file(folder) as file:
        for case in cases:
            try:
                _lock(file, _byte_of(case.name), wait=False)
            except OSError as error:
                if error.errno not in HELD:
                    warned(f"the disk of {folder.of()} has no locks: start no second run there")
                    break
                raise OptionError(
                    f"another run has case {case.name!r} of {folder.of()}; allowed: once it has "
                    "ended, other cases, or another folder"
                ) from None
        yield


@contextmanager
def page_lock(folder: CohortFolder) -> Iterator[None]:
    """Waits until no other one writes page and table, and lets none do so within it."""
    with _lock_file(folder) as file:
        try:
            _lock(file, PAGE, wait=True)
        except OSError as error:
            # without locks both are whole files still
            if error.errno in HELD:
                raise
        yield


@contextmanager
def _lock_file(folder: CohortFolder) -> Iterator[int]:
    """Opens the lock file; as it is closed, the system takes all locks of this process away."""
    file = os.open(folder.of(LOCK), os.O_RDWR | os.O_CREAT, 0o666)
    try:
        yield file
    finally:
        os.close(file)


def _byte_of(name: str) -> int:
    """Returns the byte of a case, above that of the page; systems that fold letters have one."""
    return PAGE + 1 + (int.from_bytes(sha256(name.casefold().encode()).digest()[:8]) >> 2)
