"""What the kernel tells of a browser's processor time."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from palpate.bench import processor_time
from palpate.bench.processor_time import spent

HERE = pytest.mark.skipif(not Path("/proc").is_dir(), reason="only Linux's kernel tells")


@HERE
def test_what_this_process_has_used_is_told() -> None:
    used = time.process_time()
    found = spent(os.getpid())
    # the kernel counts in hundredths
    assert found["rest"] > used - 0.03
    assert found["page"] == found["graphics"] == 0.0


@HERE
def test_children_count_by_what_they_are_for_and_strangers_do_not() -> None:
    # named as a browser names them, they use some time and wait
    work = "sum(range(3_000_000)); print('done', flush=True); input()"
    names = ("--type=renderer", "--type=gpu-process", "--type=utility")
    commands = ([sys.executable, "-c", work, name] for name in names)
    pipe = subprocess.PIPE
    children = [subprocess.Popen(one, stdin=pipe, stdout=pipe, text=True) for one in commands]
    try:
        for child in children:
            assert child.stdout is not None
            assert child.stdout.readline() == "done\n"
        mine = spent(os.getpid())
        assert mine["page"] > 0.0
        assert mine["graphics"] > 0.0
        # of the second alone
        other = spent(children[1].pid)
        assert other["graphics"] > 0.0
        assert other["page"] == other["rest"] == 0.0
    finally:
        for child in children:
            with child:
                child.kill()


def test_without_such_a_kernel_nothing_is_told(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(processor_time, "PROC", tmp_path / "none")
    assert spent(1) == {}
