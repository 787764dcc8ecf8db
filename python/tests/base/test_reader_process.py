"""A process that reads: what ends it ends nothing else, wherever it is called from."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from palpate.base.errors import MeshFormatError, OptionError, VolumeFormatError
from palpate.base.progress import Progress
from palpate.base.reader_process import apart, apart_each, call, limits, pool, worker

HERE = str(Path(__file__).parent)


@pytest.fixture(scope="module", autouse=True)
def known_to_workers() -> Iterator[None]:
    """Lets workers find the functions of this file, under the name it has here."""
    pool._close_all()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "path", [HERE, *sys.path])
        patch.setitem(sys.modules, "test_reader_process", sys.modules[__name__])
        for function in (
            ends_by,
            waits,
            takes,
            fails,
            tells,
            makes,
            counts,
            writes,
            where,
            imported,
        ):
            patch.setattr(function, "__module__", "test_reader_process")
        yield
        pool._close_all()


# --- what workers do here ---------------------------------------------------------------


def ends_by(number: int) -> None:
    with limits.looking_at(Path("a.dcm"), "DICOM"):
        os.kill(os.getpid(), number)
        time.sleep(60)


def waits(seconds: float) -> None:
    time.sleep(seconds)


def takes(amount: int) -> int:
    return len(bytearray(amount))


def fails(error: Exception) -> None:
    raise error


def tells(progress: Progress) -> str:
    for step in range(5):
        progress(f"step {step}", step / 5)
    return "told"


def makes(shape: tuple[int, ...]) -> dict[str, object]:
    many = np.arange(np.prod(shape), dtype=np.float32).reshape(shape)
    return {"many": many, "turned": many.T, "few": np.arange(3)}


def counts(end: int) -> Iterator[int]:
    yield from range(end)


def writes() -> str:
    handle, path = tempfile.mkstemp()
    os.close(handle)
    return path


def where() -> tuple[int, str]:
    return os.getpid(), str(Path.cwd())


def imported() -> set[str]:
    return set(worker.LIKELY) & set(sys.modules)


# ------------------------------------------------------------------------------------------


def test_a_signal_ends_the_worker_and_says_so() -> None:
    for number, name in ((signal.SIGSEGV, "SIGSEGV"), (signal.SIGABRT, "SIGABRT")):
        with pytest.raises(VolumeFormatError) as refusal:
            apart(ends_by, int(number), path=Path("folder"))
        assert f"a.dcm (DICOM) ended its reader by {name}" in str(refusal.value)
    # the next one is read as ever
    assert apart(takes, 10, path=Path("b")) == 10


def test_a_mesh_is_refused_as_a_mesh() -> None:
    with pytest.raises(MeshFormatError, match="SIGKILL"):
        apart(ends_by, int(signal.SIGKILL), path=Path("a.stl"), error=MeshFormatError)


def test_no_progress_for_long_ends_it(monkeypatch: pytest.MonkeyPatch) -> None:
    assert limits.PATIENCE == 30.0
    monkeypatch.setattr(call, "PATIENCE", 0.4)
    begun = time.monotonic()
    with pytest.raises(VolumeFormatError, match=r"kept its reader busy for 0 s without progress"):
        apart(waits, 60.0, path=Path("slow.nii"))
    assert time.monotonic() - begun < 20.0


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux counts the memory of a process")
def test_memory_has_a_bound() -> None:
    assert apart(takes, 1 << 28, path=Path("a.nii")) == 1 << 28
    with pytest.raises(VolumeFormatError, match=r"a\.nii takes more than the 1\.5 GiB"):
        apart(takes, 1 << 31, path=Path("a.nii"))


def test_errors_come_with_their_text_and_surprises_in_one_line() -> None:
    with pytest.raises(OptionError, match=r"^such a thing; allowed: another$"):
        apart(fails, OptionError("such a thing; allowed: another"), path=Path("a"))
    with pytest.raises(FileNotFoundError) as gone:
        apart(fails, FileNotFoundError(2, "not here", "a.nii"), path=Path("a.nii"))
    assert gone.value.filename == "a.nii"
    with pytest.raises(VolumeFormatError) as surprise:
        apart(fails, KeyError("what\nis this"), path=Path("a.nii"))
    assert "a.nii cannot be read (KeyError" in str(surprise.value)
    assert "\n" not in str(surprise.value)
    assert "in fails" in str(surprise.value.__cause__)


def test_progress_is_told_and_may_end_it() -> None:
    told: list[tuple[str, float | None]] = []

    def progress(what: str, share: float | None, /) -> None:
        told.append((what, share))

    assert apart(tells, path=Path("a"), progress=progress) == "told"
    assert [one for one in told if one[0] != "opening"] == [(f"step {n}", n / 5) for n in range(5)]

    class EnoughError(Exception):
        pass

    def enough(_what: str, _share: float | None, /) -> None:
        raise EnoughError

    worker = pool.take()
    pool.give_back(worker)
    with pytest.raises(EnoughError):
        apart(tells, path=Path("a"), progress=enough)
    assert not worker.alive


def test_arrays_arrive_as_they_were_and_can_be_changed() -> None:
    shape = (30, 40, 50)
    found = apart(makes, shape, path=Path("a"))
    expected = makes(shape)
    for name, value in expected.items():
        np.testing.assert_array_equal(found[name], value)
    many = found["many"]
    assert isinstance(many, np.ndarray)
    many[0] = -1.0
    # a later result is in other memory
    apart(makes, shape, path=Path("a"))
    assert (many[0] == -1.0).all()
    assert list(apart_each(counts, 3, path=Path("a"))) == [0, 1, 2]


def test_nothing_is_left_behind(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    written = apart(writes, path=Path("a"))
    assert Path(written).is_relative_to(tmp_path)
    with pytest.raises(VolumeFormatError):
        apart(ends_by, int(signal.SIGKILL), path=Path("a"))
    assert list(tmp_path.iterdir()) == []
    waiting, _ = apart(where, path=Path("a"))
    pool._close_all()
    # neither a process, nor one that has ended and is still listed
    with pytest.raises(ProcessLookupError):
        os.kill(waiting, 0)


def test_a_worker_is_kept_and_follows_this_process(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    first, _ = apart(where, path=Path("a"))
    monkeypatch.chdir(tmp_path)
    again, folder = apart(where, path=Path("a"))
    assert (again, folder) == (first, str(tmp_path.resolve()))
    # one that has died meanwhile is not asked
    os.kill(first, signal.SIGKILL)
    time.sleep(0.1)
    assert apart(where, path=Path("a"))[0] != first


def test_threads_and_forked_children_have_workers_of_their_own() -> None:
    found: list[int] = []

    def read() -> None:
        found.append(apart(where, path=Path("a"))[0])

    threads = [threading.Thread(target=read) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 3
    mine = apart(where, path=Path("a"))[0]
    pipe_out, pipe_in = os.pipe()
    child = os.fork()
    if child == 0:
        theirs = apart(where, path=Path("a"))[0]
        os.write(pipe_in, b"%d" % theirs)
        pool._close_all()
        os._exit(0)
    os.waitpid(child, 0)
    assert int(os.read(pipe_out, 99)) not in {mine, *found}
    os.close(pipe_out)
    os.close(pipe_in)
    assert apart(where, path=Path("a"))[0] == mine


SCRIPT = """
import palpate, sys
volume = palpate.read(sys.argv[1])
print(volume.dimensions)
try:
    palpate.read(sys.argv[2])
except ValueError as error:
    print("refused")
"""


@pytest.mark.parametrize("way", ["script", "stdin", "command", "daemon"])
def test_scripts_need_no_guard(tmp_path: Path, way: str) -> None:
    """A plain script, one from stdin or -c, and a daemonic process, as Dask has them."""
    good, bad = tmp_path / "a.mha", tmp_path / "b.mha"
    header = (
        "NDims = 3\nDimSize = 4 5 6\nElementType = MET_SHORT\nElementSpacing = 1 1 1\n"
        "ElementDataFile = LOCAL\n"
    )
    good.write_bytes(header.encode() + bytes(240))
    bad.write_bytes(header.replace("= 3", "= 99").encode())
    script = tmp_path / "script.py"
    text = SCRIPT
    if way == "daemon":
        text = (
            "import multiprocessing, sys\nfrom contextlib import suppress\n"
            f"def work():\n    exec({SCRIPT!r})\n"
            "if __name__ == '__main__':\n"
            "    process = multiprocessing.get_context('fork').Process(target=work, daemon=True)\n"
            "    process.start(); process.join(); sys.exit(process.exitcode)\n"
        )
    script.write_text(text)
    start = {"stdin": ["-"], "command": ["-c", SCRIPT]}.get(way, [str(script)])
    done = subprocess.run(
        [sys.executable, *start, str(good), str(bad)],
        input=SCRIPT if way == "stdin" else None,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert (done.stdout, done.stderr, done.returncode) == ("(4, 5, 6)\nrefused\n", "", 0)


def test_what_lies_in_the_folder_is_no_module(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    for name in ("numpy", "SimpleITK", "pickle"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit")
    monkeypatch.chdir(tmp_path)
    assert apart(where, path=Path("a"))[1] == str(tmp_path.resolve())


def test_a_worker_that_waits_outlives_a_library_that_cannot_be_loaded(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    # the last one that is loaded while nothing is asked
    loaded = tmp_path / "loaded"
    (tmp_path / "nibabel.py").write_text(f"open({str(loaded)!r}, 'w').close(); raise TypeError")
    pool._close_all()
    monkeypatch.setattr(sys, "path", [str(tmp_path), *sys.path])
    first = apart(where, path=Path("a"))[0]
    while not loaded.exists():
        time.sleep(0.05)
    assert apart(where, path=Path("a"))[0] == first
    pool._close_all()


def test_one_that_waits_imports_in_advance_only_where_the_machine_is_idle() -> None:
    pool._close_all()
    pool.warm(idle=False)
    time.sleep(3 * worker.QUIET)
    assert apart(imported, path=Path("a")) == set()
    pool._close_all()
    pool.warm()
    while not apart(imported, path=Path("a")):
        time.sleep(3 * worker.QUIET)
    pool._close_all()
