"""``palpate record`` and ``palpate replay`` as a person meets them."""

from __future__ import annotations

import csv
import json
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any, cast
from urllib.parse import urlsplit

import msgspec
import numpy as np
import pytest
from palpate.session.recording import Recording
from palpate.session.recording_columns import TickColumns, by_name
from running_server import PATIENCE, page_at

COMMAND = [sys.executable, "-m", "palpate"]


def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*COMMAND, *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=300.0,
        check=False,
    )


def fails(*arguments: str | Path) -> str:
    """Runs what has to fail; returns the one line it says."""
    done = run(*arguments)
    assert done.returncode == 2, done.stderr
    assert done.stdout == ""
    (line,) = done.stderr.splitlines()
    assert line.startswith("palpate: ")
    return line


@pytest.fixture
def scan(write_image: Any) -> Path:
    """A block of 400 HU in air."""
    values = np.full((24, 25, 26), -1000, np.int16)
    values[8:16, 8:16, 8:16] = 400
    path: Path = write_image(values, "block.nrrd", spacing=(1.0, 1.0, 1.0))
    return path


@pytest.fixture
def script(tmp_path: Path) -> Path:
    """Onto the block, along it and away."""
    file = tmp_path / "path.csv"
    file.write_text("time_s,x,y,z\n0,12,12,20\n0.5,12,12,13\n1.0,14,11,13\n1.5,12,12,20\n")
    return file


@pytest.fixture
def recorded(scan: Path, script: Path, tmp_path: Path) -> Path:
    out = tmp_path / "block.palpate-session"
    done = run("record", scan, "--threshold", "0", "--script", script, "--out", out)
    assert done.returncode == 0, done.stderr
    assert "1.5 s (1500 ticks)" in done.stdout
    assert "in contact" in done.stdout
    return out


def test_a_scripted_session_is_recorded_and_replayed_to_the_bit(recorded: Path) -> None:
    done = run("replay", recorded)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    lines = done.stdout.splitlines()
    assert lines[-1] == "EQUAL"
    told = dict(line.split(maxsplit=1) for line in lines if line.startswith(("scan", "ticks")))
    assert told["ticks"] == "1499 of 1500 replayed"


def test_the_figures_are_told_to_programs(recorded: Path) -> None:
    done = run("replay", recorded, "--json")
    assert done.returncode == 0
    told = json.loads(done.stdout)
    assert told["equal"] is True
    assert told["recorded_hash"] == told["replayed_hash"]
    assert told["ticks"] == 1499
    assert told["lost_ticks"] == 0
    assert told["seconds"] == pytest.approx(1.498, abs=1e-9)
    assert 0.3 < told["contact_share"] < 0.9
    assert told["largest_force"] > 1.0
    assert told["stopped"] == ""


def test_tables_are_written_beside(recorded: Path, tmp_path: Path) -> None:
    table, arrays = tmp_path / "t.csv", tmp_path / "t.npz"
    assert run("replay", recorded, "--csv", table, "--npz", arrays).returncode == 0
    with table.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 1500
    with np.load(arrays) as opened:
        force = [[float(row[f"force_{axis}_N"]) for axis in "xyz"] for row in rows]
        np.testing.assert_array_equal(force, opened["force"])


def test_seconds_end_a_script_early_or_hold_its_end(
    scan: Path, script: Path, tmp_path: Path
) -> None:
    for seconds, ticks in (("0.25", 250), ("2", 2000)):
        out = tmp_path / f"{ticks}.palpate-session"
        arguments = ("--threshold", "0", "--script", script, "--seconds", seconds)
        assert run("record", scan, *arguments, "--out", out).returncode == 0
        assert len(Recording.load(out)) == ticks


def test_what_differs_is_told_with_exit_code_1(recorded: Path, tmp_path: Path) -> None:
    recording = Recording.load(recorded)
    row = int(np.flatnonzero(recording.contacts)[20])
    forces = recording.forces.copy()
    forces[row, 2] += 1e-9
    changed = tmp_path / "changed.palpate-session"
    columns = recording.columns | {"force": forces}
    Recording(columns, tape=recording._tape, about=recording.about).save(changed)
    done = run("replay", changed)
    assert done.returncode == 1
    assert done.stdout.splitlines()[-1] == "DIFFERENT"
    assert f"tick {recording.ticks[row]} at" in done.stdout
    told = json.loads(run("replay", changed, "--json").stdout)
    assert told["equal"] is False
    assert told["different"] == 1
    assert told["first_difference"]["force"] == pytest.approx(1e-9, rel=0.1)

    # by another build that is nothing wrong
    assert recording.about is not None
    other = msgspec.structs.replace(recording.about, build="another")
    changed.unlink()
    Recording(columns, tape=recording._tape, about=other).save(changed)
    done = run("replay", changed)
    assert done.returncode == 0
    assert "another build recorded this" in done.stderr
    assert done.stdout.splitlines()[-1] == "DIFFERENT"


def test_lost_ticks_are_warned_of(recorded: Path, tmp_path: Path) -> None:
    recording = Recording.load(recorded)
    kept = np.r_[0:700, 900:1500]
    columns = {name: column[kept] for name, column in by_name(recording.columns).items()}
    gappy = tmp_path / "gappy.palpate-session"
    Recording(cast("TickColumns", columns), tape=recording._tape, about=recording.about).save(gappy)
    done = run("replay", gappy)
    assert done.returncode == 0
    assert "not complete: 200 ticks were lost after tick 699" in done.stderr
    assert "699 of 1300 replayed" in done.stdout


# --- bad input --------------------------------------------------------------------------


def test_files_that_are_no_recordings_are_one_line(recorded: Path, tmp_path: Path) -> None:
    assert "nothing.x does not exist; allowed: an existing file" in fails(
        "replay", tmp_path / "nothing.x"
    )
    assert "directory" in fails("replay", tmp_path)
    cut = tmp_path / "cut.palpate-session"
    cut.write_bytes(recorded.read_bytes()[:2000])
    assert "cut off" in fails("replay", cut)
    other = tmp_path / "other.npz"
    np.savez(other, a=np.zeros(3))
    assert "is no recording" in fails("replay", other)
    empty = tmp_path / "empty"
    empty.touch()
    assert "is no recording" in fails("replay", empty)


@pytest.mark.long
def test_what_cannot_be_recorded_is_one_line(scan: Path, script: Path, tmp_path: Path) -> None:
    out = tmp_path / "new.palpate-session"
    record = ("record", scan, "--threshold", "0", "--script", script, "--out")
    assert "is what is read" in fails(*record, script)
    assert "is no folder" in fails(*record, tmp_path / "nowhere" / "x")
    assert "allowed: more than 0" in fails(*record, out, "--seconds", "-1")
    assert "allowed: more than 0" in fails(*record, out, "--seconds", "nan")
    assert "allowed: 1000 or 4000" in fails(*record, out, "--rate", "7")
    assert "allowed: a .csv or .json" in fails("record", scan, "--script", scan, "--out", out)
    bad = tmp_path / "bad.json"
    bad.write_text("[[0, 1, 2]]")
    assert "allowed: rows of time" in fails("record", scan, "--script", bad, "--out", out)
    assert "--out" in fails("record", scan)
    assert not out.exists()


# --- with a page ------------------------------------------------------------------------


@pytest.mark.parametrize("ending", [None, signal.SIGINT, signal.SIGTERM])
def test_a_live_session_is_recorded_until_it_ends(
    scan: Path, tmp_path: Path, ending: signal.Signals | None
) -> None:
    out = tmp_path / "live.palpate-session"
    options = ["--seconds", "3"] if ending is None else []
    arguments = ["record", str(scan), "--threshold", "0", "--out", str(out), "--no-browser"]
    process = subprocess.Popen(
        [*COMMAND, *arguments, *options],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout is not None
        url = next(line.strip() for line in process.stdout if line.startswith("http://"))
        if ending is not None:
            parts = urlsplit(url)
            address = f"{parts.netloc}/api/live?{parts.query}"
            assert parts.port is not None
            with page_at(address, parts.port, origin=f"http://{parts.netloc}") as page:
                page.receive("state", until=lambda m: m["recording"] > 0.1)
            process.send_signal(ending)
        told, problems = process.communicate(timeout=PATIENCE)
    finally:
        process.kill()
        process.communicate()
    assert process.returncode == 0, problems
    assert f"{out}: " in told
    recording = Recording.load(out)
    assert recording.about is not None
    assert recording.about.real_time
    assert len(recording) > 0
    assert recording.replay().is_equal
