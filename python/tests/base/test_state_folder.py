"""Where the program keeps its state, and small files in it."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from palpate.base.state_folder import keep, kept, state_folder


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
