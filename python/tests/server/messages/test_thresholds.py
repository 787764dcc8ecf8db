"""Thresholds that are dragged: few are made, the last one always."""

from __future__ import annotations

import asyncio
from threading import Event

from palpate.protocol import Threshold
from palpate.server.messages.thresholds import ThresholdJobs


def asked(number: int | None, low: float) -> Threshold:
    return Threshold(id=number, name="bone", low=low, high=1000.0)


def made(thresholds: list[Threshold]) -> list[Threshold]:
    """Asks for all but the first while the first is being made; returns what was made."""
    begun, all_asked = Event(), Event()
    done: list[Threshold] = []

    def work(threshold: Threshold) -> None:
        begun.set()
        # a limit, so that a test that fails does not hang
        assert all_asked.wait(60.0)
        done.append(threshold)

    async def ask() -> None:
        jobs = ThresholdJobs(work)
        runner = asyncio.create_task(jobs.run())
        first, *others = thresholds
        jobs.ask(first)
        assert await asyncio.to_thread(begun.wait, 60.0)
        for threshold in others:
            jobs.ask(threshold)
            # the runner would begin the next one here, if it did not wait
            await asyncio.sleep(0)
        all_asked.set()
        while thresholds[-1] not in done:
            await asyncio.sleep(0.001)
        runner.cancel()

    asyncio.run(asyncio.wait_for(ask(), 60.0))
    return done


def test_a_drag_makes_the_threshold_it_began_with_and_the_last() -> None:
    drag = [asked(1, float(low)) for low in range(200)]
    assert made(drag) == [drag[0], drag[-1]]


def test_drags_of_two_segments_do_not_replace_each_other() -> None:
    drags = [asked(1, 0.0), asked(2, 1.0), asked(3, 2.0), asked(2, 3.0), asked(1, 4.0)]
    assert made(drags) == [drags[0], drags[2], drags[3], drags[4]]


def test_new_segments_are_all_made() -> None:
    new = [asked(None, float(low)) for low in range(5)]
    assert made(new) == new
