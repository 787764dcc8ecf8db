"""What is seen is what is felt: hidden segments, and those that are touched while hidden."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from made_scans import make_ball
from palpate.base.errors import OptionError
from palpate.saved.edited_scene import edited_scene
from palpate.saved.scene_file import open_scene, save_scene
from palpate.session.appearance import appearances_of, keep_appearances, restore_appearances
from palpate.session.scripted_path import ScriptedPath
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scan_hash import scan_hash
from palpate.volumes.scene import Scene

STILL = SessionOptions(real_time=False)
INTO_THE_BALL = ScriptedPath((20.0, 20.0, 40.0)).move((20.0, 20.0, 24.0), seconds=0.3)


def ball(*, visible: bool = True, touchable: bool = True, pinned: bool = False) -> Scene:
    """Returns the ball in a scene that shows and touches it so."""
    made = make_ball()
    scene = Scene(made.volume)
    (one,) = made
    scene.add(one.segment, visible=visible, touchable=touchable, touched_while_hidden=pinned)
    return scene


def is_felt(session: Session) -> bool:
    """Whether the engine has the only segment as an obstacle."""
    (state,) = session.segments()
    return state["felt"]


@pytest.mark.parametrize("touchable", [False, True])
@pytest.mark.parametrize("visible", [False, True])
@pytest.mark.parametrize("pinned", [False, True])
def test_a_program_feels_what_its_scene_shows(
    *, touchable: bool, visible: bool, pinned: bool
) -> None:
    scene = ball(visible=visible, touchable=touchable, pinned=pinned)
    with Session(scene, device=INTO_THE_BALL, options=STILL) as session:
        recording = session.run(0.4)
        (state,) = session.segments()
    assert recording.contacts.any() == state["felt"] == (touchable and (visible or pinned))
    assert state["touchable"] == touchable


def test_the_contact_ends_at_once_where_what_is_touched_is_hidden() -> None:
    options = SessionOptions(real_time=False, start=(20.0, 20.0, 32.0))
    with Session(ball(), options=options) as session:
        session.hand((20.0, 20.0, 25.0))
        session.let_pass(0.5)
        assert np.linalg.norm(session.frame()["force"]) > 0.5
        session.start_recording()
        session.let_pass(0.05)
        session.set_touchable(1, touchable=True, visible=False)
        session.let_pass(0.5)
        recording = session.stop_recording()
        after = session.frame()
    forces = np.linalg.norm(recording.forces, axis=1)
    touching = np.flatnonzero(recording.contacts)
    # nothing pulls: the tick in which the contact ends already has no force
    assert touching[-1] < 60
    assert not forces[touching[-1] + 1 :].any()
    assert not after["contact"]
    assert after["touched"] == 0
    assert after["safety"]["violations"] == 0
    np.testing.assert_allclose(after["proxy"], (20.0, 20.0, 25.0), atol=0.01)


def test_a_segment_that_is_shown_around_the_probe_first_lets_it_out() -> None:
    options = SessionOptions(real_time=False, start=(20.0, 20.0, 32.0))
    with Session(ball(visible=False), options=options) as session:
        session.hand((20.0, 20.0, 20.0))
        session.let_pass(0.5)
        assert not session.frame()["contact"]
        session.start_recording()
        session.set_touchable(1, touchable=True, visible=True)
        session.let_pass(0.3)
        recording = session.stop_recording()
        after = session.frame()
    assert after["contact"]
    assert np.linalg.norm(np.subtract(after["proxy"], 20.0)) > 7.0
    assert after["safety"]["violations"] == 0
    steps = np.linalg.norm(np.diff(recording.forces, axis=0), axis=1)
    # the safety stage lets it grow by 0.1 N in a tick; some 3 N are its end
    assert np.linalg.norm(recording.forces[0]) < 0.11
    assert steps.max() < 0.25


def test_what_is_wanted_outlasts_being_hidden() -> None:
    with Session(ball(), options=STILL) as session:
        session.set_touchable(1, touchable=False, visible=False)
        session.set_touchable(1, touchable=False, visible=True)
        assert not is_felt(session)
        session.set_touchable(1, touchable=True, visible=False)
        assert (session.segments()[0]["touchable"], is_felt(session)) == (True, False)
        # who knows nothing of pages leaves what they show
        session.set_touchable(1, touchable=True)
        assert not is_felt(session)
        session.set_touchable(1, touchable=True, touched_while_hidden=True)
        assert is_felt(session)


def test_a_segment_that_is_not_there_is_refused_and_nothing_is_kept_of_it() -> None:
    with Session(ball(), options=STILL) as session:
        with pytest.raises(OptionError):
            session.set_touchable(2, touchable=True, visible=False)
        session.add_segment(session.scene.volume.threshold(0.0, name="second"))
        assert [state["felt"] for state in session.segments()] == [True, True]


def test_undo_and_redo_bring_a_hidden_segment_back_unfelt() -> None:
    with Session(ball(), options=STILL) as session:
        second = session.add_segment(session.scene.volume.threshold(0.0, name="second"))
        session.set_touchable(second, touchable=True, visible=False)
        for _ in range(2):
            assert session.undo()
            assert session.redo()
            assert [state["felt"] for state in session.segments()] == [True, False]
        session.remove_segment(second)
        assert session.undo()
        assert [state["felt"] for state in session.segments()] == [True, False]
        assert session.segments()[1]["touchable"]


def test_a_part_that_is_cut_off_is_felt_as_the_whole_was() -> None:
    with Session(ball(visible=False), options=STILL) as session:
        session.cut(1, (20.0, 20.0, 20.0), (0.0, 0.0, 1.0))
        assert [(one["touchable"], one["felt"]) for one in session.segments()] == [
            (True, False),
            (True, False),
        ]


@pytest.mark.parametrize("pinned", [False, True])
def test_a_saved_scene_is_felt_as_it_was(tmp_path: Path, *, pinned: bool) -> None:
    path = tmp_path / "hidden.palpate"
    scene = ball(visible=False, pinned=pinned)
    with Session(scene, options=STILL) as session:
        looks = appearances_of(session)
        save_scene(path, session, looks=keep_appearances(session, lambda number: looks[number]))
    saved = open_scene(path)
    with Session(saved.scene(), options=STILL) as session:
        saved.restore(session)
        looks = restore_appearances(session, saved.looks)
        assert (session.segments()[0]["touchable"], is_felt(session)) == (True, pinned)
        assert (looks[1].visible, looks[1].touched_while_hidden) == (False, pinned)
    # and as a program or a command finds it
    edited, _ = edited_scene(saved)
    (one,) = edited
    assert (one.touchable, one.visible) == (True, False)
    assert one.appearance.touched_while_hidden == pinned
    with Session(edited, options=STILL) as session:
        assert is_felt(session) == pinned


def test_what_an_earlier_version_kept_of_a_hidden_segment_is_not_pinned() -> None:
    kept = b'[{"id":1,"touchable":true,"look":{"name":"bone","colour":[0,1,0],"visible":false}}]'
    with Session(ball(), options=STILL) as session:
        looks = restore_appearances(session, kept)
        assert not looks[1].touched_while_hidden
        assert (session.segments()[0]["touchable"], is_felt(session)) == (True, False)


def test_a_journal_alone_tells_what_was_felt(tmp_path: Path) -> None:
    path, digest = tmp_path / "kept.journal", scan_hash(ball().volume)
    with Session(ball(), options=STILL) as session:
        session.begin_journal(path, digest)
        session.set_touchable(1, touchable=True, visible=False)
        session.end_journal()
    with Session(ball(), options=STILL) as session:
        session.recover_journal(path, digest)
        assert not is_felt(session)
        assert session.scene_now()
        session.undo()
        assert not is_felt(session)
        session.set_touchable(1, touchable=True)
        assert is_felt(session)
