"""Steps of segments on behalf of a page: what it is told, and what it may ask."""

from __future__ import annotations

import asyncio
from typing import Any

import numpy as np
import pytest
from palpate import protocol
from palpate.segmentation import ShapeStep, changed_shape
from palpate.server.messages.segment_list import SegmentList
from palpate.server.messages.segment_work import SegmentWork
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene
from running_server import PATIENCE

GROW = {"type": "change_shape", "id": 1, "kind": "grow", "amount": 3.0, "other": None}
TOLD = {"kind": "grow", "amount": 3.0, "other": None, "on": True}
BY_HAND = {"kind": "by-hand", "amount": 0.0, "other": None, "on": True}


def steps_of(message: Any) -> Any:
    return message["segments"][0]["steps"]


def steps_are(page: Any, *kinds: str) -> Any:
    """Waits until the first segment has steps of these kinds; returns it."""

    def listed(message: Any) -> bool:
        steps = steps_of(message)
        return steps is not None and [step["kind"] for step in steps["steps"]] == list(kinds)

    return page.receive("segments", until=listed)["segments"][0]


def wanted(*steps: dict[str, Any]) -> dict[str, Any]:
    known = ({name: value for name, value in step.items() if name != "other"} for step in steps)
    return {"type": "change_steps", "id": 1, "steps": list(known)}


def grown(session: Session, low: float, amount: float) -> np.ndarray:
    ball = session.scene.volume.threshold(low, 100.0)
    return changed_shape(ball, "grow", amount=amount).mask()


def test_a_page_is_told_of_steps_and_changes_them(server: Any) -> None:
    session = server.session
    with server.page() as page:
        page.receive("hello")
        page.send(GROW)
        assert steps_are(page, "grow")["steps"] == {"range": [0.0, 100.0], "steps": [TOLD]}
        # another value
        page.send(wanted(TOLD | {"index": 0, "amount": 5.0}))
        page.receive(
            "segments", until=lambda m: m["segments"][0]["steps"]["steps"][0]["amount"] == 5
        )
        assert np.array_equal(session.segment(1).mask(), grown(session, 0.0, 5.0))
        # another threshold, which the step follows
        page.send({"type": "threshold", "id": 1, "name": "core", "low": 50.0, "high": 100.0})
        page.receive(
            "segments", until=lambda m: m["segments"][0]["steps"]["range"] == [50.0, 100.0]
        )
        assert np.array_equal(session.segment(1).mask(), grown(session, 50.0, 5.0))
        # by hand
        session.fill_box(1, low=(0, 0, 0), high=(3, 3, 3), solid=True)
        told = steps_are(page, "grow", "by-hand")["steps"]["steps"]
        assert told == [TOLD | {"amount": 5.0}, BY_HAND]
        page.send(wanted(BY_HAND | {"index": 1}))
        steps_are(page, "by-hand")
        assert session.segment(1).mask()[:3, :3, :3].all()
        # and back
        for kinds in (("grow", "by-hand"), ("grow",)):
            page.send({"type": "undo"})
            steps_are(page, *kinds)


@pytest.mark.parametrize(
    "steps",
    [
        [TOLD | {"index": 1}],
        [TOLD | {"index": 0, "kind": "smooth"}],
        [TOLD | {"index": 0}, TOLD | {"index": 0}],
    ],
    ids=["beyond", "another", "twice"],
)
def test_a_list_that_has_changed_meanwhile_is_refused(
    server: Any, steps: list[dict[str, Any]]
) -> None:
    with server.page() as page:
        page.receive("hello")
        page.send(GROW)
        steps_are(page, "grow")
        page.send(wanted(*steps))
        page.receive("notice", until=lambda m: "have changed meanwhile" in m["text"])
        assert np.array_equal(server.session.segment(1).mask(), grown(server.session, 0.0, 3.0))


def test_steps_that_leave_nothing_are_refused_by_name(server: Any) -> None:
    with server.page() as page:
        page.receive("hello")
        page.send(GROW | {"kind": "shrink", "amount": 2.0})
        steps_are(page, "shrink")
        page.send(wanted(TOLD | {"kind": "shrink", "index": 0, "amount": 50.0}))
        page.receive("notice", until=lambda m: "nothing is left of ball after step 1" in m["text"])
        page.send(wanted(TOLD | {"kind": "shrink", "index": 0, "amount": 2.1}))
        page.receive("notice", until=lambda m: m["text"] == "Nothing of ball changes by that.")


def test_a_threshold_whose_steps_follow_can_be_stopped(ball_scene: Scene) -> None:
    told: list[protocol.ToPage] = []
    another = protocol.Threshold(id=1, name="ball", low=50.0, high=100.0)
    with Session(ball_scene, options=SessionOptions(real_time=False)) as session:
        segments = SegmentList(session)
        session.change_shape(1, ShapeStep(kind="grow", amount=3.0))
        segments.steps_changed()
        assert segments.refresh(1, voxels_version=0, pending=0, edit=0)
        before = session.steps(1)

        async def ask() -> None:
            def publish(message: protocol.ToPage) -> None:
                told.append(message)
                if message == protocol.SegmentWork("Step 1 of 1, grow"):
                    work.stop()

            work = SegmentWork(session, segments, publish)
            assert work.takes(another)
            assert not work.takes(protocol.Threshold(id=None, name="new", low=50.0, high=100.0))
            runner = asyncio.create_task(work.run())
            while protocol.SegmentWork(None) not in told:
                await asyncio.sleep(0.001)
            runner.cancel()

        asyncio.run(asyncio.wait_for(ask(), PATIENCE))
        assert protocol.Notice(level="info", text="Stopped: nothing was changed.") in told
        assert session.steps(1) == before
