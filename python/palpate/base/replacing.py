"""Which files may be replaced: none that was read, and others only where a person agrees."""

from __future__ import annotations

import os
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

from palpate.base.errors import OptionError
from palpate.base.files_read import was_read

__all__ = ["agreed_by", "check_replaceable"]

WRITABLE = stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH

_AGREE: ContextVar[Callable[[Path], object]] = ContextVar("_AGREE", default=lambda _: None)
"""Refuses to replace a file that exists; by default whoever calls has decided it."""


@contextmanager
def agreed_by(agree: Callable[[Path], object]) -> Iterator[None]:
    """Within it, ``agree`` is called with each file that exists, and raises where it is to stay."""
    before = _AGREE.set(agree)
    try:
        yield
    finally:
        _AGREE.reset(before)


def check_replaceable(path: Path) -> None:
    """Refuses what a new file must not replace; a folder is not looked at.

    Raises:
        OptionError: It was read, is read-only or no file, or nobody agreed.
    """
    try:
        found = path.stat()
    except OSError:
        # it is new, or whoever writes it says what is wrong
        return
    if stat.S_ISDIR(found.st_mode):
        return
    if was_read(path):
        raise OptionError(f"{path} is what is read; allowed: a new file")
    if not stat.S_ISREG(found.st_mode):
        raise OptionError(f"{path} is a device, a pipe or a socket; allowed: a new file")
    # root may write whatever its mode says
    if not (found.st_mode & WRITABLE and os.access(path, os.W_OK)):
        raise OptionError(f"{path} exists already and is read-only; allowed: a new file")
    _AGREE.get()(path)
