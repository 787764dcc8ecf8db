"""The journal of a scan's changes: what is kept, offered, brought back, or kept aside."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import made_scans
import msgspec
import numpy as np
import pytest
import SimpleITK
from made_scans import make_ball
from palpate.io.reading import read
from palpate.protocol import SegmentProperties
from palpate.saved.journal import Journal
from palpate.segmentation.brush import Brush
from palpate.segmentation.segment_steps import ShapeStep
from palpate.session.painted_stroke import PaintedStroke
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scan_hash import scan_hash
from palpate.volumes.scene import Scene
from palpate.volumes.second_scan import SecondScan
from palpate.volumes.volume import Volume
from running_server import running, write_page

STILL = SessionOptions(real_time=False)


def open_box(session: Session, z: int) -> None:
    session.fill_box(1, low=(18, 18, z), high=(22, 22, z + 2), solid=False)


@pytest.fixture
def left(tmp_path: Path) -> Path:
    """A folder with the journal of two changes to the ball."""
    with Session(make_ball(), options=STILL) as session:
        journal = Journal(session, folder=tmp_path)
        journal.start()
        open_box(session, 18)
        open_box(session, 22)
    journal.close()
    return tmp_path


def begun(session: Session, folder: Path, **options: Any) -> tuple[Journal, list[str]]:
    told: list[str] = []
    journal = Journal(session, folder=folder, tell=told.append)
    journal.start(**options)
    return journal, told


def runs(journal: Journal) -> bool:
    """Asked anew each time: a property is taken for constant."""
    return journal.is_running


def test_what_a_session_left_is_offered_and_brought_back_step_by_step(left: Path) -> None:
    with Session(make_ball(), options=STILL) as session:
        whole = session.segment(1).mask()
        journal, told = begun(session, left)
        offer = journal.offer
        assert offer is not None
        assert (offer.steps, offer.lost_bytes, told) == (2, 0, [])
        assert not runs(journal)
        journal.decide(bring_back=True)
        assert runs(journal)
        assert journal.offer is None
        assert session.segment(1).mask()[18:20, 18:22, 18:22].sum() == 0
        assert session.undo()
        assert session.undo()
        np.testing.assert_array_equal(session.segment(1).mask(), whole)
        assert not session.undo()
        assert session.segments()[0]["range"] == (0.0, 100.0)


def test_steps_of_segments_are_brought_back_and_follow_undo(tmp_path: Path) -> None:
    grow, shrink = (ShapeStep(kind=kind, amount=2.0) for kind in ("grow", "shrink"))
    with Session(make_ball(), options=STILL) as session:
        journal, _ = begun(session, tmp_path)
        session.change_shape(1, grow)
        session.change_shape(1, shrink)
        journal.note(b"[]")
        both = session.steps(1)
    journal.close()
    with Session(make_ball(), options=STILL) as session:
        journal, told = begun(session, tmp_path, recover=True)
        assert told == []
        assert session.steps(1) == both
        assert session.undo()
        one = session.steps(1)
        assert one is not None
        assert one.steps == (grow,)
        assert session.redo()
        assert session.steps(1) == both
    journal.close()
    # what is damaged costs the steps, and nothing else
    journal.path.with_suffix(".steps").write_bytes(b"damaged")
    with Session(make_ball(), options=STILL) as session:
        journal, told = begun(session, tmp_path, recover=True)
        assert told[0].startswith("Steps of segments were not brought back: ")
        assert session.frame()["can_undo"]


def test_a_stroke_that_was_brought_back_is_undone_at_once(tmp_path: Path) -> None:
    with Session(make_ball(), options=STILL) as session:
        journal, _ = begun(session, tmp_path)
        journal.note(b"[]")
        whole = session.segment(1).mask()
        for place in (18, 26):
            stroke = PaintedStroke(session, 1, erases=True)
            for step in range(3):
                stroke.along(Brush(radius=2.0), [(float(place), 20.0, 16.0 + 4.0 * step)])
            stroke.finish()
            if place == 18:
                one = session.segment(1).mask()
                assert one.sum() < whole.sum()
        both = session.segment(1).mask()
        session.undo()
        np.testing.assert_array_equal(session.segment(1).mask(), one)
        session.redo()
    # no close: as after a crash
    shutil.copytree(tmp_path, tmp_path / "left")
    with Session(make_ball(), options=STILL) as session:
        journal, told = begun(session, tmp_path / "left", recover=True)
        assert (journal.looks, told) == (b"[]", [])
        np.testing.assert_array_equal(session.segment(1).mask(), both)
        for expected in (one, whole):
            assert session.undo()
            np.testing.assert_array_equal(session.segment(1).mask(), expected)
        assert session.redo()
        np.testing.assert_array_equal(session.segment(1).mask(), one)


def test_a_journal_goes_on_after_it_was_brought_back(left: Path) -> None:
    with Session(make_ball(), options=STILL) as session:
        begun(session, left, recover=True)
        open_box(session, 25)
        expected = session.segment(1).mask()
    with Session(make_ball(), options=STILL) as session:
        journal, _ = begun(session, left)
        assert journal.offer is not None
        assert journal.offer.steps == 3
        journal.decide(bring_back=True)
        np.testing.assert_array_equal(session.segment(1).mask(), expected)


def test_starting_fresh_keeps_the_old_file_aside(left: Path) -> None:
    (old,) = left.rglob("*.journal")
    content = old.read_bytes()
    with Session(make_ball(), options=STILL) as session:
        whole = session.segment(1).mask()
        journal, _ = begun(session, left, recover=False)
        assert journal.is_running
        np.testing.assert_array_equal(session.segment(1).mask(), whole)
        (aside,) = [file for file in left.rglob("*.journal") if file != old]
        assert aside.read_bytes() == content
    with Session(make_ball(), options=STILL) as session:
        assert begun(session, left)[0].offer is None


def test_a_session_without_changes_leaves_no_file(tmp_path: Path) -> None:
    with Session(make_ball(), options=STILL) as session:
        journal, told = begun(session, tmp_path)
    journal.close()
    assert told == []
    assert list(tmp_path.rglob("*.journal")) == []


def test_a_session_with_changes_says_that_they_are_kept(tmp_path: Path) -> None:
    with Session(make_ball(), options=STILL) as session:
        journal, told = begun(session, tmp_path)
        open_box(session, 18)
    journal.close()
    assert told == ["Your changes are kept: the next start with this scan offers them."]


def test_a_second_session_of_the_same_scan_keeps_none_and_says_so(left: Path) -> None:
    with Session(make_ball(), options=STILL) as first:
        mine, _ = begun(first, left, recover=True)
        with Session(make_ball(), options=STILL) as second:
            journal, told = begun(second, left)
            assert not journal.is_running
            assert "open in another session" in told[0]
            open_box(second, 18)
        open_box(first, 25)
    mine.close()
    with Session(make_ball(), options=STILL) as session:
        journal, _ = begun(session, left)
        assert journal.offer is not None
        assert journal.offer.steps == 3


def test_another_scan_has_another_journal(left: Path) -> None:
    ball = make_ball().volume
    moved = Volume(ball.array, spacing=ball.spacing, origin=(1.0, 0.0, 0.0))
    brighter = Volume(ball.array + 1, spacing=ball.spacing)
    assert len({scan_hash(volume) for volume in (ball, moved, brighter)}) == 3
    assert scan_hash(make_ball().volume) == scan_hash(ball)
    with Session(Scene(moved, [moved.threshold(0.0)]), options=STILL) as session:
        assert begun(session, left)[0].offer is None


def test_a_file_that_is_no_journal_is_kept_aside(left: Path) -> None:
    (file,) = left.rglob("*.journal")
    file.write_bytes(b"no journal")
    with Session(make_ball(), options=STILL) as session:
        journal, told = begun(session, left)
        assert journal.is_running
        assert "kept aside" in told[0]
        assert (
            sorted(path.read_bytes()[:10] for path in left.rglob("*.journal"))[1] == b"no journal"
        )


def test_a_folder_that_cannot_be_written_is_told_of_once_and_work_goes_on(tmp_path: Path) -> None:
    in_the_way = tmp_path / "state"
    in_the_way.write_text("a file where a folder should be")
    with Session(make_ball(), options=STILL) as session:
        journal, told = begun(session, in_the_way)
        assert not journal.is_running
        assert len(told) == 1
        assert told[0].startswith("Changes are not kept for a crash")
        open_box(session, 18)
        assert session.frame()["can_undo"]


CRASH = """
import os, sys
from pathlib import Path
import numpy as np
sys.path.insert(0, sys.argv[2])
from made_scans import make_ball
from palpate.saved.journal import Journal
from palpate.segmentation.brush import Brush
from palpate.segmentation.segment_steps import ShapeStep
from palpate.session.session import Session, SessionOptions

session = Session(make_ball(), options=SessionOptions(real_time=False, start=(20.0, 20.0, 34.0)))
Journal(session, folder=Path(sys.argv[1])).start()
session.set_tool("eraser", radius=2.0, segment_ids=[1])
session.stroke(on=True)
session.hand((20.0, 20.0, 16.0))
session.let_pass(0.4)
np.save(Path(sys.argv[1]) / "mask.npy", session.segment(1).mask())
print("pressed", flush=True)
sys.stdin.read()
"""


def recovered(folder: Path) -> np.ndarray:
    """Returns the ball as the journal in a folder has it by now; the folder stays as it is."""
    with TemporaryDirectory() as copy, Session(make_ball(), options=STILL) as session:
        shutil.copytree(folder, copy, dirs_exist_ok=True)
        begun(session, Path(copy), recover=True)
        return session.segment(1).mask()


def test_a_stroke_comes_back_after_the_process_was_killed_in_its_middle(tmp_path: Path) -> None:
    process = subprocess.Popen(
        [sys.executable, "-c", CRASH, tmp_path, Path(made_scans.__file__).parent],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    with process:
        assert process.stdout is not None
        assert process.stdout.readline() == "pressed\n"
        # what waits is with the system milliseconds later, on a machine that is not busy
        pressed, ends = np.load(tmp_path / "mask.npy"), time.monotonic() + 60.0
        while not np.array_equal(recovered(tmp_path), pressed):
            assert time.monotonic() < ends, "the journal never holds the whole stroke"
        os.kill(process.pid, signal.SIGKILL)
    with Session(make_ball(), options=STILL) as session:
        whole = session.segment(1).mask()
        journal, _ = begun(session, tmp_path)
        assert journal.offer is not None
        assert journal.offer.steps == 1
        journal.decide(bring_back=True)
        back = session.segment(1).mask()
        np.testing.assert_array_equal(back, pressed)
        assert back.sum() < whole.sum()
        assert session.undo()
        np.testing.assert_array_equal(session.segment(1).mask(), whole)


# --- at the page ------------------------------------------------------------------------


def test_a_page_is_asked_and_names_come_back_with_the_voxels(tmp_path: Path) -> None:
    page_folder = write_page(tmp_path / "page")
    properties = {
        "type": "segment_properties",
        "id": 1,
        "name": "tumour",
        "colour": [0.5, 0.25, 0.0],
        "visible": True,
        "touched_while_hidden": False,
        "touchable": False,
        "locked": False,
        "shown_as": "both",
        "opacity": 0.5,
        "smoothing": 2,
        "surface_from": "bits",
        "wireframe": False,
        "ambient": 0.5,
        "specular": 0.0,
    }
    with (
        running(make_ball(), page_folder, state=tmp_path / "state") as server,
        server.page() as page,
    ):
        assert page.receive("recovery")["offer"] is None
        page.send(properties)
        page.receive("segments", until=lambda m: m["segments"][0]["name"] == "tumour")
        open_box(server.session, 18)
        expected = server.session.segment(1).mask()
        page.send(properties | {"locked": True})
        page.receive("segments", until=lambda m: m["segments"][0]["locked"])
    with (
        running(make_ball(), page_folder, state=tmp_path / "state") as server,
        server.page() as page,
    ):
        offer = page.receive("recovery")["offer"]
        assert offer["steps"] == 1
        page.send({"type": "recover", "bring_back": True})
        assert page.receive("recovery")["offer"] is None
        named = page.receive("segments", until=lambda m: m["segments"][0]["name"] == "tumour")
        (segment,) = named["segments"]
        assert not segment["touchable"]
        assert segment["locked"]
        assert (segment["colour"], segment["shown_as"]) == ([0.5, 0.25, 0.0], "both")
        np.testing.assert_array_equal(server.session.segment(1).mask(), expected)


@pytest.mark.parametrize("pinned", [False, True])
def test_a_hidden_segment_comes_back_to_a_page_as_it_was_felt(
    tmp_path: Path, *, pinned: bool
) -> None:
    page_folder = write_page(tmp_path / "page")
    for bring_back in (None, True):
        with (
            running(make_ball(), page_folder, state=tmp_path / "state") as server,
            server.page() as page,
        ):
            if bring_back is None:
                shown = page.receive("hello")["segments"][0]
                changed = shown | {"visible": False, "touched_while_hidden": pinned}
                names = SegmentProperties.__struct_fields__
                page.send({"type": "segment_properties"} | {name: changed[name] for name in names})
                open_box(server.session, 18)
            else:
                assert page.receive("recovery")["offer"]["steps"] == 1
                page.send({"type": "recover", "bring_back": bring_back})
            told = page.receive("segments", until=lambda m: not m["segments"][0]["visible"])
            (segment,) = told["segments"]
            assert (segment["touchable"], segment["felt"]) == (True, pinned)
            assert segment["touched_while_hidden"] == pinned


def test_where_objects_stand_how_they_feel_and_look_come_back_to_a_page(tmp_path: Path) -> None:
    page_folder = write_page(tmp_path / "page")
    pose = np.eye(4)
    pose[0, 3] = 5.0
    feel = {"stiffness": 0.25, "friction_static": 0.5, "friction_kinetic": 0.25}
    with (
        running(make_ball(), page_folder, state=tmp_path / "state") as server,
        server.page() as page,
    ):
        (before,) = page.receive("segments")["segments"]
        x, y, z = np.mean(before["bounds"], axis=0).tolist()
        page.send({"type": "segment_feel", "id": 1, "feel": feel})
        move = {"type": "move_segment", "id": 1, "pose": pose.ravel().tolist()}
        page.send({**move, "goes_on": True})
        page.send({**move, "goes_on": False})
        page.receive("segments", until=lambda m: m["segments"][0]["shown_as"] == "surface")
        page.send(
            {
                "type": "cut_along",
                "id": 1,
                "eye": [x, y - 200.0, z],
                "view": [0.0, 1.0, 0.0],
                "line": [[x - 50.0, y - 150.0, z], [x + 50.0, y - 150.0, z]],
                "closed": False,
                "preview": False,
            }
        )
        left = page.receive("segments", until=lambda m: len(m["segments"]) == 2)["segments"]
    with (
        running(make_ball(), page_folder, state=tmp_path / "state") as server,
        server.page() as page,
    ):
        assert page.receive("recovery")["offer"]["steps"] == 2
        page.send({"type": "recover", "bring_back": True})
        back = page.receive(
            "segments",
            until=lambda m: (
                [one["name"] for one in m["segments"]] == [one["name"] for one in left]
                and m["segments"][1]["shown_as"] == "surface"
            ),
        )["segments"]
        assert [dict(one, pending=False) for one in back] == [
            dict(one, pending=False) for one in left
        ]
        assert (back[0]["feel"], back[1]["feel"]) == (feel, feel)
        # the cut is one step, the drag another
        page.send({"type": "undo"})
        (whole,) = page.receive("segments", until=lambda m: len(m["segments"]) == 1)["segments"]
        assert whole["pose"] == pose.ravel().tolist()
        page.send({"type": "undo"})
        page.receive("segments", until=lambda m: m["segments"][0]["pose"] != whole["pose"])
        assert not server.session.frame()["can_undo"]


def test_a_note_that_is_none_is_told_of_and_the_voxels_are_back(left: Path, tmp_path: Path) -> None:
    with Session(make_ball(), options=STILL) as session:
        journal, _ = begun(session, left, recover=True)
        journal.note(b"\xff no looks")
    journal.close()
    with (
        running(make_ball(), write_page(tmp_path / "page"), state=left) as server,
        server.page() as page,
    ):
        page.send(msgspec.to_builtins({"type": "recover", "bring_back": True}))
        page.receive("notice", until=lambda m: "names and colours" in m["text"])
        assert server.session.frame()["can_undo"]


def test_a_second_scan_that_a_page_added_is_brought_back(tmp_path: Path) -> None:
    page_folder = write_page(tmp_path / "page")
    file = tmp_path / "second.mha"
    SimpleITK.WriteImage(SimpleITK.Image([5, 6, 7], SimpleITK.sitkInt16), str(file))
    place = np.eye(4)
    place[0, 3] = 12.5
    state = tmp_path / "state"
    with running(make_ball(), page_folder, state=state) as server, server.page():
        assert server.live is not None
        server.live.show_second(SecondScan(read(file), place))
    with running(make_ball(), page_folder, state=state) as server, server.page() as page:
        offer = page.receive("recovery")["offer"]
        assert (offer["steps"], offer["second"]) == (0, "second")
        page.send({"type": "recover", "bring_back": True})
        told = page.receive("second_scan")
        assert told["scan"]["dimensions"] == [5, 6, 7]
        assert told["second_from_first"] == place.ravel().tolist()
    file.unlink()
    with running(make_ball(), page_folder, state=state) as server, server.page() as page:
        assert page.receive("recovery")["offer"]["second"] == "second"
        page.send({"type": "recover", "bring_back": True})
        notice = page.receive("notice", until=lambda m: m["level"] == "warning")
        assert "second scan was not brought back" in notice["text"]
    # it was told once
    with running(make_ball(), page_folder, state=state) as server, server.page() as page:
        assert page.receive("recovery")["offer"] is None


def test_a_second_scan_that_was_taken_away_is_not_offered(tmp_path: Path) -> None:
    file = tmp_path / "second.mha"
    SimpleITK.WriteImage(SimpleITK.Image([5, 6, 7], SimpleITK.sitkInt16), str(file))
    with Session(make_ball(), options=STILL) as session:
        journal, _ = begun(session, tmp_path)
        journal.note_second(SecondScan(read(file)))
        journal.note_second(None)
    journal.close()
    with Session(make_ball(), options=STILL) as session:
        assert begun(session, tmp_path)[0].offer is None


def test_what_was_saved_in_the_scene_that_is_open_is_not_offered_again(left: Path) -> None:
    with Session(make_ball(), options=STILL) as session:
        journal, _ = begun(session, left, recover=True)
        journal.note_saved("scene")
    journal.close()
    kept = journal.path.read_bytes()
    # another scene of that scan, or the scan alone
    for other in ("another scene", None):
        with Session(make_ball(), options=STILL) as session:
            assert begun(session, left, scene=other)[0].offer is not None
    with Session(make_ball(), options=STILL) as session:
        journal, told = begun(session, left, scene="scene")
        assert journal.offer is None
        assert runs(journal)
        assert told == []
        # nothing is lost
        (aside,) = journal.path.parent.glob(f"{journal.path.stem}-*.journal")
        assert aside.read_bytes() == kept
        journal.note_saved("scene")
        open_box(session, 18)
    journal.close()
    with Session(make_ball(), options=STILL) as session:
        # it was changed since
        assert begun(session, left, scene="scene")[0].offer is not None
