"""What is freed goes back to the system."""

from __future__ import annotations

import subprocess
import sys

import pytest

WORK = """\
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier

import numpy as np

from palpate.base.freed_memory import give_freed_memory_back

if sys.argv[1] == "back":
    give_freed_memory_back()


def resident():
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096 / 2**20


together = Barrier(8)


def work(_):
    # a large block that was freed has glibc take the next ones from its arenas
    np.ones(30 << 20, np.uint8)
    together.wait()
    blocks = [np.ones(8 << 20, np.uint8) for _ in range(6)]
    kept = np.ones(60_000, np.uint8)
    del blocks
    return kept


with ThreadPoolExecutor(8) as pool:
    before = resident()
    kept = list(pool.map(work, range(8)))
    print(resident() - before)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="settings of glibc")
def test_blocks_that_threads_have_freed_go_back_to_the_system() -> None:
    assert kept_after("as it is") > 100
    assert kept_after("back") < 30


def kept_after(how: str) -> float:
    """Returns what stays of 384 MiB that eight threads had [MiB]."""
    done = subprocess.run(
        [sys.executable, "-c", WORK, how], capture_output=True, text=True, check=True
    )
    return float(done.stdout)
