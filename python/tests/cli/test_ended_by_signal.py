"""Commands end by any signal that asks them to as by Ctrl-C, and leave nothing behind."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic, sleep
from typing import Any
from urllib.parse import urlsplit

import numpy as np
import pytest
from palpate.server.security import Access
from palpate.server.workbench import Workbench
from palpate.session.recording import Recording
from running_server import PATIENCE, LibraryClient, page_at

AS_FROM_A_TERMINAL = (
    "import os, signal, sys;"
    "[signal.signal(each, signal.SIG_DFL) for each in (signal.SIGINT, signal.SIGHUP)];"
    "os.execv(sys.executable, [sys.executable, *sys.argv[1:]])"
)
"""Whoever runs these tests may ignore signals, which processes hand on."""


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such signals")
@pytest.mark.parametrize("ending", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_keeps_the_recording_that_runs(
    write_image: Any, tmp_path: Path, ending: signal.Signals
) -> None:
    values = np.full((12, 12, 12), -1000, np.int16)
    values[4:8, 4:8, 4:8] = 400
    scan = write_image(values, "block.nrrd", spacing=(1.0, 1.0, 1.0))
    here = tmp_path / "here"
    here.mkdir()
    command = ["open", str(scan), "--threshold", "0", "--no-browser"]
    process = subprocess.Popen(
        [sys.executable, "-c", AS_FROM_A_TERMINAL, "-m", "palpate", *command],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        cwd=here,
        env=os.environ | {"PALPATE_STATE": str(tmp_path / "state")},
    )
    try:
        assert process.stdout is not None
        url = next(line.strip() for line in process.stdout if line.startswith("http://"))
        parts = urlsplit(url)
        assert parts.port is not None
        address = f"{parts.netloc}/api/live?{parts.query}"
        with page_at(address, parts.port, origin=f"http://{parts.netloc}") as page:
            page.send({"type": "record", "on": True})
            page.receive("state", until=lambda m: m["recording"] is not None)
            page.receive("state", until=lambda m: m["recording"] > 0.05)
            process.send_signal(ending)
            process.communicate(timeout=PATIENCE)
    finally:
        process.kill()
        process.communicate()
    assert process.returncode == 0
    (kept,) = here.iterdir()
    assert len(Recording.load(kept)) > 0


@pytest.fixture
def room(tmp_path: Path) -> Path:
    """A folder for temporary files."""
    folder = tmp_path / "room"
    folder.mkdir()
    return folder


@contextmanager
def started(room: Path, *command: str) -> Iterator[subprocess.Popen[str]]:
    """A command whose temporary files lie in this room."""
    process = subprocess.Popen(
        [sys.executable, "-c", AS_FROM_A_TERMINAL, "-m", "palpate", *command],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        cwd=room.parent,
        env=os.environ | {"PALPATE_STATE": str(room.parent / "state"), "TMPDIR": str(room)},
    )
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


@contextmanager
def with_dropped_scan(room: Path, name: str) -> Iterator[subprocess.Popen[str]]:
    """``palpate open`` where a scan was dropped on its page."""
    with started(room, "open", "--no-browser") as process:
        assert process.stdout is not None
        url = next(line.strip() for line in process.stdout if line.startswith("http://"))
        parts = urlsplit(url)
        assert parts.port is not None
        access = Access(port=parts.port, token=parts.query.removeprefix("token="))
        LibraryClient(access, Workbench()).upload({name: b"of a patient"})
        assert len(list(room.rglob(name))) == 1
        yield process


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such signals")
@pytest.mark.parametrize("ending", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_a_long_command_which_leaves_nothing(
    room: Path, ending: signal.Signals
) -> None:
    with started(room, "scenario", "palpation", "--places", "200") as process:
        begun = monotonic()
        while not list(room.glob("palpate-files-*/lock")):
            assert monotonic() - begun < PATIENCE
            sleep(0.01)
        process.send_signal(ending)
        told, _ = process.communicate(timeout=PATIENCE)
    assert process.returncode == 130, told
    assert "Traceback" not in told
    assert list(room.iterdir()) == []


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such signals")
def test_what_a_killed_process_left_goes_at_the_next_start_and_nothing_else(
    write_image: Any, room: Path
) -> None:
    scan = write_image(np.zeros((4, 4, 4), np.int16), "scan.nrrd", spacing=(1.0, 1.0, 1.0))
    foreign = room / "palpate-files-foreign0"
    foreign.mkdir()
    (foreign / "note.txt").write_text("without a lock nobody knows whose it is")
    with with_dropped_scan(room, "lives.nii") as alive:
        with with_dropped_scan(room, "killed.nii") as killed:
            killed.kill()
            killed.wait(PATIENCE)
        assert len(list(room.rglob("killed.nii"))) == 1
        with started(room, "info", str(scan)) as after:
            told, _ = after.communicate(timeout=PATIENCE)
            assert after.returncode == 0, told
        assert list(room.rglob("killed.nii")) == []
        assert len(list(room.rglob("lives.nii"))) == 1
        # only its user can look into it
        (folder,) = {path.parent.parent for path in room.rglob("lives.nii")}
        assert folder.stat().st_mode & 0o077 == 0
        alive.terminate()
        told, _ = alive.communicate(timeout=PATIENCE)
        assert alive.returncode == 0, told
    assert list(room.iterdir()) == [foreign]


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such signals")
def test_ctrl_c_that_came_while_a_string_was_executed_is_an_end_in_order(tmp_path: Path) -> None:
    (tmp_path / "stopped.py").write_text(
        "import palpate.cli.commands as commands\n"
        "from palpate.cli import main\n"
        "def stopped(_):\n"
        "    try:\n"
        # as the standard library makes each dataclass
        "        exec('raise KeyboardInterrupt')\n"
        "    except KeyboardInterrupt:\n"
        "        return 130\n"
        "commands.run = stopped\n"
        "main()\n"
    )
    # only a module that is run as one ends so
    ended = subprocess.run([sys.executable, "-m", "stopped"], cwd=tmp_path, check=False)
    assert ended.returncode == 130


def test_ctrl_c_before_the_first_array_of_the_engine_is_no_panic() -> None:
    program = (
        "import os, signal, threading\n"
        "from palpate.volumes.phantom import phantom\n"
        "import palpate.segmentation, palpate.volumes.volume\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        # while the engine works, which takes a second
        "threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)).start()\n"
        "try:\n"
        "    phantom()\n"
        "except KeyboardInterrupt:\n"
        "    print('stopped')\n"
    )
    ended = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert ended.stdout == "stopped\n", ended.stderr
