"""Thresholds that are dragged: few are made, the last one always."""

from __future__ import annotations

import asyncio
import time

from palpate.protocol import Threshold
from palpate.server_thresholds import ThresholdJobs


def asked(number: int | None, low: float) -> Threshold:
    return Threshold(id=number, name="bone", low=low, high=1000.0)


def made(thresholds: list[Threshold]) -> list[Threshold]:
    done: list[Threshold] = []

    def work(threshold: Threshold) -> None:
        time.sleep(0.01)
        done.append(threshold)

    async def ask() -> None:
        jobs = ThresholdJobs(work)
        runner = asyncio.create_task(jobs.run())
        for threshold in thresholds:
            jobs.ask(threshold)
            await asyncio.sleep(0.0005)
        while thresholds[-1] not in done:
            await asyncio.sleep(0.001)
        runner.cancel()

    asyncio.run(asyncio.wait_for(ask(), 10.0))
    return done


def test_a_drag_makes_a_few_thresholds_and_the_last() -> None:
    drag = [asked(1, float(low)) for low in range(200)]
    done = made(drag)
    assert done[-1] == drag[-1]
    assert len(done) < len(drag) / 2


def test_drags_of_two_segments_do_not_replace_each_other() -> None:
    done = made([asked(1, 0.0), asked(2, 1.0), asked(3, 2.0), asked(2, 3.0), asked(1, 4.0)])
    assert {threshold.id: threshold.low for threshold in done} == {1: 4.0, 2: 3.0, 3: 2.0}


def test_new_segments_are_all_made() -> None:
    new = [asked(None, float(low)) for low in range(5)]
    assert made(new) == new
