"""Files of recordings: all comes back to the bit, and what is no recording is refused."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from palpate.base.errors import OptionError, RecordingFormatError
from palpate.session.recording import Recording
from palpate.session.recording_columns import SINCE_4, by_name
from palpate.session.recording_file import VERSION, read_file
from palpate.session.scripted_path import ScriptedPath
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene


@pytest.fixture
def saved(ball_scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A short recording of the ball with an edit."""
    path = ScriptedPath((20.0, 20.0, 40.0)).move((20.0, 20.0, 24.0), seconds=0.3)
    with Session(ball_scene, device=path, options=SessionOptions(real_time=False)) as session:
        session.start_recording()
        session.let_pass(0.25)
        session.fill_box(1, low=(18, 18, 26), high=(23, 23, 30), solid=False)
        session.let_pass(0.25)
        recording = session.stop_recording()
    file = tmp_path_factory.mktemp("saved") / "ball.palpate-session"
    recording.save(file)
    return file


def test_a_file_holds_all_of_a_recording(saved: Path) -> None:
    recording = Recording.load(saved)
    assert len(recording) == 500
    assert recording.replay().is_equal
    assert recording.about is not None
    assert recording.about.scan.name == "ball"
    assert recording.about.scan.dimensions == (41, 41, 41)
    assert [segment.name for segment in recording.about.segments] == ["ball"]
    assert recording.about.settings["stiffness"] > 0.0
    assert recording.about.device == "scripted"
    assert list(saved.parent.iterdir()) == [saved], "nothing unfinished is left"


def test_numpy_opens_a_file_by_itself(saved: Path) -> None:
    with np.load(saved, allow_pickle=False) as archive:
        assert archive["force"].shape == (500, 3)
        assert json.loads(archive["about"].tobytes())["format"] == "palpate-session"


def test_saving_again_gives_the_same_columns(saved: Path, tmp_path: Path) -> None:
    copy = tmp_path / "copy.palpate-session"
    Recording.load(saved).save(copy)
    with np.load(saved) as before, np.load(copy) as after:
        assert before.files == after.files
        for name in before.files:
            np.testing.assert_array_equal(
                before[name].view(np.uint8), after[name].view(np.uint8), err_msg=name
            )


def test_a_file_that_cannot_be_written_leaves_nothing(saved: Path, tmp_path: Path) -> None:
    recording = Recording.load(saved)
    with pytest.raises(FileNotFoundError):
        recording.save(tmp_path / "nowhere" / "x.palpate-session")
    (tmp_path / "folder").mkdir()
    with pytest.raises(OSError, match="directory"):
        recording.save(tmp_path / "folder")
    assert list(tmp_path.iterdir()) == [tmp_path / "folder"]
    with pytest.raises(OptionError, match="about"):
        Recording(recording.columns).save(tmp_path / "x.palpate-session")


# --- what is refused --------------------------------------------------------------------

Change = Callable[[dict[str, bytes]], None]


@pytest.fixture
def changed(saved: Path, tmp_path: Path) -> Callable[[Change], Path]:
    """Writes a copy with changed members."""

    def write(change: Change) -> Path:
        with zipfile.ZipFile(saved) as archive:
            members = {name: archive.read(name) for name in archive.namelist()}
        change(members)
        copy = tmp_path / "changed.palpate-session"
        with zipfile.ZipFile(copy, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, content in members.items():
                archive.writestr(name, content)
        return copy

    return write


def packed(array: Any) -> bytes:
    file = io.BytesIO()
    np.save(file, np.asarray(array), allow_pickle=False)
    return file.getvalue()


def about_with(**changes: Any) -> Change:
    def change(members: dict[str, bytes]) -> None:
        about = json.loads(np.load(io.BytesIO(members["about.npy"])).tobytes())
        text = json.dumps(about | changes).encode()
        members["about.npy"] = packed(np.frombuffer(text, np.uint8))

    return change


def put(name: str, array: Any) -> Change:
    return lambda members: members.update({f"{name}.npy": packed(array)})


def test_a_file_of_before_there_were_shares_is_read(
    saved: Path, changed: Callable[[Change], Path]
) -> None:
    def older(members: dict[str, bytes]) -> None:
        about_with(version=3)(members)
        for name in SINCE_4:
            members.pop(f"{name}.npy")

    old = changed(older)
    columns, tape, about = read_file(old)
    assert about.version == 3
    assert tape is not None
    assert len(tape["known_index"]) == len(tape["share_ends"]) == 0
    assert tape["share_bytes"].shape == (0, 512)
    np.testing.assert_array_equal(columns["force"], read_file(saved)[0]["force"])


@pytest.mark.parametrize("share", [0.0, 0.01, 0.5, 0.9, 0.999])
def test_a_cut_off_file_is_refused(saved: Path, tmp_path: Path, share: float) -> None:
    whole = saved.read_bytes()
    cut = tmp_path / "cut.palpate-session"
    cut.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(RecordingFormatError, match=r"cut off|damaged"):
        Recording.load(cut)


def test_a_damaged_byte_anywhere_is_refused_or_changes_nothing(saved: Path, tmp_path: Path) -> None:
    """Checksums cover all numbers; what they do not cover is names and dates of the archive."""
    whole = saved.read_bytes()
    before = Recording.load(saved)
    damaged = tmp_path / "damaged.palpate-session"
    random = np.random.default_rng(3)
    refused = 0
    for place in random.integers(0, len(whole), 150):
        copy = bytearray(whole)
        copy[place] ^= 1 << int(random.integers(0, 8))
        damaged.write_bytes(copy)
        try:
            after = Recording.load(damaged)
        except RecordingFormatError:
            refused += 1
            continue
        columns = by_name(after.columns)
        for name, column in by_name(before.columns).items():
            np.testing.assert_array_equal(column, columns[name], err_msg=name)
    assert refused > 100


def test_other_files_are_refused(tmp_path: Path, saved: Path) -> None:
    text = tmp_path / "note.txt"
    text.write_text("hello")
    with pytest.raises(RecordingFormatError, match="no recording"):
        Recording.load(text)
    archive = tmp_path / "other.npz"
    np.savez(archive, values=np.arange(3))
    with pytest.raises(RecordingFormatError, match="no recording"):
        Recording.load(archive)
    with pytest.raises(FileNotFoundError):
        Recording.load(tmp_path / "nothing.palpate-session")
    with pytest.raises(IsADirectoryError):
        Recording.load(saved.parent)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (about_with(format="other"), "of the form 'other'"),
        (about_with(version=VERSION + 1), f"version {VERSION + 1} of the form"),
        (about_with(scan=None), "no recording"),
        (put("about", np.frombuffer(b"\xff{", np.uint8)), "no recording"),
        (lambda members: members.pop("force.npy"), "lacks force"),
        (lambda members: members.pop("start.npy"), "lacks start"),
        (lambda members: members.pop("value_index.npy"), "lacks value_index"),
        (put("force", np.zeros((500, 2))), "force holds"),
        (put("force", np.zeros((499, 3))), "different length"),
        (put("tick", np.arange(500, dtype=np.int64)), "tick holds"),
        (put("tick", np.zeros((), np.uint64)), "tick holds"),
        (put("time", np.zeros(500, np.float32)), "time holds"),
        (put("proxy", np.zeros((500, 3), order="F")), "proxy has another form"),
    ],
)
def test_what_does_not_fit_is_refused_by_name(
    changed: Callable[[Change], Path], change: Change, reason: str
) -> None:
    with pytest.raises(RecordingFormatError, match=reason):
        Recording.load(changed(change))


def test_pickles_are_never_opened(changed: Callable[[Change], Path]) -> None:
    file = io.BytesIO()
    np.save(file, np.array([print, print], dtype=object), allow_pickle=True)
    with pytest.raises(RecordingFormatError, match=r"tick holds \|O"):
        Recording.load(changed(lambda members: members.update({"tick.npy": file.getvalue()})))


def test_an_archive_that_unpacks_to_too_much_is_refused(
    saved: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("palpate.session.recording_file.MOST_BYTES", 10_000)
    with pytest.raises(RecordingFormatError, match="unpacks to"):
        Recording.load(saved)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (put("start", np.zeros(10, np.uint8)), "state at the start cannot be read"),
        (put("commands", np.zeros(1, np.uint8)), "do not fit together"),
        (put("brick_index", np.zeros(3, np.uint32)), "do not fit together"),
        (put("solid_index", np.zeros(0, np.uint32)), "do not fit together"),
        (put("command", np.arange(500, dtype=np.uint64) * 1000), "has executed"),
    ],
)
def test_a_replay_of_what_does_not_belong_together_is_refused(
    changed: Callable[[Change], Path], change: Change, reason: str
) -> None:
    recording = Recording.load(changed(change))
    with pytest.raises(RecordingFormatError, match=reason):
        recording.replay()


def test_another_build_is_told(changed: Callable[[Change], Path]) -> None:
    replayed = Recording.load(changed(about_with(build="0" * 16))).replay()
    assert not replayed.same_build
    assert replayed.is_equal
