"""Many cases, some broken, on two workers that are killed: none is lost or done twice.

The long form (PALPATE_LONG) has 200 whole cases, and one that never ends.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import psutil
import pytest
import SimpleITK
from made_cohort import BLOCK_RECIPE, write_block

LONG = bool(os.environ.get("PALPATE_LONG"))
WHOLE = 200 if LONG else 8
RECIPE = f"""\
import:
  path: '{{scan}}'
{BLOCK_RECIPE}\
compare:
  - reference: '{{reference}}'
    out: agreement.csv
touch:
  - at: superior
    depth: 1
    radius: 2
    material: fat
    speed: '{{speed}}'
    out: press.csv
"""
BROKEN = {
    "cut": "data/cut.nii.gz",
    "empty": "is empty; allowed",
    **({"endless": "took longer than the time limit of 60 s"} if LONG else {}),
    "grid": "lies on another grid than the scan",
    "nan": "",
}
"""Cases that fail, and what is told of them."""
COMMAND = [sys.executable, "-m", "palpate", "run", "recipe.yaml", "--table", "cases.csv"]
OPTIONS = ["--workers", "2", "--timeout", "60"]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Whole cases that differ, and one that fails in each way."""
    rows = ["case,scan,reference,speed"]
    for number in range(WHOLE):
        name = f"data/p{number:03}.nii.gz"
        write_block(tmp_path / name, 3 + number % 8, edge=14 + number // 8 % 8)
        rows.append(f"p{number:03},{name},{name.replace('p', 'm')},100")
        values = SimpleITK.ReadImage(str(tmp_path / name)) > 100
        SimpleITK.WriteImage(values, str(tmp_path / name.replace("p", "m")))
    whole = (tmp_path / "data" / "p000.nii.gz").read_bytes()
    (tmp_path / "data" / "cut.nii.gz").write_bytes(whole[: len(whole) // 2])
    (tmp_path / "data" / "empty.nii.gz").write_bytes(b"")
    for name in ("endless", "grid"):
        (tmp_path / "data" / f"{name}.nii.gz").write_bytes(whole)
    nothing = SimpleITK.GetImageFromArray(np.full((12, 12, 12), np.nan, np.float32))
    SimpleITK.WriteImage(nothing, str(tmp_path / "data" / "nan.nii.gz"))
    for name in BROKEN:
        reference = "other" if name == "grid" else "m000"
        # 40 min of touch, of which a second takes about one
        speed = "0.005" if name == "endless" else "100"
        rows.append(f"{name},data/{name}.nii.gz,data/{reference}.nii.gz,{speed}")
    mask = SimpleITK.ReadImage(str(tmp_path / "data" / "m000.nii.gz"))
    mask.SetSpacing((1.0, 1.0, 1.3))
    SimpleITK.WriteImage(mask, str(tmp_path / "data" / "other.nii.gz"))
    # those that fail stand among the others
    rows[1:] = sorted(rows[1:], key=lambda row: row[::-1])
    (tmp_path / "cases.csv").write_text("\n".join(rows) + "\n")
    (tmp_path / "recipe.yaml").write_text(RECIPE)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def done(out: Path) -> set[str]:
    return {path.parent.name for path in out.glob("*/done.json") if ".part" not in path.parent.name}


def made(out: Path) -> dict[str, bytes]:
    """Returns what cases wrote, but for times and memory."""
    files = (path for name in done(out) for path in (out / name).iterdir())
    return {
        path.relative_to(out).as_posix(): path.read_bytes()
        for path in files
        if path.name != "done.json"
    }


def started(out: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [*COMMAND, *OPTIONS, "-o", out],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def wait_until(count: int, out: Path, running: subprocess.Popen[str]) -> None:
    while len(done(out)) < count:
        assert running.poll() is None, running.communicate()
        time.sleep(0.05)


@pytest.mark.long
def test_none_is_lost_and_none_done_twice(folder: Path) -> None:
    running = started("calm")
    said, _ = running.communicate()
    assert running.returncode == 3, said
    assert f"{WHOLE} done, {len(BROKEN)} failed, 0 kept" in said
    calm = folder / "calm"
    for name, reason in BROKEN.items():
        told = json.loads((calm / name / "failed.json").read_text())["reason"]
        assert told
        assert reason in told
    assert len(done(calm)) == WHOLE

    # a worker is killed, then the run itself
    out = folder / "rough"
    running = started("rough")
    wait_until(max(1, WHOLE // 8), out, running)
    children = psutil.Process(running.pid).children(recursive=True)
    next(each for each in children if "spawn_main" in " ".join(each.cmdline())).kill()
    wait_until(WHOLE // 2, out, running)
    children = psutil.Process(running.pid).children(recursive=True)
    running.send_signal(signal.SIGKILL)
    running.communicate()
    # all that it started ends with it
    psutil.wait_procs(children, timeout=60.0)
    assert [each for each in children if each.is_running()] == []
    before = {name: (out / name / "done.json").read_bytes() for name in done(out)}
    assert len(before) >= WHOLE // 2
    failed = {path.parent.name for path in out.glob("*/failed.json")}

    running = started("rough")
    said, _ = running.communicate()
    assert running.returncode == 3, said
    assert f"{WHOLE - len(before)} done, {len(BROKEN)} failed, {len(before)} kept" in said
    assert failed <= BROKEN.keys()
    for name, told_before in before.items():
        assert (out / name / "done.json").read_bytes() == told_before
    assert not [*out.glob("*.part"), *out.glob("*.old")]
    assert made(out) == made(calm)
    table = (out / "cohort.csv").read_text().splitlines()[1:]
    assert len(table) == len({line.partition(",")[0] for line in table}) == WHOLE + len(BROKEN)
