"""The command line as a person meets it: what it prints, and how it fails."""

from __future__ import annotations

import json
import os
import re
import signal
import socket
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from running_server import PATIENCE

COMMAND = [sys.executable, "-m", "palpate"]


def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*COMMAND, *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=300.0,
        check=False,
    )


def fetch(url: str) -> httpx.Response:
    return httpx.get(url, trust_env=False, timeout=PATIENCE)


def fails(*arguments: str | Path) -> str:
    """Runs what has to fail; returns the one line it says."""
    done = run(*arguments)
    assert done.returncode == 2, done.stderr
    # what is wrong with values is found while the page is on its way
    told = done.stdout.splitlines()
    assert not told or (arguments[0] == "open" and told[0].startswith("Palpate shows "))
    lines = done.stderr.splitlines()
    assert len(lines) == 1, done.stderr
    assert lines[0].startswith("palpate: ")
    assert "Traceback" not in lines[0]
    return lines[0]


@pytest.fixture
def scan(write_image: Any) -> Path:
    """A small scan with something to touch."""
    values = np.full((12, 13, 14), -1000, np.int16)
    values[4:8, 4:8, 4:8] = 400
    path: Path = write_image(values, "scan.nrrd")
    return path


# --- bad input --------------------------------------------------------------------------


@pytest.mark.parametrize("command", ["open", "info"])
class TestWhatCannotBeReadIsOneLine:
    def test_a_missing_path(self, command: str, tmp_path: Path) -> None:
        line = fails(command, tmp_path / "nothing.nii")
        assert "nothing.nii does not exist; allowed: an existing file or folder" in line

    def test_not_an_image(self, command: str, tmp_path: Path) -> None:
        (tmp_path / "note.txt").write_text("hello")
        assert "is no image; allowed: NIfTI" in fails(command, tmp_path / "note.txt")

    def test_an_empty_file(self, command: str, tmp_path: Path) -> None:
        (tmp_path / "empty.mha").touch()
        assert "empty.mha is empty; allowed: NIfTI" in fails(command, tmp_path / "empty.mha")

    def test_a_2d_image(self, command: str, write_image: Any) -> None:
        path = write_image(np.zeros((4, 5), np.uint8), "flat.png")
        assert "2-D image of 5 x 4 voxels; allowed: volumes" in fails(command, path)

    def test_a_colour_image(self, command: str, write_image: Any) -> None:
        path = write_image(np.zeros((3, 4, 5, 3), np.uint8), "colour.mha", vector=True)
        assert "allowed: one intensity per voxel" in fails(command, path)

    def test_an_empty_folder(self, command: str, tmp_path: Path) -> None:
        assert "empty folder; allowed: a folder with the files" in fails(command, tmp_path)

    def test_a_folder_with_two_series(self, command: str, write_series: Any) -> None:
        write_series(uid="1.2.3", description="soft", prefix="a")
        folder = write_series(uid="1.2.4", description="lung", prefix="b")
        line = fails(command, folder)
        assert "choose one with --series" in line
        assert "1.2.3 'soft'" in line
        assert "1.2.4 'lung'" in line

    @pytest.mark.parametrize("name", ["scan.nii", "scan.nii.gz", "scan.mha", "scan.nrrd"])
    def test_a_truncated_file(self, command: str, write_image: Any, name: str) -> None:
        noise = np.random.default_rng(1).integers(0, 999, (9, 9, 9)).astype(np.int16)
        path = write_image(noise, name)
        path.write_bytes(path.read_bytes()[:-500])
        assert "is truncated" in fails(command, path)

    @pytest.mark.parametrize("bad", [np.nan, np.inf])
    def test_values_that_are_not_finite(self, command: str, write_image: Any, bad: float) -> None:
        values = np.zeros((3, 4, 5), np.float32)
        values[0, 0, 0] = bad
        line = fails(command, write_image(values), "--strict")
        assert "1 of 60 values is NaN or infinite; allowed: finite values" in line

    def test_more_voxels_than_allowed(self, command: str, scan: Path) -> None:
        line = fails(command, scan, "--max-voxels", "2183")
        assert "14 x 13 x 12 = 2184 voxels; allowed: at most 2183" in line

    def test_an_unknown_option(self, command: str, scan: Path) -> None:
        line = fails(command, scan, "--frobnicate")
        assert "--frobnicate" in line
        assert "--fill, --" in line.partition("allowed: ")[2]

    def test_a_value_that_is_no_number(self, command: str, scan: Path) -> None:
        assert "'many'" in fails(command, scan, "--max-voxels", "many")

    def test_an_unknown_orientation(self, command: str, scan: Path) -> None:
        line = fails(command, scan, "--orientation", "UP")
        assert "orientation 'UP' is not known; allowed:" in line

    def test_a_missing_argument(self, command: str) -> None:
        # without a scan the page asks for one: then nothing may be said about it
        given = ("--series", "2") if command == "open" else ()
        wanted = "no scan is given" if command == "open" else "Missing argument 'PATH'"
        assert wanted in fails(command, *given)


@pytest.mark.parametrize("threshold", ["5000", "5000,6000", "-3000,-2000"])
def test_a_threshold_that_selects_nothing_is_refused(scan: Path, threshold: str) -> None:
    line = fails("open", scan, "--threshold", threshold)
    assert "selects no voxel; allowed: a range within -1000 to 400" in line


@pytest.mark.parametrize("threshold", ["", "bone", "1,2,3", "nan", "1,", "400,100"])
def test_what_is_no_threshold_is_refused(scan: Path, threshold: str) -> None:
    assert "allowed:" in fails("open", scan, "--threshold", threshold)


def test_a_port_in_use_is_refused(scan: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = str(other.getsockname()[1])
        assert f"port {port} cannot be used" in fails("open", scan, "--port", port)
        assert f"port {port} cannot be used" in fails("demo", "--port", port)


def test_another_rate_is_refused(scan: Path) -> None:
    assert "rate 500 Hz given; allowed: 1000 or 4000 Hz" in fails("open", scan, "--rate", "500")


def test_an_unknown_command_is_refused_with_the_known_ones() -> None:
    assert (
        "allowed: open, demo, info, record, replay, export, import, reconstruct, register, "
        "transform, render, series, segment, statistics, compare, landmarks, touch, share, "
        "recover, run, bids, report, surface, scenario, bench" in fails("frobnicate")
    )


def test_a_label_map_of_another_grid_is_refused(scan: Path, write_image: Any) -> None:
    labels = write_image(np.ones((3, 4, 5), np.uint8), "labels.nrrd", spacing=(1.0, 1.0, 2.0))
    assert "lies on another grid" in fails("open", scan, "--segments", labels)


def test_steering_characters_of_a_path_are_not_printed(tmp_path: Path) -> None:
    assert "\x1b" not in fails("info", tmp_path / "a\x1b[31m\nb.nii")


# --- info -------------------------------------------------------------------------------


def test_info_prints_one_object_for_programs(scan: Path) -> None:
    done = run("info", scan, "--json", "--unit", "HU")
    assert done.returncode == 0
    told = json.loads(done.stdout)
    assert told["dimensions"] == [14, 13, 12]
    assert told["spacing_mm"] == [1.0, 1.0, 1.0]
    assert told["orientation"] == "LPS"
    assert told["unit"] == "HU"
    assert told["range"] == [-1000.0, 400.0]
    assert told["bone_threshold"] == 250.0
    for name in ("modality", "series", "warnings", "memory_bytes"):
        assert name in told


def test_info_prints_a_table_for_people(scan: Path) -> None:
    done = run("info", scan)
    assert done.returncode == 0
    assert re.search(r"dimensions +14 x 13 x 12", done.stdout)
    assert re.search(r"values +-1000 to 400 \(unit unknown\)", done.stdout)
    assert done.stderr == ""


@pytest.mark.data
def test_info_on_a_dicom_folder(data_folder: Path) -> None:
    done = run("info", data_folder / "totalseg_tests" / "example_ct_dicom", "--json")
    told = json.loads(done.stdout)
    assert (told["modality"], told["unit"], told["dimensions"]) == ("CT", "HU", [512, 512, 20])
    assert done.stderr == ""


@pytest.mark.data
def test_what_libraries_print_by_themselves_is_not_shown(data_folder: Path) -> None:
    done = run("info", data_folder / "ge_gantry_tilt" / "GE_human_head_tilt+18.5", "--json")
    assert done.stderr == ""
    assert "tilted by 18.5 degrees" in done.stdout
    folder = data_folder / "pydicom_transfer_syntaxes"
    assert "choose one with --series" in fails("info", folder)


def test_the_version_is_printed() -> None:
    assert re.fullmatch(r"palpate \d+\.\d+\.\d+\n", run("--version").stdout)


def test_help_imports_nothing_heavy_and_so_is_quick() -> None:
    heavy = "import sys, palpate.cli.commands; print([m for m in sys.modules if m in "
    done = subprocess.run(
        [sys.executable, "-c", heavy + "('numpy', 'SimpleITK', 'starlette', 'palpate._core')])"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == "[]"


# --- open and demo ----------------------------------------------------------------------


class Opened:
    """A ``palpate open`` that runs."""

    def __init__(self, *arguments: str | Path) -> None:
        self.process = subprocess.Popen(
            [*COMMAND, *map(str, arguments), "--no-browser"],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def __enter__(self) -> Opened:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.wait()
        for pipe in (self.process.stdout, self.process.stderr):
            assert pipe is not None
            pipe.close()

    def url(self) -> str:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            if line.startswith("http://"):
                return line.strip()
        assert self.process.stderr is not None
        raise AssertionError(self.process.stderr.read())

    def ends(self, number: int) -> int:
        self.process.send_signal(number)
        return self.process.wait(timeout=PATIENCE)


def test_open_serves_the_scan_until_ctrl_c(scan: Path) -> None:
    with Opened("open", scan, "--threshold", "0,1000") as opened:
        url = opened.url()
        with httpx.Client(trust_env=False, timeout=PATIENCE, follow_redirects=True) as browser:
            assert "<title>Palpate</title>" in browser.get(url).text
        volume = fetch(url.replace("/?", "/api/volume?"))
        assert len(volume.content) == 14 * 13 * 12 * 2
        assert opened.ends(signal.SIGINT) == 0


def test_open_leaves_nothing_behind_when_it_is_terminated(scan: Path) -> None:
    with Opened("open", scan) as opened:
        url = opened.url()
        opened.ends(signal.SIGTERM)
    with pytest.raises(httpx.ConnectError):
        fetch(url)


def free_port() -> int:
    """Finds a port that nothing uses; below those that the system itself gives to programs."""
    for port in range(20_000 + os.getpid() % 10_000, 32_768):
        with suppress(OSError), socket.create_server(("127.0.0.1", port)):
            return port
    raise AssertionError("no free port")


def test_the_port_that_was_asked_for_is_used(scan: Path) -> None:
    port = free_port()
    with Opened("open", scan, "--port", str(port)) as opened:
        assert f"127.0.0.1:{port}/" in opened.url()
        line = fails("open", scan, "--port", str(port))
        assert f"port {port} cannot be used" in line


def test_labels_become_segments(scan: Path, write_image: Any) -> None:
    labels = np.zeros((12, 13, 14), np.uint16)
    labels[2:5, 2:5, 2:5], labels[6:9, 6:9, 6:9] = 3, 500
    path = write_image(labels, "labels.nrrd")
    with Opened("open", scan, "--segments", path) as opened:
        url = opened.url()
        told = fetch(url.replace("/?", "/api/labels?")).content
    got = np.frombuffer(told, np.uint8).reshape(labels.shape)
    np.testing.assert_array_equal(got, np.where(labels == 3, 1, np.where(labels == 500, 2, 0)))


def test_the_demo_shows_the_phantom() -> None:
    with Opened("demo") as opened:
        url = opened.url()
        volume = fetch(url.replace("/?", "/api/volume?step=4&"))
        assert volume.headers["x-palpate-dimensions"] == "50 35 68"


def test_output_that_nobody_reads_is_no_traceback(scan: Path) -> None:
    read_end, write_end = os.pipe()
    os.close(read_end)
    done = subprocess.run(
        [*COMMAND, "info", str(scan)],
        stdout=write_end,
        stderr=subprocess.PIPE,
        text=True,
        check=False,
    )
    os.close(write_end)
    assert "Traceback" not in done.stderr


# --- series -----------------------------------------------------------------------------


def test_the_series_of_a_folder_are_listed(write_series: Any) -> None:
    write_series(uid="1.2.3", prefix="a", PatientID="7", description="soft")
    folder = write_series(uid="1.2.4", prefix="b", description="lung")
    done = run("series", folder, "--json")
    listed = json.loads(done.stdout)
    assert [(one["number"], one["series"], one["slices"]) for one in listed] == [
        (1, "soft", 4),
        (2, "lung", 4),
    ]
    assert "4 x 3 x 4" in run("series", folder).stdout
    assert "2-D image of 4 x 3 x 1 voxels" in fails("series", folder / "a000")


def test_a_command_imports_only_what_it_needs(tmp_path: Path, write_image: Any) -> None:
    scan = write_image(np.full((5, 6, 7), 40, np.int16), "scan.nii.gz", spacing=(1.0, 1.0, 1.0))
    code = (
        "import sys; from palpate.cli.commands import run; run(sys.argv[1:]); "
        "print('imported', [m for m in ('pydicom', 'nibabel', 'palpate.session.session', "
        "'palpate.io.scan_at', 'palpate.labels.labels', 'trimesh') if m in sys.modules])"
    )
    for given in (["info"], ["segment", "--threshold", "0", "-o", str(tmp_path / "out.nii.gz")]):
        command = [sys.executable, "-c", code, given[0], str(scan), *given[1:]]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        assert done.stdout.splitlines()[-1] == "imported []", done.stderr


def test_a_worker_reads_nifti_without_pydicom_and_leaves_it_importable() -> None:
    code = (
        "import sys; from palpate.base.reader_process.limits import in_this_process; "
        "from palpate.base.nibabel import nibabel; {}"
        "nibabel(); before = 'pydicom' in sys.modules; import pydicom; "
        "print(before, pydicom.__name__)"
    )
    for worker, said in (("limits.inside = lambda: True; ", "False pydicom"), ("", "True pydicom")):
        asked = code.format("from palpate.base.reader_process import limits; " + worker)
        done = subprocess.run(
            [sys.executable, "-c", asked], capture_output=True, text=True, check=True
        )
        assert done.stdout.strip() == said
