"""Journals that are set aside: whose they are, how long they stay, and ``palpate recover``."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import pytest
from made_scans import make_ball
from palpate.cli.commands import run
from palpate.saved import set_aside as module
from palpate.saved.journal import Journal
from palpate.saved.set_aside import KEPT_DAYS, MOMENT, set_aside
from palpate.session.session import Session, SessionOptions

STILL = SessionOptions(real_time=False)


@pytest.fixture
def state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of the program's state."""
    folder = tmp_path / "state"
    monkeypatch.setenv("PALPATE_STATE", str(folder))
    return folder


def changed(state: Path, z: int = 18, **options: Any) -> list[str]:
    """Makes one change in a session of the ball; returns what it told."""
    told: list[str] = []
    with Session(make_ball(), options=STILL) as session:
        journal = Journal(session, folder=state, tell=told.append)
        journal.start(**options)
        session.fill_box(1, low=(18, 18, z), high=(22, 22, z + 2), solid=False)
    journal.close()
    return told


def offered(state: Path) -> int | None:
    """Returns how many steps the next start offers."""
    with Session(make_ball(), options=STILL) as session:
        journal = Journal(session, folder=state, tell=lambda _: None)
        journal.start()
        offer = journal.offer
    journal.close()
    return None if offer is None else offer.steps


OTHER = """
import sys
import time
from pathlib import Path
from made_scans import make_ball
from palpate.saved.journal import Journal
from palpate.session.session import Session, SessionOptions

with Session(make_ball(), options=SessionOptions(real_time=False)) as session:
    journal = Journal(session, folder=Path(sys.argv[1]))
    journal.start()
    print("ready", journal.offer is not None, flush=True)
    sys.stdin.readline()
    journal.decide(bring_back=True)
    before = journal.path.stat().st_size
    session.fill_box(1, low=(18, 18, 25), high=(22, 22, 27), solid=False)
    # a change is written within a moment, by a thread of its own
    for _ in range(1200):
        if journal.path.stat().st_size > before:
            break
        time.sleep(0.05)
    print("changed", journal.is_running, flush=True)
    sys.stdin.readline()
"""


@pytest.fixture
def other(state: Path) -> Iterator[subprocess.Popen[str]]:
    """Another process that has the ball open, and is asked whether to bring changes back."""
    changed(state)
    support = Path(__file__).parents[1] / "support"
    process = subprocess.Popen(
        [sys.executable, "-c", OTHER, str(state)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(support), *sys.path])},
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "ready True\n"
    yield process
    process.kill()
    process.communicate()


@pytest.mark.parametrize("answer", ["yes", "no", "none yet"])
def test_no_answer_here_takes_the_journal_of_another_process(
    state: Path, other: subprocess.Popen[str], answer: str
) -> None:
    assert other.stdin is not None
    assert other.stdout is not None
    recover = {"yes": True, "no": False}.get(answer)
    before = sorted(path.name for path in state.rglob("*"))
    # it is asked, and nobody has answered yet
    (told,) = changed(state, recover=recover)
    assert "open in another session" in told
    assert sorted(path.name for path in state.rglob("*")) == before
    other.stdin.write("bring back\n")
    other.stdin.flush()
    assert other.stdout.readline() == "changed True\n"
    # it writes
    (told,) = changed(state, recover=recover)
    assert "open in another session" in told
    # whatever happens to it, its changes are offered
    other.kill()
    other.wait()
    assert offered(state) == 2
    assert set_aside(state) == []


def test_what_was_declined_is_listed_and_can_be_put_back(
    state: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["recover"]) == 0
    assert capsys.readouterr().out == "nothing is set aside\n"
    changed(state)
    told = changed(state, z=22, recover=False)
    assert f"`palpate recover` in a terminal lists them for {KEPT_DAYS} days" in told[0]
    (one,) = set_aside(state)
    assert run(["recover"]) == 0
    listed = capsys.readouterr().out
    assert one.name in listed
    assert make_ball().volume.name in listed
    assert run(["recover", "--json"]) == 0
    (row,) = json.loads(capsys.readouterr().out)
    assert row["name"] == one.name
    assert row["bytes"] == one.bytes > 0

    assert run(["recover", "--restore", one.name[:8]]) == 0
    assert "is offered at the next start: open its scan again" in capsys.readouterr().out
    assert offered(state) == 1
    # what was offered before is in its place
    (instead,) = set_aside(state)
    assert instead.name != one.name
    assert run(["recover", "--remove", instead.name]) == 0
    assert set_aside(state) == []
    assert offered(state) == 1


def test_what_is_named_wrongly_is_told_and_nothing_changes(
    state: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for z in (18, 22, 25):
        changed(state, z=z, recover=False)
    first, second = set_aside(state)
    before = sorted(path.name for path in state.rglob("*"))
    for name in ("x", "", first.name[:4]):
        assert run(["recover", "--remove", name]) == 2
        assert f"{first.name}, {second.name}" in capsys.readouterr().err
    assert run(["recover", "--remove", first.name, "--restore", first.name]) == 2
    assert sorted(path.name for path in state.rglob("*")) == before


def test_a_journal_is_not_put_back_under_an_open_scan(
    state: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    changed(state)
    changed(state, recover=False)
    (one,) = set_aside(state)
    with Session(make_ball(), options=STILL) as session:
        journal = Journal(session, folder=state, tell=lambda _: None)
        journal.start()
        assert run(["recover", "--restore", one.name]) == 2
        assert "open in another session" in capsys.readouterr().err
    journal.close()
    assert set_aside(state) == [one]


def aged(state: Path, days: float) -> None:
    """Has what was set aside last have been so for some days."""
    one = set_aside(state)[0]
    moment = (datetime.now().astimezone() - timedelta(days=days)).strftime(MOMENT)
    for path in one.files:
        path.rename(path.with_name(path.name.replace(one.name, moment)))


def test_what_is_old_or_beyond_the_limit_is_removed_and_told(
    state: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    changed(state)
    changed(state, recover=False)
    aged(state, KEPT_DAYS + 1)
    changed(state, recover=False)
    aged(state, KEPT_DAYS - 1)
    assert len(set_aside(state)) == 1, "a start removes what is too old"
    changed(state, recover=False)
    assert len(set_aside(state)) == 2
    monkeypatch.setattr(module, "MOST_BYTES", set_aside(state)[0].bytes)
    told = changed(state)
    assert told[0].startswith("1 journal that was set aside")
    assert len(set_aside(state)) == 1
    # the newest one stays, however large
    monkeypatch.setattr(module, "MOST_BYTES", 1)
    changed(state)
    assert len(set_aside(state)) == 1


def test_nobody_else_can_read_what_is_set_aside(state: Path) -> None:
    changed(state)
    changed(state, recover=False)
    if os.name == "posix":
        assert (state / "journals").stat().st_mode & 0o077 == 0
