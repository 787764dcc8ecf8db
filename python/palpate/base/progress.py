"""How long work reports where it is: a function that takes a sentence and a share.

The library is silent; the command line shows what is reported.
"""

from __future__ import annotations

from typing import Protocol

__all__ = ["Progress", "silent"]


class Progress(Protocol):
    """Told what is being done and which share, 0..1, is done; None where it is not known."""

    def __call__(self, what: str, share: float | None, /) -> None:
        """Takes what is being done."""


def silent(what: str, share: float | None, /) -> None:
    """Reports nothing."""
