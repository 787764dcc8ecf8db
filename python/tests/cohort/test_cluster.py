"""Cases on a Dask cluster: the same bytes on any number of workers, and none is lost."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import sysconfig
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import palpate
import psutil
import pytest
import SimpleITK
from distributed import Client
from made_cohort import BLOCK_RECIPE, write_block
from palpate.base.package_version import package_version
from palpate.cli.commands import run
from palpate.cohort import Case, Limits, run_case
from palpate.cohort.case_process import CaseProcess

MADE = ("block.stl", "labels.nii.gz", "thumbnail.jpg")
PALPATE = [sys.executable, "-m", "palpate", "run", "recipe.yaml"]
OVER = ["--over", "data/*/ct.nii.gz", "-o", "out"]
NAMES = ["p1", "p2", "p3", "p4"]

WITHOUT_PALPATE = """
import sys
sys.path = [each for each in sys.path if not each.endswith("/python")]
from distributed.cli.dask_worker import main
main()
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for number, name in enumerate(NAMES):
        write_block(tmp_path / "data" / name / "ct.nii.gz", 3 + number)
    (tmp_path / "recipe.yaml").write_text(BLOCK_RECIPE, "utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def made(folder: Path) -> dict[str, bytes]:
    return {
        f"{case}/{name}": (folder / case / name).read_bytes() for case in NAMES for name in MADE
    }


def started(*more: str) -> subprocess.Popen[str]:
    """Starts a run as a terminal would, in a group of processes of its own."""
    return subprocess.Popen(
        [*PALPATE, *OVER, *more],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )


def wait_for(folder: Path, pattern: str, running: subprocess.Popen[str]) -> None:
    while not list(folder.glob(pattern)):
        assert running.poll() is None, running.communicate()
        time.sleep(0.01)


def test_two_workers_make_the_same_bytes_as_none(folder: Path, capsys: Any) -> None:
    assert run([*PALPATE[3:], "--over", "data/*/ct.nii.gz", "-o", "alone"]) == 0
    (folder / "data" / "broken").mkdir()
    (folder / "data" / "broken" / "ct.nii.gz").write_bytes(b"")
    running = started("--workers", "2")
    said, _ = running.communicate()
    assert running.returncode == 3, said
    assert "workers: http://127.0.0.1:" in said
    assert "broken failed: " in said
    assert "4 done, 1 failed, 0 kept" in said
    assert made(folder / "out") == made(folder / "alone")
    # what is done is kept, also by a run without workers
    capsys.readouterr()
    assert run([*PALPATE[3:], *OVER, "--dry-run"]) == 0
    assert "1 to run, 4 kept" in capsys.readouterr().out


@pytest.mark.parametrize("workers", [pytest.param(1, marks=pytest.mark.long), 2])
def test_cases_of_a_lost_worker_go_on_elsewhere(folder: Path, workers: int) -> None:
    running = started("--workers", str(workers))
    wait_for(folder, "out/*.part", running)
    children = psutil.Process(running.pid).children(recursive=True)
    lost = next(each for each in children if "spawn_main" in " ".join(each.cmdline()))
    lost.kill()
    said, _ = running.communicate()
    assert running.returncode == 0, said
    assert "4 done, 0 failed, 0 kept" in said
    assert len(made(folder / "out")) == 12
    assert not list((folder / "out").glob("*.part"))


def test_ctrl_c_ends_in_order_and_the_same_command_goes_on(folder: Path) -> None:
    running = started("--workers", "1")
    wait_for(folder, "out/*.part", running)
    # as a terminal does: to all processes of the group
    os.killpg(running.pid, signal.SIGINT)
    said, _ = running.communicate()
    assert running.returncode == 130, said
    assert "stopping once the cases that run are done" in said
    assert "left: the same command goes on" in said
    done = list((folder / "out").glob("*/done.json"))
    assert 1 <= len(done) < 4
    assert not list((folder / "out").glob("*.part"))
    assert run([*PALPATE[3:], *OVER]) == 0
    assert len(made(folder / "out")) == 12


@contextmanager
def dask(
    *arguments: str, program: str = sys.executable, **settings: str
) -> Iterator[subprocess.Popen[bytes]]:
    process = subprocess.Popen(
        [program, *arguments],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env={**os.environ, **settings},
    )
    try:
        yield process
    finally:
        process.terminate()
        process.wait()


def test_workers_that_cannot_run_cases_are_told_and_not_used(
    folder: Path, tmp_path_factory: pytest.TempPathFactory, capsys: Any
) -> None:
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    about = elsewhere / "palpate-0.0.1.dist-info" / "METADATA"
    about.parent.mkdir()
    about.write_text("Metadata-Version: 2.1\nName: palpate\nVersion: 0.0.1\n")
    place = elsewhere / "scheduler.json"
    worker = ("-m", "distributed.cli.dask_worker", "--scheduler-file", str(place))
    with (
        dask("-m", "distributed.cli.dask_scheduler", "--port", "0", "--no-dashboard",
             "--host", "127.0.0.1", "--scheduler-file", str(place)),
        dask(*worker, "--no-nanny", "--no-dashboard", PYTHONPATH=str(elsewhere)),
        dask("-c", WITHOUT_PALPATE, *worker[2:], "--no-nanny", "--no-dashboard"),
    ):  # fmt: skip
        while not place.exists():
            time.sleep(0.05)
        address = json.loads(place.read_text())["address"]
        with Client(address) as client:
            client.wait_for_workers(2)
        assert run([*PALPATE[3:], *OVER, "--scheduler", address]) == 2
        said = capsys.readouterr().err
        assert "no worker can run cases" in said
        assert f"it has Palpate 0.0.1, not {package_version()}" in said
        assert "it has no Palpate" in said
        with (
            dask(*worker, "--no-dashboard", "--nthreads", "1"),
            dask(*worker, "--no-dashboard", "--nthreads", "1"),
        ):
            with Client(address) as client:
                client.wait_for_workers(4)
            assert run([*PALPATE[3:], *OVER, "--scheduler", address]) == 0
    said = capsys.readouterr()
    assert "4 done, 0 failed, 0 kept" in said.out
    assert "is not used: it has no Palpate" in said.err
    assert len(made(folder / "out")) == 12


def other_version(place: Path, version: str) -> Path:
    """Makes a virtual environment with Palpate of another version; returns its Python.

    What Palpate needs it takes from this one.
    """
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", place], check=True)
    (packages,) = place.glob("lib/python3*/site-packages")
    (packages / "needed.pth").write_text(sysconfig.get_path("purelib"))
    shutil.copytree(
        Path(palpate.__file__).parent,
        packages / "palpate",
        ignore=shutil.ignore_patterns("viewer", "__pycache__"),
    )
    about = packages / f"palpate-{version}.dist-info" / "METADATA"
    about.parent.mkdir()
    about.write_text(f"Metadata-Version: 2.1\nName: palpate\nVersion: {version}\n")
    return place / "bin" / "python"


@pytest.mark.long
def test_a_worker_of_another_environment_with_another_version_is_not_used(
    folder: Path, tmp_path_factory: pytest.TempPathFactory, capsys: Any
) -> None:
    elsewhere = tmp_path_factory.mktemp("other")
    python = other_version(elsewhere / "venv", "9.9.9")
    code = (
        "import palpate; from palpate.base.package_version import package_version\n"
        "print(palpate.__file__, package_version())"
    )
    told = subprocess.run([python, "-c", code], capture_output=True, text=True, check=True).stdout
    assert told.split() == [str(next(elsewhere.glob("venv/lib/*/*/palpate/__init__.py"))), "9.9.9"]
    place = elsewhere / "scheduler.json"
    worker = ["-m", "distributed.cli.dask_worker", "--scheduler-file", str(place)]
    with dask("-m", "distributed.cli.dask_scheduler", "--port", "0", "--no-dashboard",
              "--host", "127.0.0.1", "--scheduler-file", str(place)):  # fmt: skip
        while not place.exists():
            time.sleep(0.05)
        address = json.loads(place.read_text())["address"]
        more = ["--no-nanny", "--no-dashboard"]
        with dask(*worker, *more, program=str(python)), dask(*worker, *more):
            with Client(address) as client:
                client.wait_for_workers(2)
            assert run([*PALPATE[3:], *OVER, "--scheduler", address]) == 0
    said = capsys.readouterr()
    assert f"is not used: it has Palpate 9.9.9, not {package_version()}" in said.err
    assert "4 done, 0 failed, 0 kept" in said.out
    assert len(made(folder / "out")) == 12


@pytest.mark.long
def test_a_programs_own_tasks_run_cases(folder: Path) -> None:
    code = (
        "from distributed import Client\n"
        "import palpate.cohort as cohort\n"
        "if __name__ == '__main__':\n"
        "    with Client(n_workers=1, threads_per_worker=1, dashboard_address=':0') as client:\n"
        "        cases = cohort.cases_over('data/*/ct.nii.gz')\n"
        "        each = client.map(cohort.run_case, cases, recipe='recipe.yaml', output='out')\n"
        "        print([(result.name, result.reason) for result in client.gather(each)])\n"
    )
    (folder / "program.py").write_text(code)
    said = subprocess.run(
        [sys.executable, "program.py"], capture_output=True, text=True, check=True
    ).stdout
    assert said.strip() == str([(name, None) for name in NAMES])
    assert len(made(folder / "out")) == 12


def test_palpate_itself_needs_no_dask() -> None:
    code = (
        "import sys, palpate, palpate.cohort as cohort, palpate.cli.commands, "
        "palpate.cli.recipe_over\n"
        "assert cohort.run_case is cohort.run_case and callable(cohort.run_case)\n"
        "print([name for name in ('dask', 'distributed') if name in sys.modules])"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout.strip() == "[]"


def test_a_case_gets_its_number_of_threads() -> None:
    process = CaseProcess(2)
    try:
        started = psutil.Process(process._process.pid)
        # the system shows it a moment after the process is there
        while not (set_for := started.environ()):
            time.sleep(0.001)
        assert set_for["RAYON_NUM_THREADS"] == set_for["OPENBLAS_NUM_THREADS"] == "2"
    finally:
        process.end()


def test_a_registration_is_the_same_to_the_byte_each_time(tmp_path: Path) -> None:
    noise = np.random.default_rng(3).normal(size=(40, 40, 40)).astype(np.float32)
    smooth = SimpleITK.SmoothingRecursiveGaussian(SimpleITK.GetImageFromArray(noise), 2.0)
    SimpleITK.WriteImage(smooth, str(tmp_path / "fixed.mha"))
    shifted = SimpleITK.Resample(smooth, SimpleITK.TranslationTransform(3, (1.5, 0.5, -1.0)))
    SimpleITK.WriteImage(shifted, str(tmp_path / "moving.mha"))
    recipe = tmp_path / "recipe.yaml"
    recipe.write_text(
        f"import:\n  path: {tmp_path / 'fixed.mha'}\nregister:\n"
        f"  moving: {tmp_path / 'moving.mha'}\n  metric: mutual-information\n  output: found.tfm\n"
        "segment:\n  - threshold: 0\n"
    )
    transforms = []
    for threads in (1, 4):
        case, limits = Case(f"with-{threads}", {}), Limits(threads=threads)
        result = run_case(case, recipe=recipe, output=tmp_path / "out", limits=limits)
        assert result.reason is None
        transforms.append((tmp_path / "out" / case.name / "found.tfm").read_bytes())
    assert transforms[0] == transforms[1]


@pytest.mark.usefixtures("folder")
def test_what_does_not_go_together_is_told(capsys: Any) -> None:
    assert run([*PALPATE[3:], *OVER, "--workers", "2", "--scheduler", "tcp://127.0.0.1:1"]) == 2
    assert "--workers and --scheduler given; allowed: one of both" in capsys.readouterr().err
    assert run([*PALPATE[3:], *OVER, "--scheduler", "nowhere://at all"]) == 2
    assert "no scheduler answers at nowhere://at all" in capsys.readouterr().err
