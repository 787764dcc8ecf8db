"""Pieces of work on a few threads at a time, which can be stopped between them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

__all__ = ["side_by_side"]

Piece = TypeVar("Piece")
Result = TypeVar("Result")

MOST_THREADS = 4


def side_by_side(
    work: Callable[[Piece], Result], pieces: Iterable[Piece], *, told: Callable[[float], None]
) -> list[Result]:
    """Returns what ``work`` returns for each piece, in the order of the pieces.

    Args:
        work: Is called on threads.
        pieces: What it is called with.
        told: Takes the share that is done, before each piece and from this thread. Where it raises,
            pieces that were not begun are left out.
    """
    pieces = list(pieces)
    found: list[Result] = []
    pool = ThreadPoolExecutor(min(MOST_THREADS, os.cpu_count() or 1))
    try:
        waiting = [pool.submit(work, piece) for piece in pieces]
        for number, future in enumerate(waiting):
            told(number / len(waiting))
            found.append(future.result())
    finally:
        pool.shutdown(cancel_futures=True)
    return found
