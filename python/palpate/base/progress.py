"""Progress of long work: a function that takes a sentence and a fraction.

The library prints nothing; the command line shows what is reported.
"""

from __future__ import annotations

from typing import Protocol

__all__ = ["Progress", "silent"]


class Progress(Protocol):
    """Takes what is being done, and the fraction that is done: 0 to 1, None if unknown."""

    def __call__(self, what: str, share: float | None, /) -> None:
        """Reports progress."""


def silent(what: str, share: float | None, /) -> None:
    """Reports nothing."""
