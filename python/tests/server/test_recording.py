"""Recordings that pages begin and end, and fetch."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import httpx
import pytest
from palpate.base.errors import OptionError
from palpate.server.recording import Recorder
from palpate.session.recording import Recording
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene
from running_server import PATIENCE

OFFLINE = SessionOptions(real_time=False)


def test_a_page_records_what_it_does_and_fetches_the_file(server: Any, tmp_path: Path) -> None:
    assert server.get("/api/recording").status_code == 404
    with server.page() as page:
        page.send({"type": "record", "on": True})
        page.receive("state", until=lambda m: m["recording"] is not None)
        page.send({"type": "place", "point": [20.0, 20.0, 34.0]})
        page.send({"type": "hand", "target": [20.0, 20.0, 24.0]})
        page.receive("state", until=lambda m: m["contact"] and m["recording"] > 0.2)
        server.session.fill_box(1, low=(18, 18, 26), high=(23, 23, 30), solid=False)
        page.receive("state", until=lambda m: m["proxy"][2] < 27.0)
        page.send({"type": "record", "on": False})
        notice = page.receive("notice", until=lambda m: m["text"].startswith("Recorded"))
        assert notice["level"] == "info"
        assert "in contact" in notice["text"]
        page.receive("state", until=lambda m: m["recording"] is None)

    answer = server.get("/api/recording")
    assert answer.status_code == 200
    assert 'filename="ball.palpate-session"' in answer.headers["content-disposition"]
    file = tmp_path / "fetched.palpate-session"
    file.write_bytes(answer.content)
    recording = Recording.load(file)
    replayed = recording.replay()
    assert replayed.is_equal
    assert recording.contacts.any()
    assert any("edit" in event for event in recording.events)


def test_a_file_that_is_being_written_is_waited_for(server: Any, tmp_path: Path) -> None:
    with server.page() as page:
        for _ in range(3):
            page.send({"type": "record", "on": True})
            page.receive("state", until=lambda m: m["recording"] is not None)
            started = page.receive("state", until=lambda m: (m["recording"] or 0.0) > 0.1)["time"]
            page.send({"type": "record", "on": False})
            page.receive("state", until=lambda m: m["recording"] is None)
            # at once, before the notice that it is there
            file = tmp_path / "fetched"
            file.write_bytes(server.get("/api/recording").content)
            assert Recording.load(file).times[-1] >= started


def test_only_one_recording_runs_at_a_time(server: Any) -> None:
    with server.page() as first, server.page() as second:
        first.send({"type": "record", "on": True})
        second.receive("state", until=lambda m: m["recording"] is not None)
        second.send({"type": "record", "on": True})
        second.receive("notice", until=lambda m: "runs already" in m["text"])
        # any page may end it
        second.send({"type": "record", "on": False})
        first.receive("notice", until=lambda m: m["text"].startswith("Recorded"))
        first.send({"type": "record", "on": False})
        first.receive("notice", until=lambda m: "no recording runs" in m["text"])


def test_a_recording_is_for_those_who_are_let_in(server: Any) -> None:
    answer = httpx.get(f"{server.base}/api/recording", trust_env=False, timeout=PATIENCE)
    assert answer.status_code == 403


def test_the_newest_recording_is_kept_until_the_end(ball_scene: Scene, tmp_path: Path) -> None:
    with Session(ball_scene, options=OFFLINE) as session:
        recorder = Recorder(session)
        recorder.close()
        files = []
        for seconds in (0.1, 0.15, 0.2):
            recorder.start()
            session.let_pass(seconds)
            assert f"({1000 * seconds:.0f} ticks)" in recorder.stop()
            file = recorder.newest()
            assert file is not None
            files.append(file)
        # the one before the last may be on its way to a page
        assert [file.exists() for file in files] == [False, True, True]
        recorder.keep(tmp_path / "kept")
        recorder.close()
        assert not files[2].parent.exists()
        assert recorder.newest() is None
    assert len(Recording.load(tmp_path / "kept")) == 200
    with pytest.raises(OptionError, match="no recording runs"):
        recorder.stop()


def test_a_recording_can_be_ended_after_its_session(ball_scene: Scene) -> None:
    with Session(ball_scene, options=OFFLINE) as session:
        recorder = Recorder(session)
        recorder.start()
        session.let_pass(0.3)
    assert "300 ticks" in recorder.stop()
    recorder.close()


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("CT of \n a/head: 1", "CT-of-a-head-1.palpate-session"),
        ("..", "session.palpate-session"),
        ("", "session.palpate-session"),
        ("x" * 300, "x" * 60 + ".palpate-session"),
    ],
)
def test_names_of_files_are_names_of_files(
    ball_scene: Scene, monkeypatch: pytest.MonkeyPatch, name: str, expected: str
) -> None:
    with Session(ball_scene, options=OFFLINE) as session:
        monkeypatch.setattr(type(session.scene.volume), "name", name)
        assert Recorder(session).file_name == expected
