"""Tools as Python and a page use them: eraser, adder, drill, and undo of their strokes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from palpate.base.errors import OptionError
from palpate.session.frame_state import ToolState
from palpate.session.recording import Recording
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume

ABOVE = SessionOptions(real_time=False, start=(20.0, 20.0, 34.0))
"""The probe 6 mm above the ball's top, and time that stands still until it is told to pass."""


def press(session: Session, *, depth: float = 10.0, seconds: float = 1.0) -> ToolState:
    """Lets the hand pull into the ball from above while the tool is pressed; gives its report."""
    session.stroke(on=True)
    session.hand((20.0, 20.0, 28.0 - depth))
    session.let_pass(seconds)
    session.stroke(on=False)
    return session.frame()["tool"]


def test_what_is_locked_stays_as_it_is_until_it_is_unlocked(ball_scene: Scene) -> None:
    with Session(ball_scene, options=ABOVE) as session:
        before = session.segment(1).mask()
        session.set_locked(1, locked=True)
        assert session.segments()[0]["locked"]
        session.set_tool("eraser", radius=2.0, segment_ids=[1])
        for change in (
            lambda: session.stroke(on=True),
            lambda: session.remove_segment(1),
            lambda: session.replace_segment(1, session.segment(1)),
            lambda: session.fill_box(1, low=(0, 0, 0), high=(9, 9, 9), solid=True),
            lambda: session.cut(1, (20.0, 20.0, 20.0), (0.0, 0.0, 1.0)),
        ):
            with pytest.raises(OptionError, match=r"segment 1 given, which is locked.*unlock it"):
                change()
        np.testing.assert_array_equal(session.segment(1).mask(), before)
        session.set_locked(1, locked=False)
        press(session)
        assert session.segment(1).mask().sum() < before.sum()


def test_an_erasers_stroke_is_one_step_of_undo(ball_scene: Scene) -> None:
    with Session(ball_scene, options=ABOVE) as session:
        before = session.segment(1).mask()
        session.set_tool("eraser", radius=2.0, segment_ids=[1])
        tool = press(session)
        erased = session.segment(1).mask()
        freed = int(before.sum()) - int(erased.sum())
        assert tool["voxels"] == freed > 50
        # voxels of 1 mm³
        assert tool["volume"] == pytest.approx(freed)
        assert (tool["kind"], tool["on"], tool["energy"]) == ("eraser", False, 0.0)
        assert 0 < session.frame()["tool"]["undo_bytes"] < session.frame()["tool"]["undo_budget"]

        steps = session.frame()["step"], session.frame()["steps_made"]
        assert session.undo()
        assert (session.frame()["step"], session.frame()["steps_made"]) == (steps[0] - 1, steps[1])
        np.testing.assert_array_equal(session.segment(1).mask(), before)
        assert not session.undo()
        assert session.redo()
        np.testing.assert_array_equal(session.segment(1).mask(), erased)


def test_an_adder_fills_where_the_probe_went(ball_scene: Scene) -> None:
    with Session(ball_scene, options=ABOVE) as session:
        session.set_touchable(1, touchable=False)
        before = session.segment(1).mask()
        session.set_tool("adder", radius=2.0, segment_ids=[1])
        tool = press(session, depth=-4.0)
        after = session.segment(1).mask()
        assert tool["voxels"] == int(after.sum()) - int(before.sum()) > 20
        assert after[32, 20, 20] == 1


@pytest.mark.parametrize("depth", [None, 1.6])
@pytest.mark.parametrize("overlaps", [False, True])
def test_a_painter_gives_what_is_touched_and_nothing_else_changes(
    ball_scene: Scene, depth: float | None, *, overlaps: bool
) -> None:
    volume = ball_scene.volume
    ball_scene.add(volume.segment(np.zeros(volume.shape, np.uint8), name="painted"))
    painted = 2
    with Session(ball_scene, options=ABOVE) as session:
        ball = session.segment(1).mask()
        session.set_tool(
            "painter", radius=3.0, segment_ids=[painted, 1], depth=depth, overlaps=overlaps
        )
        tool = press(session, depth=4.0)
        own, rest = session.segment(painted).mask(), session.segment(1).mask()
        assert tool["voxels"] == int(own.sum()) > 10
        np.testing.assert_array_equal(own | rest, ball)
        np.testing.assert_array_equal(rest, ball if overlaps else ball & ~own.astype(bool))
        # the top of the ball is at 28 mm
        lowest = int(np.flatnonzero(own.any(axis=(1, 2)))[0])
        assert lowest >= (26 if depth else 24)
        assert session.undo()
        assert session.segment(painted).mask().sum() == 0


def test_the_drill_spends_the_work_of_bone_and_leaves_air(ball_scene: Scene) -> None:
    with Session(ball_scene, options=ABOVE) as session:
        session.settings()
        session.set_tool("drill", radius=2.0, segment_ids=[1])
        tool = press(session, depth=4.0)
        assert tool["volume"] >= 4.0
        # 100 HU: 1300 N/mm² · (131 + 1.067 · 100) kg/m³ / 1900 kg/m³; to one voxel of 1 mm³
        per_volume = 1300.0 * (131.0 + 106.7) / 1900.0
        assert tool["energy"] == pytest.approx(per_volume * tool["volume"], abs=per_volume)
        assert tool["time"] > 0.1
        changes = session.picture_changes()
        assert changes == []  # nobody watched


def test_a_recording_has_volume_time_and_load_of_the_drill(
    ball_scene: Scene, tmp_path: Path
) -> None:
    with Session(ball_scene, options=ABOVE) as session:
        session.set_tool("drill", radius=2.0, segment_ids=[1])
        session.start_recording()
        session.let_pass(0.1)
        tool = press(session, depth=4.0)
        session.let_pass(0.1)
        recording = session.stop_recording()
    assert recording.tool_volumes[0] == 0.0
    assert (np.diff(recording.tool_volumes) >= 0.0).all()
    assert recording.tool_volumes[-1] == tool["volume"] > 4.0
    assert recording.tool_times[-1] == tool["time"]
    # what was spent is the power over time; the picture knows the power of 10 ms before
    at_work = recording.tool_loads > 0.0
    assert recording.tool_loads[at_work].sum() * 1e-3 == pytest.approx(tool["energy"], rel=0.1)
    assert recording.tool_loads[-1] == 0.0

    path = tmp_path / "drilled.palpate-session"
    recording.save(path)
    again = Recording.load(path)
    np.testing.assert_array_equal(again.tool_loads, recording.tool_loads)
    assert again.replay().is_equal
    again.to_csv(tmp_path / "drilled.csv")
    assert "tool_load_mW" in (tmp_path / "drilled.csv").read_text(encoding="utf-8").split("\n")[0]


def test_the_drill_leaves_the_lowest_value_where_the_unit_is_unknown(ball_scene: Scene) -> None:
    known = ball_scene.volume
    volume = Volume(
        known.array + 1000, spacing=known.spacing, traits=replace(known.traits, unit="")
    )
    scene = Scene(volume, [volume.threshold(1050.0, name="ball")])
    with Session(scene, options=ABOVE) as session:
        session.picture_changes()
        session.set_tool("drill", radius=2.0, segment_ids=[1])
        # the work of cortical bone, several times that of 100 HU
        tool = press(session, depth=8.0, seconds=2.0)
        assert tool["energy"] == pytest.approx(1300.0 * tool["volume"], abs=1300.0)
        changes = [box for change in session.picture_changes() for box in change["voxels"]]
        values = np.concatenate([np.frombuffer(box["stored"] or b"", "<i2") for box in changes])
        assert tool["voxels"] > 0
        assert set(np.unique(values)) <= {0, 1100}


@pytest.mark.parametrize(
    ("kind", "options", "told"),
    [
        ("eraser", {"radius": 0.0, "segment_ids": [1]}, "radius 0 mm given"),
        ("eraser", {"radius": float("nan"), "segment_ids": [1]}, "radius NaN mm given"),
        ("drill", {"radius": 40.0, "segment_ids": [1]}, "allowed: above 0 to 16 mm"),
        ("adder", {"radius": 2.0, "segment_ids": []}, "no segment given"),
        ("adder", {"radius": 2.0, "segment_ids": [7]}, "7"),
        ("painter", {"radius": 2.0, "segment_ids": [1]}, "1 segment given to the painter"),
        ("painter", {"radius": 2.0, "segment_ids": [1, 2], "depth": 9.0}, "0 to 8 mm, or none"),
        (
            "saw",
            {"radius": 2.0, "segment_ids": [1]},
            "allowed: eraser, adder, drill, needle, painter",
        ),
    ],
)
def test_tools_that_cannot_be_are_refused(
    ball_scene: Scene, kind: Any, options: dict[str, Any], told: str
) -> None:
    with Session(ball_scene, options=ABOVE) as session:
        with pytest.raises(OptionError, match=told):
            session.set_tool(kind, **options)
        with pytest.raises(OptionError, match="choosing a tool first"):
            session.stroke(on=True)


# --- at the page ------------------------------------------------------------------------

TOOL = {"type": "tool", "kind": "eraser", "radius": 3.0, "segments": [1]}


def test_a_page_erases_sees_it_in_one_message_and_takes_it_back(server: Any) -> None:
    whole = server.session.segment(1).mask()
    server.session.show_surface(1)
    with server.page() as page:
        page.receive("changed")
        page.send(TOOL)
        page.receive("state", until=lambda m: m["tool"]["kind"] == "eraser")
        page.send({"type": "place", "point": [20.0, 20.0, 31.0]})
        page.send({"type": "stroke", "on": True})
        page.receive("state", until=lambda m: m["tool"]["on"])
        page.send({"type": "hand", "target": [20.0, 20.0, 24.0]})
        changed = page.receive("changed", until=lambda m: m["surfaces"])
        assert changed["surfaces"][0]["id"] == 1
        page.send({"type": "stroke", "on": False})
        state = page.receive("state", until=lambda m: not m["tool"]["on"])
        assert state["tool"]["voxels"] > 0
        assert state["can_undo"]
        page.send({"type": "undo"})
        page.receive("state", until=lambda m: not m["can_undo"])
    np.testing.assert_array_equal(server.session.segment(1).mask(), whole)


def test_edits_of_a_labelled_segment_bring_their_labels_and_no_new_version(server: Any) -> None:
    with server.page() as page:
        server.session.fill_box(1, low=(18, 18, 18), high=(22, 22, 22), solid=False)
        first = page.receive("segments", until=lambda m: m["segments"][0]["range"] is None)
        server.session.fill_box(1, low=(18, 18, 18), high=(20, 19, 23), solid=True)
        changed = page.receive("changed", until=lambda m: m["voxels"])
        (box,) = changed["voxels"]
        # only what differs is sent: the part of the box that had been freed
        assert (box["low"], box["high"]) == ([18, 18, 18], [20, 19, 22])
        assert box["labels"] == bytes(8 * [1])
        count = int(server.session.segment(1).mask().sum())
        server.session.fill_box(1, low=(20, 20, 20), high=(21, 21, 21), solid=True)
        again = page.receive("segments", until=lambda m: m["segments"][0]["voxels"] == count + 1)
        assert again["labels"] == first["labels"]


def test_a_page_that_leaves_releases_the_tool(server: Any) -> None:
    with server.page() as page:
        page.send(TOOL)
        page.send({"type": "stroke", "on": True})
        page.receive("state", until=lambda m: m["tool"]["on"])
    with server.page() as other:
        other.receive("state", until=lambda m: not m["tool"]["on"])
