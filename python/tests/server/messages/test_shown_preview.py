"""Previews of what is not decided yet: how they come, change and go, and what stays of them."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from threading import Event
from typing import Any

import numpy as np
import pytest
from asked_work import asked_of
from palpate import protocol
from palpate.server.messages.grown_preview import GrownPreview
from palpate.server.messages.segment_list import SegmentList
from palpate.server.messages.segment_work import SegmentWork
from palpate.server.messages.shown_preview import MOST_STEPS, ShownPreview
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume
from running_server import PATIENCE

FOUND = {"type": "grow_segment", "spread": None, "passage": None, "most_ml": 100.0}
YELLOW = (1.0, 1.0, 0.0)


@pytest.fixture
def session(ball_scene: Scene) -> Iterator[Session]:
    with Session(ball_scene, options=SessionOptions(real_time=False)) as running:
        yield running


def cube(session: Session, edge: int) -> Segment:
    volume = session.scene.volume
    mask = np.zeros(volume.shape, np.uint8)
    mask[:edge, :edge, :edge] = 1
    return volume.segment(mask, name="cube")


def steps_of(session: Session) -> int:
    """Returns how many steps undo has, and leaves them."""
    steps = 0
    while session.undo():
        steps += 1
    for _ in range(steps):
        session.redo()
    return steps


def two_boxes() -> Scene:
    """Two boxes of 512 and 64 voxels of 1 mm³, as one segment."""
    values = np.zeros((20, 20, 20), np.int16)
    values[1:9, 1:9, 1:9] = values[12:16, 12:16, 12:16] = 100
    volume = Volume(values, spacing=(1.0, 1.0, 1.0))
    scene = Scene(volume)
    scene.add(volume.threshold(50.0, 100.0, name="boxes"))
    return scene


def counts_of(session: Session) -> list[int]:
    return [each["voxels"] for each in session.segments()]


def test_a_preview_that_changes_many_times_has_few_steps_and_leaves_none(session: Session) -> None:
    (ball,) = counts_of(session)
    session.fill_box(1, low=(0, 0, 0), high=(1, 1, 1), solid=True)
    preview = ShownPreview(session, SegmentList(session), colour=YELLOW)
    preview.show(cube(session, 4))
    for edge in [*range(5, 30), *range(30, 5, -1)]:
        preview.change(cube(session, edge))
        assert counts_of(session) == [ball + 1, edge**3]
        assert steps_of(session) <= 1 + MOST_STEPS
    preview.hide()
    assert counts_of(session) == [ball + 1]
    assert steps_of(session) == 1


@pytest.mark.parametrize("changes", [2, MOST_STEPS - 1, 2 * MOST_STEPS])
@pytest.mark.parametrize("moved", [False, True])
def test_what_else_was_done_stays_where_a_preview_goes(
    session: Session, changes: int, *, moved: bool
) -> None:
    pose = np.eye(4)
    pose[0, 3] = 2.0
    (ball,) = counts_of(session)
    preview = ShownPreview(session, SegmentList(session), colour=YELLOW)
    preview.show(cube(session, 2), pose=pose.ravel().tolist() if moved else None)
    for edge in range(3, 3 + changes):
        preview.change(cube(session, edge % 7 + 3 + edge % 2))
        if edge == 3:
            session.fill_box(1, low=(0, 0, 0), high=(1, 1, 2), solid=True)
    preview.hide()
    assert counts_of(session) == [ball + 2]
    # also right after it was shown
    preview.show(cube(session, 2), pose=pose.ravel().tolist() if moved else None)
    session.fill_box(1, low=(0, 0, 0), high=(1, 1, 2), solid=False)
    preview.hide()
    assert counts_of(session) == [ball]


def test_a_preview_that_undo_took_away_is_not_there_and_hides_nothing_else(
    session: Session,
) -> None:
    (ball,) = counts_of(session)
    session.fill_box(1, low=(0, 0, 0), high=(1, 1, 1), solid=True)
    preview = ShownPreview(session, SegmentList(session), colour=YELLOW)
    preview.show(cube(session, 4))
    session.undo()
    assert not preview.is_there
    preview.hide()
    assert counts_of(session) == [ball + 1]


# --- pages that come later ----------------------------------------------------------------


def test_a_page_that_comes_later_is_told_of_a_grown_region_and_can_decide(server: Any) -> None:
    with server.page() as page:
        page.send(FOUND | {"seed": [20.0, 20.0, 20.0]})
        told = page.receive("grown")
        page.send({"type": "change_grown", "level": told["least"]})
        told = page.receive("grown", until=lambda m: m["level"] == told["least"])
    with server.page() as again:
        again.receive("hello")
        assert again.receive("grown") == told
        again.send({"type": "end_grown", "keeps": False})
        again.receive("segments", until=lambda m: len(m["segments"]) == 1)
    with server.page() as last:
        kinds = [last.next()["type"] for _ in range(20)]
        assert "state" in kinds
        assert "grown" not in kinds


def test_a_page_that_comes_later_is_told_of_what_would_go_and_can_decide(server: Any) -> None:
    server.session.fill_box(1, low=(0, 0, 0), high=(2, 2, 2), solid=True)
    whole = server.session.segment(1).voxel_count
    with server.page() as page:
        page.send({"type": "show_islands", "id": 1, "most": 1, "least_ml": 0.0})
        told = page.receive("islands")
    with server.page() as again:
        assert again.receive("islands") == told
        again.send({"type": "end_going", "removes": True})
        again.receive(
            "segments",
            until=lambda m: [each["voxels"] for each in m["segments"]] == [whole - 8],
        )


# --- decisions ----------------------------------------------------------------------------


async def until_done(work: SegmentWork) -> None:
    while work.is_busy:
        await asyncio.sleep(0.001)


@pytest.mark.parametrize("keeps", [False, True])
def test_a_decision_is_carried_out_though_work_is_stopped(
    ball_scene: Scene, monkeypatch: pytest.MonkeyPatch, *, keeps: bool
) -> None:
    begun, goes_on = Event(), Event()

    def wait(*_: Any) -> None:
        begun.set()
        goes_on.wait(PATIENCE)

    monkeypatch.setattr(GrownPreview, "change", wait)
    with Session(ball_scene, options=SessionOptions(real_time=False)) as session:

        async def ask() -> None:
            work = SegmentWork(session, SegmentList(session), lambda _: None)
            runner = asyncio.create_task(work.run())
            work.ask(
                protocol.GrowSegment(
                    seed=(20.0, 20.0, 20.0), spread=2.5, passage=4.0, most_ml=100.0
                )
            )
            await until_done(work)
            work.ask(protocol.ChangeGrown(level=100))
            await asyncio.to_thread(begun.wait, PATIENCE)
            work.ask(protocol.EndGrown(keeps=keeps))
            work.stop()
            goes_on.set()
            await until_done(work)
            runner.cancel()

        asyncio.run(asyncio.wait_for(ask(), PATIENCE))
        assert [each["touchable"] for each in session.segments()] == [True, True][: 1 + keeps]


def test_what_would_go_goes_though_work_is_stopped_before_it_begins() -> None:
    asked: list[SegmentWork] = []

    def stop_the_second(work: SegmentWork) -> None:
        asked.append(work)
        if len(asked) == 2:
            work.stop()

    look = protocol.ShowIslands(id=1, most=1, least_ml=0.0)
    decision = protocol.EndGoing(removes=True)
    _, voxels = asked_of(two_boxes(), look, decision, also=stop_the_second)
    assert voxels[:2] == [576, 512]
