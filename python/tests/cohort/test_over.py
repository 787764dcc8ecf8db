"""One recipe over many scans: whole cases are kept, broken ones are told, the rest goes on."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier
from typing import Any
from uuid import uuid4

import numpy as np
import pytest
from made_cohort import BLOCK_RECIPE, write_block
from palpate.base.errors import OptionError
from palpate.cli.commands import run
from palpate.cohort.case import Case, share_of
from palpate.cohort.case_figures import measured_segments
from palpate.cohort.case_process import CaseProcess
from palpate.cohort.matches import cases_over
from palpate.cohort.output_folder import CohortFolder
from palpate.cohort.table import cases_of_table
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for number in (1, 2, 3):
        write_block(tmp_path / "data" / f"p{number}" / "ct.nii.gz", 3 + number)
    (tmp_path / "recipe.yaml").write_text(BLOCK_RECIPE, "utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def over(*more: str) -> int:
    return run(["run", "recipe.yaml", "--over", "data/*/ct.nii.gz", "-o", "out", *more])


def content(folder: Path) -> dict[str, bytes]:
    files = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def test_broken_scans_are_told_and_the_rest_is_done_and_kept(folder: Path, capsys: Any) -> None:
    whole = (folder / "data" / "p1" / "ct.nii.gz").read_bytes()
    for name, damaged in (("empty", b""), ("cut", whole[: len(whole) // 2])):
        (folder / "data" / name).mkdir()
        (folder / "data" / name / "ct.nii.gz").write_bytes(damaged)
    assert over() == 3
    said = capsys.readouterr()
    assert "3 done, 2 failed, 0 kept" in said.out
    assert "cut failed: " in said.err
    assert json.loads((folder / "out" / "empty" / "failed.json").read_text())["reason"]
    told = json.loads((folder / "out" / "p2" / "done.json").read_text())
    assert list(told["segments"]) == ["block"]
    assert told["segments"]["block"]["volume_ml"] == pytest.approx(5 * 36 / 1000)
    assert told["files"] == ["block.stl", "labels.nii.gz"]
    assert not list((folder / "out").glob("*.part"))

    # a rerun keeps what is done to the byte, and takes what was mended and what changed
    (folder / "data" / "cut" / "ct.nii.gz").write_bytes(whole)
    write_block(folder / "data" / "p3" / "ct.nii.gz", 8)
    before = content(folder / "out" / "p1")
    assert over("--dry-run") == 0
    assert capsys.readouterr().out == "cut\nempty\np3\n3 to run, 2 kept\n"
    assert over() == 3
    assert "2 done, 1 failed, 2 kept" in capsys.readouterr().out
    assert content(folder / "out" / "p1") == before
    # same case, same bytes
    made = content(folder / "out" / "cut")
    assert {name: made[name] for name in ("block.stl", "labels.nii.gz")} == {
        name: before[name] for name in ("block.stl", "labels.nii.gz")
    }


def test_a_case_over_its_time_fails_alone_and_is_tried_again_on_demand(
    folder: Path, capsys: Any
) -> None:
    assert over("--timeout", "0.001", "--shard", "1/3") == 3
    assert "p1 failed: took longer than the time limit of 0.001 s" in capsys.readouterr().err
    # which of the others were ever run does not matter
    assert over("--only-failed") == 0
    told = capsys.readouterr().out.splitlines()
    assert told[:2] == ["1 to run, 2 left out", "1 done, 0 failed, 2 left out"]
    assert not (folder / "out" / "p1" / "failed.json").exists()


@pytest.mark.usefixtures("folder")
def test_a_case_over_its_memory_fails_alone(capsys: Any) -> None:
    assert over("--memory", "0.001", "--shard", "1/3") == 3
    said = capsys.readouterr()
    assert "p1 failed: not enough memory; a higher memory limit" in said.err
    assert "0 done, 1 failed" in said.out


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux counts the memory of a process")
@pytest.mark.parametrize("memory", ["0.115", "0.12", "0.125"])
@pytest.mark.usefixtures("folder")
def test_a_case_ends_wherever_its_memory_runs_out(
    memory: str, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    # with which the engine stood still where it told of a panic without memory
    monkeypatch.setenv("RUST_BACKTRACE", "1")
    assert over("--memory", memory, "--timeout", "60", "--shard", "1/3") in (0, 3)
    assert "took longer" not in capsys.readouterr().err


def test_a_memory_limit_that_nothing_would_keep_to_is_refused(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    with monkeypatch.context() as elsewhere:
        elsewhere.setattr(sys, "platform", "darwin")
        assert over("--memory", "4") == 2
    assert "only Linux has one" in capsys.readouterr().err
    assert not (folder / "out").exists()


def test_a_signal_ends_its_case_and_is_named(tmp_path: Path) -> None:
    process = CaseProcess()
    os.kill(process._process.pid, signal.SIGKILL)
    reason = process.run({}, tmp_path, timeout=None)
    assert reason == "its process was ended by SIGKILL; the system does so where memory runs out"


def test_a_run_that_was_killed_goes_on_where_it_was(folder: Path) -> None:
    command = [sys.executable, "-m", "palpate", "run", "recipe.yaml"]
    running = subprocess.Popen(
        [*command, "--over", "data/*/ct.nii.gz", "-o", "out"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    while not (folder / "out" / "p1" / "done.json").exists():
        assert running.poll() is None
        time.sleep(0.01)
    os.kill(running.pid, signal.SIGKILL)
    running.wait()
    before = content(folder / "out" / "p1")
    assert over() == 0
    assert content(folder / "out" / "p1") == before
    done = sorted(path.parent.name for path in (folder / "out").glob("*/done.json"))
    assert done == ["p1", "p2", "p3"]


def test_a_full_disk_is_told_and_the_same_command_goes_on(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for number in (1, 2, 3):
        write_block(folder / "data" / f"p{number}" / "ct.nii.gz", 3 + number, edge=32)
    (folder / "out").mkdir()

    def disk(*options: str) -> subprocess.CompletedProcess[bytes]:
        command = ["mount", "-t", "tmpfs", "-o", *options, "tmpfs", "out"]
        return subprocess.run(command, check=False, capture_output=True)

    if disk("size=64k").returncode != 0:
        pytest.skip("a small disk cannot be mounted here: this needs root")
    try:
        assert over() in (2, 3)
        assert "no space is left on the disk; the same command" in capsys.readouterr().err
        assert not list((folder / "out").glob("*.part/done.json"))
        assert disk("remount,size=8m").returncode == 0
        assert over() == 0
        assert len(list((folder / "out").glob("*/done.json"))) == 3
        assert not list((folder / "out").glob("*/failed.json"))
        assert len((folder / "out" / "cohort.csv").read_text().splitlines()) == 4
    finally:
        subprocess.run(["umount", "out"], check=True)


def test_a_second_run_of_the_same_cases_is_told_and_changes_nothing(
    folder: Path, capsys: Any
) -> None:
    command = [sys.executable, "-m", "palpate", "run", "recipe.yaml"]
    running = subprocess.Popen(
        [*command, "--over", "data/*/ct.nii.gz", "-o", "out", "--shard", "1/2"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    while not list((folder / "out").glob("*.part")):
        assert running.poll() is None
        time.sleep(0.01)
    # it has its cases until it ends: held still, it cannot end meanwhile
    os.kill(running.pid, signal.SIGSTOP)
    try:
        begun = content(folder / "out")
        assert over() == 2
        assert "another run has case 'p1' of" in capsys.readouterr().err
        assert content(folder / "out").keys() >= begun.keys()
        # other cases run beside it
        assert over("--shard", "2/2") == 0
    finally:
        os.kill(running.pid, signal.SIGCONT)
    assert running.wait() == 0
    assert over() == 0
    assert "0 done, 0 failed, 3 kept" in capsys.readouterr().out


def test_warnings_tell_options_as_the_recipe_has_them(folder: Path) -> None:
    assert over("--shard", "1/3") == 0
    told = json.loads((folder / "out" / "p1" / "done.json").read_text())
    assert any("`unit: HU`" in warning for warning in told["warnings"])
    assert "unit=HU" not in str(told["warnings"])


def test_segments_of_one_name_are_both_measured_and_told() -> None:
    # files of segments may have a name twice
    values = np.zeros((6, 6, 6), np.int16)
    values[:2] = 300
    volume = Volume(values, spacing=(1.0, 1.0, 1.0))
    parts = [volume.threshold(low, high, name="part") for low, high in ((100, 400), (0, 50))]
    rows, told = measured_segments(Scene(volume, parts))
    assert {name: row["voxels"] for name, row in rows.items()} == {"part": 72, "part (2)": 144}
    assert any("'part' as 'part (2)'" in sentence for sentence in told)


def test_columns_of_a_table_fill_the_recipe(folder: Path, capsys: Any) -> None:
    (folder / "cases.csv").write_text(
        "case,scan,low\na,data/p1/ct.nii.gz,100\nb,data/p2/ct.nii.gz,200\n", "utf-8"
    )
    text = "import:\n  path: {scan}\n" + BLOCK_RECIPE.replace("100", '"{low}"')
    (folder / "recipe.yaml").write_text(text, "utf-8")
    assert run(["run", "recipe.yaml", "--table", "cases.csv", "-o", "out", "--dry-run"]) == 0
    assert capsys.readouterr().out == "a\nb\n2 to run, 0 kept\n"
    for ended in ("2 done, 0 failed, 0 kept", "0 done, 0 failed, 2 kept"):
        code = run(["run", "recipe.yaml", "--table", "cases.csv", "-o", "out"])
        said = capsys.readouterr()
        assert code == 0
        assert ended in said.out
    (folder / "recipe.yaml").write_text(text.replace("{low}", "{lo}"), "utf-8")
    assert run(["run", "recipe.yaml", "--table", "cases.csv", "-o", "new"]) == 2
    assert "line 4: segment 1: {lo} is no variable" in capsys.readouterr().err
    assert not (folder / "new").exists()


def test_a_pattern_without_quotes_is_told(folder: Path, capsys: Any) -> None:
    expanded = [str(path.relative_to(folder)) for path in folder.glob("data/*/ct.nii.gz")]
    assert run(["run", "recipe.yaml", "--over", *expanded, "-o", "out"]) == 2
    said = capsys.readouterr().err
    assert "allowed: the pattern in quotes" in said
    assert expanded[1] not in said


def test_shares_may_begin_at_once(tmp_path: Path) -> None:
    together = Barrier(4)

    def begin(out: Path) -> None:
        together.wait()
        CohortFolder(out).begin()
        (out / f"{uuid4().hex}.part").mkdir()

    with ThreadPoolExecutor(4) as shares:
        for number in range(100):
            list(shares.map(begin, [tmp_path / str(number)] * 4))


def test_an_output_folder_with_other_things_is_left_alone(folder: Path, capsys: Any) -> None:
    (folder / "out").mkdir()
    (folder / "out" / "thesis.txt").write_text("mine")
    assert over() == 2
    assert "holds something else" in capsys.readouterr().err
    assert content(folder / "out") == {"thesis.txt": b"mine"}


def test_a_recipe_writes_within_the_folder_of_its_case(folder: Path, capsys: Any) -> None:
    (folder / "recipe.yaml").write_text(BLOCK_RECIPE.replace("block.stl", "../block.stl"), "utf-8")
    assert over() == 2
    assert "plain names, such as" in capsys.readouterr().err


def test_no_two_cases_share_a_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("a/x.nii", "a/x.mha", "a_x.mha", "b/X.nrrd"):
        Path(name).parent.mkdir(exist_ok=True)
        Path(name).touch()
    names = [case.name for case in cases_over("**/*.*")]
    assert len({name.casefold() for name in names}) == 4
    assert [case.name for case in cases_over("b/*.nrrd")] == ["X"]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("case,scan\na,\n", "line 2: scan is empty"),
        ("case,scan\na,b,c\n", "line 2: 3 values given"),
        ("case\na\nA\n", "line 3: case 'A' stands in line 2 too"),
        ("scan\na\n", "no column 'case'"),
        ("case\n../a\n", "line 2: case '../a' given"),
    ],
)
def test_what_is_wrong_in_a_table_is_told_with_its_line(
    tmp_path: Path, text: str, told: str
) -> None:
    path = tmp_path / "cases.csv"
    path.write_text(text, "utf-8")
    with pytest.raises(OptionError, match="line") as error:
        cases_of_table(path)
    assert told in str(error.value)


def test_shares_are_the_whole_and_share_nothing() -> None:
    cases = [Case(str(number), {}) for number in range(10)]
    shares = [share_of(cases, f"{number}/3") for number in (1, 2, 3)]
    names = sorted(case.name for share in shares for case in share)
    assert names == sorted(case.name for case in cases)
    with pytest.raises(OptionError, match="allowed: i/n"):
        share_of(cases, "4/3")
