"""``palpate open`` ends by any signal that asks it to as by Ctrl-C."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import numpy as np
import pytest
from palpate.session.recording import Recording
from running_server import PATIENCE, page_at

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
