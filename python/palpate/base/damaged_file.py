"""What libraries raise at damaged files, told as one kind of error in one line."""

from __future__ import annotations

import csv
import errno
import struct
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager

from palpate.base.errors import PalpateError

__all__ = ["BROKEN", "damage_as", "is_wrong_place"]

BROKEN = (
    *(ArithmeticError, AssertionError, AttributeError, EOFError, LookupError, RuntimeError),
    *(StopIteration, TypeError, ValueError, ImportError),
    *(csv.Error, struct.error, zipfile.BadZipFile, zlib.error),
)
"""Exceptions of Python and its libraries where values are not what they should be."""
MOST_LETTERS = 200


@contextmanager
def damage_as(
    kind: type[PalpateError], what: str, *, allowed: str, also: tuple[type[Exception], ...] = ()
) -> Iterator[None]:
    """Tells such exceptions as an error of a kind; errors that are told already stay as they are.

    Args:
        kind: Of the error.
        what: The file and what is wrong with it.
        allowed: What would have been right.
        also: Exceptions of the library that reads it, beside those of Python.

    Raises:
        PalpateError: The file is damaged.
    """
    try:
        yield
    except PalpateError:
        raise
    except BROKEN + also as error:
        # what went wrong stands last, as in tracebacks
        lines = str(error).strip().splitlines() or [type(error).__name__]
        why = " ".join(lines[-1].split())[:MOST_LETTERS].rstrip(".")
        raise kind(f"{what} ({why}); allowed: {allowed}") from None


def is_wrong_place(error: OSError) -> bool:
    """Says whether a system refused to go to a place that a damaged archive names."""
    return error.errno == errno.EINVAL
