"""Work in a child that was forked after its parent had worked in parallel."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from palpate import Scene, Session, Surface, Volume

PATIENCE = 60.0
"""Until what hangs is given up [s]."""


def ball() -> Volume:
    z, y, x = np.ogrid[:40, :40, :40]
    far = (z - 20) ** 2 + (y - 20) ** 2 + (x - 20) ** 2
    return Volume((1000 - far).astype(np.int16), spacing=(1.0, 1.0, 1.0))


def counted(low: float) -> tuple[int, int, tuple[float, float], int]:
    volume = ball()
    segment = volume.threshold(low)
    return (
        segment.voxel_count,
        int(segment.mask().sum()),
        volume.range,
        int(volume.histogram.counts.sum()),
    )


def meshed(low: float) -> float:
    return Surface(ball().threshold(low)).volume


def start_session(low: float) -> str:
    volume = ball()
    try:
        Session(Scene(volume, [volume.threshold(low)])).stop()
    except RuntimeError as error:
        return str(error)
    return ""


def forked(work: Callable[[float], Any], low: float) -> Any:
    # the parent has worked in parallel
    counted(low)
    pool = multiprocessing.get_context("fork").Pool(1)
    try:
        return pool.apply_async(work, (low,)).get(PATIENCE)
    finally:
        pool.terminate()


@pytest.mark.parametrize("work", [counted, meshed])
def test_a_forked_child_works_as_its_parent(work: Callable[[float], Any]) -> None:
    assert forked(work, 900.0) == work(900.0)


def test_a_session_in_a_forked_child_is_refused_at_once() -> None:
    assert "multiprocessing.get_context('spawn')" in forked(start_session, 900.0)
