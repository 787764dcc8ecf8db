"""Recordings: what they hold, that they are replayed to the bit, and the tables made of them."""

from __future__ import annotations

import csv
import locale
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from numpy.typing import NDArray
from palpate.base.errors import OptionError, RecordingFormatError
from palpate.session.recording import Recording
from palpate.session.recording_columns import TickColumns, by_name
from palpate.session.scripted_path import ScriptedPath
from palpate.session.session import Session, SessionOptions
from palpate.session.touch_settings import TouchSettings
from palpate.volumes.scene import Scene

OFFLINE = SessionOptions(real_time=False)


def path_into_the_ball() -> ScriptedPath:
    path = ScriptedPath((20.0, 20.0, 40.0))
    for step in range(12):
        path = path.move((14.0 + step, 20.5, 22.0 + 12.0 * (step % 2)), seconds=0.1)
    return path


def edited(scene: Scene) -> Recording:
    """A session in which everything happens that a page can ask for."""
    with Session(scene, device=path_into_the_ball(), options=OFFLINE) as session:
        session.start_recording()
        for step in range(30):
            session.let_pass(0.033)
            low = (10 + step % 12, 14, 18)
            high = (16 + step % 12, 27, 30)
            session.fill_box(1, low=low, high=high, solid=step % 2 == 0)
            match step:
                case 5 | 12 | 19:
                    session.undo()
                case 7:
                    session.settings(TouchSettings(stiffness=0.7, damping=0.002))
                case 9:
                    session.set_touchable(1, touchable=False)
                case 11:
                    session.set_touchable(1, touchable=True)
                case 15:
                    session.add_segment(scene.volume.threshold(50.0, name="again"))
                case 17:
                    session.set_feel(1, stiffness=0.4)
                case 21:
                    session.redo()
                case _:
                    pass
        return session.stop_recording()


@pytest.fixture
def recording(ball_scene: Scene) -> Recording:
    return edited(ball_scene)


def test_a_session_with_edits_is_replayed_to_the_bit(recording: Recording) -> None:
    assert recording.can_be_replayed
    assert recording.contact_share > 0.2
    assert recording.largest_force > 0.5
    replayed = recording.replay()
    assert replayed.is_equal
    assert replayed.different == 0
    assert replayed.first_difference is None
    assert replayed.recorded_hash == replayed.replayed_hash
    assert len(replayed.recorded_hash) == 16
    assert replayed.stopped == ""
    assert replayed.same_build
    # the state is told at the end of the first tick
    assert replayed.first_tick == recording.ticks[0] + 1
    assert replayed.ticks == len(recording) - 1
    np.testing.assert_array_equal(replayed.forces, recording.forces[1:])
    np.testing.assert_array_equal(replayed.positions, recording.positions[1:])


def test_the_same_session_has_the_same_hash_and_another_one_another(
    recording: Recording, ball_scene: Scene
) -> None:
    assert edited(ball_scene).replay().replayed_hash == recording.replay().replayed_hash
    with Session(ball_scene, device=path_into_the_ball(), options=OFFLINE) as session:
        other = session.run(0.99)
    assert other.replay().replayed_hash != recording.replay().replayed_hash


def test_a_live_session_edited_thirty_times_a_second_is_replayed(ball_scene: Scene) -> None:
    options = SessionOptions(start=(20.0, 20.0, 36.0))
    with Session(ball_scene, options=options) as session:
        session.start_recording()
        for step in range(40):
            session.hand((20.0 + 6.0 * np.sin(0.5 * step), 20.0, 24.0))
            low = (14 + step % 8, 14, 20)
            session.fill_box(1, low=low, high=(20 + step % 8, 27, 30), solid=step % 2 == 0)
            session.let_pass(0.033)
        recording = session.stop_recording()
    replayed = recording.replay()
    assert replayed.is_equal
    assert replayed.stopped == ""
    assert replayed.ticks > 0.5 * len(recording)
    assert recording.contacts.any()


def test_events_stand_in_the_tick_that_obeyed_them(recording: Recording) -> None:
    events = recording.events
    assert len(events) == len(recording)
    said = {name for event in events if event for name in event.split(" + ")}
    assert {"edit", "segments", "settings", "feel"} <= said
    obeyed = np.flatnonzero(np.diff(recording.columns["command"])) + 1
    # before the recording's mark there is nothing that it knows
    assert set(np.flatnonzero(events).tolist()) == set(obeyed[obeyed > 0].tolist())


def rows(recording: Recording, kept: slice | NDArray[np.int64]) -> TickColumns:
    """Returns some rows of all columns."""
    columns = {name: column[kept] for name, column in by_name(recording.columns).items()}
    return cast("TickColumns", columns)


def test_a_changed_bit_is_found(recording: Recording) -> None:
    row = int(np.flatnonzero(recording.contacts)[50])
    position = recording.columns["position_in_device"].copy()
    position.view(np.uint64)[row, 2] ^= 1 << 30
    changed = Recording(
        recording.columns | {"position_in_device": position},
        tape=recording._tape,
        about=recording.about,
    ).replay()
    assert not changed.is_equal
    assert changed.first_difference is not None
    assert changed.first_difference["tick"] == recording.ticks[row]
    assert changed.recorded_hash != changed.replayed_hash
    assert changed.recorded_hash == recording.replay().recorded_hash


def test_lost_ticks_are_said_and_end_the_replay(recording: Recording) -> None:
    kept = np.r_[0:400, 417 : len(recording)]
    gappy = Recording(rows(recording, kept), tape=recording._tape, about=recording.about)
    assert gappy.lost == 17
    assert gappy.events[400].startswith("17 ticks lost")
    replayed = gappy.replay()
    assert replayed.is_equal
    assert replayed.ticks == 399
    assert f"17 ticks were lost after tick {recording.ticks[399]}" in replayed.stopped


def test_a_recording_without_its_beginning_is_not_replayed(recording: Recording) -> None:
    plain = Recording(recording.columns, about=recording.about)
    assert not plain.can_be_replayed
    with pytest.raises(OptionError, match="cannot be replayed"):
        plain.replay()
    late = Recording(rows(recording, slice(500, None)), tape=recording._tape, about=recording.about)
    with pytest.raises(RecordingFormatError, match="does not hold tick"):
        late.replay()


def test_an_empty_recording_has_figures(recording: Recording) -> None:
    empty = Recording(rows(recording, slice(0)))
    figures = (empty.seconds, empty.contact_share, empty.largest_force, empty.lost)
    assert figures == (0.0, 0.0, 0.0, 0)
    assert empty.events == []


# --- tables -----------------------------------------------------------------------------


def test_the_text_table_gives_the_same_bits_in_every_country(
    recording: Recording, tmp_path: Path, monkeypatch: Any
) -> None:
    monkeypatch.setattr(locale, "localeconv", lambda: {"decimal_point": ","})
    recording.to_csv(tmp_path / "ticks.csv")
    with (tmp_path / "ticks.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(recording)
    for prefix, column in (("proxy", "proxy"), ("force", "force"), ("sent", "sent_force")):
        unit = "mm" if prefix == "proxy" else "N"
        got = np.array([[float(row[f"{prefix}_{axis}_{unit}"]) for axis in "xyz"] for row in rows])
        np.testing.assert_array_equal(
            got.view(np.uint64),
            np.ascontiguousarray(by_name(recording.columns)[column]).view(np.uint64),
        )
    np.testing.assert_array_equal([float(row["time_s"]) for row in rows], recording.times)
    np.testing.assert_array_equal([int(row["contact"]) for row in rows], recording.contacts)
    np.testing.assert_array_equal([int(row["touched_segment"]) for row in rows], recording.touched)
    assert [row["event"] for row in rows] == recording.events


def test_the_numpy_table_opens_without_pickles(recording: Recording, tmp_path: Path) -> None:
    recording.to_npz(tmp_path / "ticks.npz")
    with np.load(tmp_path / "ticks.npz", allow_pickle=False) as table:
        for name in ("tick", "time", "device", "proxy", "orientation", "force", "sent_force"):
            np.testing.assert_array_equal(table[name], recording.columns[name])
        assert table["event"].tolist() == recording.events
