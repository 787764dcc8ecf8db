"""Work on segments on behalf of a page: thresholds that are dragged, growing, changes of shape."""

from __future__ import annotations

import asyncio
from pathlib import Path
from threading import Event
from typing import Any

import numpy as np
import pytest
from asked_work import asked_of
from palpate import protocol
from palpate.segmentation import operations as segmentation
from palpate.segmentation import segment_steps
from palpate.segmentation.mask_shape import margin
from palpate.server.messages.segment_list import SegmentList
from palpate.server.messages.segment_work import SegmentWork, ThresholdJobs
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume, VolumeTraits
from running_server import PATIENCE, running, write_page

GROW = {"type": "grow_segment", "spread": 2.5, "passage": 4.0, "most_ml": 100.0}
FOUND = GROW | {"spread": None, "passage": None}
SHAPE = {"type": "change_shape", "id": 1, "other": None}


def test_a_region_is_shown_until_it_is_kept_and_undo_takes_it_away(server: Any) -> None:
    with server.page() as page:
        page.send(GROW | {"seed": [20.0, 20.0, 20.0]})
        told = page.receive("grown")
        assert told["least"] == told["level"] == told["most"]
        preview = server.session.segments()[1]
        assert not preview["touchable"]
        assert told["volume_ml"] == pytest.approx(preview["volume"] / 1000.0)
        page.send({"type": "end_grown", "keeps": True})
        both = page.receive(
            "segments", until=lambda m: [each["touchable"] for each in m["segments"]] == [True] * 2
        )["segments"]
        assert both[1]["name"] == "Region 2"
        assert both[1]["range"] is None
        assert both[1]["voxels"] == pytest.approx(both[0]["voxels"], rel=0.2)
        page.send({"type": "undo"})
        page.receive("segments", until=lambda m: len(m["segments"]) == 1)


def test_levels_of_a_grown_region_change_it_and_one_undo_takes_back_what_was_kept(
    server: Any,
) -> None:
    session = server.session
    with server.page() as page:
        page.send(FOUND | {"seed": [20.0, 20.0, 20.0]})
        told = page.receive("grown")
        assert told["least"] < told["usual"]
        volumes = []
        for level in (told["least"], told["usual"], told["most"]):
            page.send({"type": "change_grown", "level": level})
            now = page.receive("grown")
            assert now["level"] == level
            volumes.append(now["volume_ml"])
        assert volumes == sorted(volumes)
        assert volumes[1] == told["volume_ml"]
        page.send({"type": "change_grown", "level": told["least"]})
        page.receive("grown", until=lambda m: m["level"] == told["least"])
        page.send({"type": "end_grown", "keeps": True})
        page.receive(
            "segments", until=lambda m: [each["touchable"] for each in m["segments"]] == [True] * 2
        )
        kept = session.segment(session.segments()[1]["id"])
        assert kept.voxel_count * kept.volume.voxel_volume / 1000.0 == pytest.approx(volumes[0])
        page.send({"type": "undo"})
        page.receive("segments", until=lambda m: len(m["segments"]) == 1)


def test_a_grown_region_that_is_dropped_leaves_nothing_and_other_work_stays(server: Any) -> None:
    session = server.session
    before = session.segment(1).voxel_count
    with server.page() as page:
        page.send(FOUND | {"seed": [20.0, 20.0, 20.0]})
        told = page.receive("grown")
        page.send({"type": "change_grown", "level": told["least"]})
        page.receive("grown", until=lambda m: m["level"] == told["least"])
        # something else is done meanwhile, which dropping must not take back
        session.fill_box(1, low=(0, 0, 0), high=(2, 2, 2), solid=True)
        page.send({"type": "end_grown", "keeps": False})
        page.receive("segments", until=lambda m: len(m["segments"]) == 1)
        assert session.segment(1).voxel_count == before + 8


def test_shown_segments_are_smoothed_together(server: Any) -> None:
    session = server.session
    ball = session.segment(1).mask()
    halves = [ball.copy(), ball.copy()]
    halves[0][:, :, 20:] = 0
    halves[1][:, :, :20] = 0
    volume = session.scene.volume
    session.replace_segment(1, volume.segment(halves[0], name="left"))
    session.add_segment(volume.segment(halves[1], name="right"))
    with server.page() as page:
        page.receive("segments", until=lambda m: len(m["segments"]) == 2)
        session.set_locked(2, locked=True)
        page.send(SHAPE | {"kind": "joint", "amount": 2.0})
        page.receive("notice", until=lambda m: "is locked. Unlock it" in m["text"])
        np.testing.assert_array_equal(session.segment(1).mask(), halves[0])
        session.set_locked(2, locked=False)
        page.send(SHAPE | {"kind": "joint", "amount": 2.0})
        page.receive("notice", until=lambda m: "2 segments were smoothed" in m["text"])
        now = [session.segment(number).mask().astype(int) for number in (1, 2)]
        assert all((each != half).any() for each, half in zip(now, halves, strict=True))
        assert (now[0] + now[1] <= 1).all()
        assert (now[0] + now[1])[20, 20, 14:27].all()
        page.send(SHAPE | {"kind": "joint", "amount": 60.0})
        page.receive("notice", until=lambda m: "nothing would be left" in m["text"])


def test_a_shape_changes_and_undo_brings_it_back(server: Any) -> None:
    before = server.session.segment(1).mask()
    with server.page() as page:
        (ball,) = page.receive("hello")["segments"]
        page.send(SHAPE | {"kind": "grow", "amount": 3.0})
        page.receive("segments", until=lambda m: m["segments"][0]["voxels"] > ball["voxels"])
        np.testing.assert_array_equal(
            server.session.segment(1).mask() != 0, margin(before != 0, (1.0, 1.0, 1.0), 3.0)
        )
        page.send({"type": "undo"})
        page.receive("segments", until=lambda m: m["segments"][0]["voxels"] == ball["voxels"])
        np.testing.assert_array_equal(server.session.segment(1).mask(), before)


def test_a_part_leaves_the_scan_with_its_segment_and_one_undo_brings_both_back(server: Any) -> None:
    session = server.session
    volume = session.scene.volume
    ball = session.segment(1).mask()
    half = ball.copy()
    half[:, :, 20:] = 0
    number = session.add_segment(volume.segment(half, name="half"))
    with server.page() as page:
        page.receive("segments", until=lambda m: len(m["segments"]) == 2)
        page.send({"type": "remove_from_scan", "id": number})
        left = int(ball.sum() - half.sum())
        page.receive(
            "segments",
            until=lambda m: [each["voxels"] for each in m["segments"]] == [left],
        )
        # a threshold that is dragged afterwards leaves it out
        low, high = volume.range[1] - 1.0, volume.range[1]
        page.send({"type": "threshold", "id": None, "low": low, "high": high, "name": "rest"})
        _, rest = page.receive("segments", until=lambda m: len(m["segments"]) == 2)["segments"]
        assert not (session.segment(rest["id"]).mask() & half).any()
        page.send({"type": "undo"})
        page.send({"type": "undo"})
        page.receive(
            "segments",
            until=lambda m: [each["voxels"] for each in m["segments"]] == [ball.sum(), half.sum()],
        )


def test_a_scan_is_cropped_to_a_box_and_undo_brings_it_back(server: Any) -> None:
    before = server.session.segment(1).voxel_count
    with server.page() as page:
        page.send({"type": "crop_scan", "low": [20.0, 0.0, 0.0], "high": [0.0, 0.0, 0.0]})
        page.receive("segments", until=lambda m: 0 < m["segments"][0]["voxels"] < before)
        page.send({"type": "undo"})
        page.receive("segments", until=lambda m: m["segments"][0]["voxels"] == before)
        page.send({"type": "crop_scan", "low": [0.0, 0.0, 0.0], "high": [0.0, 0.0, 0.0]})
        page.receive("notice", until=lambda m: "holds all of the scan" in m["text"])
        page.send({"type": "find_table"})
        page.receive("notice", until=lambda m: "no part of the body" in m["text"])


def test_a_page_that_comes_later_is_asked_about_a_table_that_waits(tmp_path: Path) -> None:
    z, y, x = np.indices((16, 64, 64), sparse=True)
    values = np.full((16, 64, 64), -1000, np.int16)
    values[((x - 32) / 24.0) ** 2 + ((y - 24) / 14.0) ** 2 + 0.0 * z < 1.0] = 40
    values[:, 20:28, 28:36] = 800
    values[:, 46:48, 4:60] = 700
    volume = Volume(values, spacing=(3.0, 3.0, 3.0), traits=VolumeTraits(unit="HU"))
    with running(Scene(volume, [volume.threshold(300.0)]), write_page(tmp_path)) as server:
        with server.page() as page:
            page.send({"type": "find_table"})
            found = page.receive("table_found")
        # its connection was lost, or it was loaded again
        with server.page() as page:
            assert page.receive("table_found") == found
            page.send({"type": "remove_segment", "id": found["id"]})
            page.receive("segments", until=lambda m: len(m["segments"]) == 1)
        with server.page() as page:
            page.receive("hello")
            page.send({"type": "find_table"})
            assert page.receive("table_found")["id"] != found["id"]


def test_otsu_makes_segments_whose_range_can_be_changed(server: Any) -> None:
    with server.page() as page:
        page.send({"type": "otsu", "classes": 2})
        both = page.receive("segments", until=lambda m: len(m["segments"]) == 2)["segments"]
        assert both[1]["name"] == "Otsu 2 of 2"
        assert both[1]["range"][1] == 100.0
        assert both[1]["voxels"] == both[0]["voxels"]


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        (GROW | {"seed": [500.0, 0.0, 0.0]}, "lies outside"),
        (SHAPE | {"kind": "shrink", "amount": 50.0}, "nothing would be left of ball"),
        (SHAPE | {"kind": "unite", "amount": 0.0}, "no other segment was given"),
        (SHAPE | {"id": 9, "kind": "grow", "amount": 1.0}, "9"),
        (
            SHAPE | {"kind": "grow", "amount": 0.5},
            "ball: grow by 0.5 mm changes nothing along any axis",
        ),
        (SHAPE | {"kind": "keep-largest", "amount": 1.0}, "Nothing of ball changes by that."),
    ],
)
def test_what_cannot_be_changes_nothing_and_is_told(
    server: Any, asked: dict[str, Any], said: str
) -> None:
    with server.page() as page:
        page.receive("hello")
        page.send(asked)
        assert said in page.receive("notice")["text"]
        assert page.receive("segment_work", until=lambda m: m["what"] is None)
        assert not page.receive("state")["can_undo"]


def work_with(
    ball_scene: Scene, monkeypatch: pytest.MonkeyPatch, meanwhile: Any
) -> tuple[list[protocol.ToPage], Session]:
    """Shrinks the ball, and calls ``meanwhile`` while that is being computed."""
    told: list[protocol.ToPage] = []
    begun, go_on = Event(), Event()
    shrink = segmentation.changed_shape

    def slow(segment: Segment, kind: Any, **options: Any) -> Segment:
        begun.set()
        # a limit, so that a test that fails does not hang
        assert go_on.wait(PATIENCE)
        return shrink(segment, kind, **options)

    monkeypatch.setattr(segment_steps, "changed_shape", slow)
    with Session(ball_scene, options=SessionOptions(real_time=False)) as session:

        async def ask() -> None:
            work = SegmentWork(session, SegmentList(session), told.append)
            runner = asyncio.create_task(work.run())
            work.ask(protocol.ChangeShape(id=1, kind="shrink", amount=3.0, other=None))
            assert await asyncio.to_thread(begun.wait, PATIENCE)
            meanwhile(work, session)
            go_on.set()
            while protocol.SegmentWork(None) not in told:
                await asyncio.sleep(0.001)
            runner.cancel()

        asyncio.run(asyncio.wait_for(ask(), PATIENCE))
        assert not session.frame()["can_undo"] or meanwhile.__name__ == "edit"
    return told, session


def test_stopped_work_changes_nothing(ball_scene: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    def stop(work: SegmentWork, _: Session) -> None:
        # what waits is forgotten too
        work.ask(protocol.ChangeShape(id=1, kind="shrink", amount=1.0, other=None))
        work.stop()

    told, _ = work_with(ball_scene, monkeypatch, stop)
    notices = [one.text for one in told if isinstance(one, protocol.Notice)]
    assert notices == ["Stopped: nothing was changed."]


def test_an_edit_meanwhile_is_not_overwritten(
    ball_scene: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    def edit(_: SegmentWork, session: Session) -> None:
        session.fill_box(1, low=(0, 0, 0), high=(2, 2, 2), solid=True)

    told, _ = work_with(ball_scene, monkeypatch, edit)
    notices = [one.text for one in told if isinstance(one, protocol.Notice)]
    assert notices == ["ball was changed meanwhile. Try again"]


def test_a_threshold_makes_a_segment_and_changes_it(server: Any) -> None:
    with server.page() as page:
        new = {"type": "threshold", "id": None, "name": "air", "low": -1000.0, "high": -900.0}
        page.send(new)
        both = page.receive("segments", until=lambda m: len(m["segments"]) == 2)["segments"]
        assert both[1]["name"] == "air"
        assert both[1]["voxels"] == 41**3 - both[0]["voxels"]
        assert both[0]["colour"] != both[1]["colour"]

        page.send(new | {"id": 2, "name": "all", "high": 100.0})
        both = page.receive("segments", until=lambda m: m["segments"][1]["name"] == "all")[
            "segments"
        ]
        assert both[1]["voxels"] == 41**3
        assert both[1]["range"] == [-1000.0, 100.0]


def test_a_drag_of_a_threshold_ends_at_its_last_position(server: Any) -> None:
    with server.page() as page:
        page.receive("hello")
        for low in range(-1000, 0, 2):
            message = {"type": "threshold", "id": 1, "name": "ball", "low": low, "high": 100.0}
            page.send(message)
        last = page.receive("segments", until=lambda m: m["segments"][0]["range"][0] == -2.0)
        assert last["segments"][0]["voxels"] == int(
            (server.session.scene.volume.array == 100).sum()
        )


def threshold(number: int | None, low: float) -> protocol.Threshold:
    return protocol.Threshold(id=number, name="bone", low=low, high=1000.0)


def thresholds_made(thresholds: list[protocol.Threshold]) -> list[protocol.Threshold]:
    """Asks for all but the first while the first is being made; returns what was made."""
    begun, all_asked = Event(), Event()
    done: list[protocol.Threshold] = []

    def work(one: protocol.Threshold) -> None:
        begun.set()
        # a limit, so that a test that fails does not hang
        assert all_asked.wait(60.0)
        done.append(one)

    async def ask() -> None:
        jobs = ThresholdJobs(work)
        runner = asyncio.create_task(jobs.run())
        first, *others = thresholds
        jobs.ask(first)
        assert await asyncio.to_thread(begun.wait, 60.0)
        for one in others:
            jobs.ask(one)
            # the runner would begin the next one here, if it did not wait
            await asyncio.sleep(0)
        all_asked.set()
        while thresholds[-1] not in done:
            await asyncio.sleep(0.001)
        runner.cancel()

    asyncio.run(asyncio.wait_for(ask(), 60.0))
    return done


def test_a_drag_makes_the_threshold_it_began_with_and_the_last() -> None:
    drag = [threshold(1, float(low)) for low in range(200)]
    assert thresholds_made(drag) == [drag[0], drag[-1]]


def test_drags_of_two_segments_do_not_replace_each_other() -> None:
    drags = [
        threshold(1, 0.0),
        threshold(2, 1.0),
        threshold(3, 2.0),
        threshold(2, 3.0),
        threshold(1, 4.0),
    ]
    assert thresholds_made(drags) == [drags[0], drags[2], drags[3], drags[4]]


def test_new_segments_are_all_made() -> None:
    new = [threshold(None, float(low)) for low in range(5)]
    assert thresholds_made(new) == new


def lying() -> Scene:
    """A body on a table that does not touch it, and all of both as a segment."""
    z, y, x = np.indices((16, 60, 60), sparse=True)
    values = np.full((16, 60, 60), -1000, np.int16)
    values[((x - 30) / 22.0) ** 2 + ((y - 22) / 14.0) ** 2 + 0.0 * z < 1.0] = 40
    values[:, 44:46, 4:56] = 700
    volume = Volume(values, spacing=(3.0, 3.0, 3.0), traits=VolumeTraits(unit="HU"))
    scene = Scene(volume)
    scene.add(volume.threshold(-500.0, 1000.0, name="matter"))
    return scene


def test_a_table_is_suggested_without_a_change_and_goes_in_one_step_of_undo() -> None:
    told, voxels = asked_of(lying(), protocol.SuggestTable(), protocol.RemoveTable())
    both, removed, undone = voxels
    assert told[0] == protocol.TableSuggested()
    assert both - removed == 16 * 2 * 52
    assert undone == both


def test_a_scan_without_a_table_is_not_spoken_of(ball_scene: Scene) -> None:
    told, _ = asked_of(ball_scene, protocol.SuggestTable())
    assert told == []


def test_a_look_for_a_table_gives_way_to_what_is_asked_for() -> None:
    def more(work: SegmentWork) -> None:
        work.ask(protocol.ChangeShape(id=1, kind="grow", amount=3.0, other=None))
        # not begun beside it, nor after it
        work.ask(protocol.SuggestTable())

    told, _ = asked_of(lying(), protocol.SuggestTable(), also=more)
    assert protocol.TableSuggested() not in told
    assert [one for one in told if isinstance(one, protocol.SegmentWork)][-1].what is None
