"""Options of commands that run a recipe over many scans."""

from __future__ import annotations

from typing import Annotated

import typer

from palpate.cohort.limits import Limits

__all__ = ["Memory", "Timeout", "Workers", "limits_of"]

Workers = Annotated[
    int | None,
    typer.Option(help="How many cases run at a time on this machine (Dask).", min=1),
]
Timeout = Annotated[float | None, typer.Option(help="Longest time of a case in s.", min=0.001)]
Memory = Annotated[
    float | None,
    typer.Option(help="Most memory of a case for data in GiB (Linux).", min=0.001),
]


def limits_of(*, timeout: float | None, memory: float | None, retry: int = 0) -> Limits:
    """Returns the limits of a case: its time [s], its memory [GiB], and how often it is retried."""
    room = None if memory is None else int(memory * 2**30)
    return Limits(seconds=timeout, memory=room, retry=retry)
