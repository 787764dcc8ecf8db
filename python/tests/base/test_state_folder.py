"""Where the program keeps its state, and small files in it."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from palpate.base.state_folder import keep, kept, private_folder, state_folder


def test_the_folder_is_the_users_unless_said_otherwise(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PALPATE_STATE", "/somewhere")
    assert state_folder() == Path("/somewhere")
    monkeypatch.delenv("PALPATE_STATE")
    monkeypatch.setenv("XDG_STATE_HOME", "/state")
    if sys.platform == "linux":
        assert state_folder() == Path("/state/palpate")


def test_what_was_kept_is_there_and_what_is_damaged_or_refused_is_not(tmp_path: Path) -> None:
    path = tmp_path / "new" / "numbers.json"
    assert kept(path, list[int]) is None
    keep(path, [1, 2])
    assert kept(path, list[int]) == [1, 2]
    assert kept(path, list[str]) is None, "numbers are no words"
    path.write_bytes(b"[1, 2")
    assert kept(path, list[int]) is None
    # a file stands where the folder would be
    keep(path / "below" / "more.json", [3])
    assert path.read_bytes() == b"[1, 2"


@pytest.mark.skipif(sys.platform == "win32", reason="modes are those of POSIX")
def test_no_other_user_can_read_the_state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def mode(path: Path) -> int:
        return path.stat().st_mode & 0o777

    monkeypatch.setenv("PALPATE_STATE", str(tmp_path / "state"))
    keep(state_folder() / "scans" / "head.json", ["a mark"])
    made = (state_folder(), state_folder() / "scans", state_folder() / "scans" / "head.json")
    assert [mode(path) for path in made] == [0o700, 0o700, 0o600]
    # one that an earlier version left open is closed, but not a folder that the user has named
    journals = state_folder() / "journals"
    journals.mkdir(mode=0o755)
    state_folder().chmod(0o755)
    private_folder(journals)
    keep(state_folder() / "recent.json", [])
    assert [mode(journals), mode(state_folder())] == [0o700, 0o755]
    assert mode(state_folder() / "recent.json") == 0o600
