"""What files say is printed, and never obeyed by a terminal: commands run on a real one."""

from __future__ import annotations

import os
import pty
import re
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from palpate.base import console
from palpate.base.console import Display
from palpate.base.harmless_text import HarmlessStream, harmless, terminal
from palpate.export.export import export_scene
from palpate.volumes.scene import Scene

ORDERS = "\x1b]52;c;b3duZWQ=\x07\x1b[2J\x9b31m\u202e"
"""Sets the clipboard, clears the screen, turns red, and turns letters around."""
HOSTILE = f"one{ORDERS}two"
# rich leaves the bell out
SHOWN = re.compile(r"one\?\]52;c;b3duZWQ=\??\?\[2J\?31m\?two")


def on_terminal(*command: str | Path) -> str:
    """Runs a command whose output and errors are a terminal; returns what came there."""
    ours, theirs = pty.openpty()
    environment = os.environ | {"COLUMNS": "200", "TERM": "xterm-256color"}
    with subprocess.Popen(
        [sys.executable, *map(str, command)],
        stdin=theirs,
        stdout=theirs,
        stderr=theirs,
        env=environment,
        close_fds=True,
    ) as running:
        os.close(theirs)
        came = b""
        with suppress(OSError):  # the other end is closed
            while some := os.read(ours, 1 << 16):
                came += some
        os.close(ours)
        running.wait(60.0)
    return came.decode()


def palpate(*arguments: str | Path) -> str:
    return on_terminal("-m", "palpate", *arguments)


def assert_shown_only(came: str) -> None:
    """Fails where a terminal would obey, or where what was said is not shown."""
    assert SHOWN.search(came), came
    assert_nothing_obeyed(came)


def assert_nothing_obeyed(came: str) -> None:
    for order in ("\x1b]", "\x07", "\x1b[2J", "\x9b", "\u202e"):
        assert order not in came, repr(came)


@pytest.fixture
def scan(write_image: Any) -> Path:
    values = np.zeros((6, 7, 8), np.int16)
    values[2:4, 2:5, 1:5] = 300
    path: Path = write_image(values, "scan.nrrd")
    return path


@pytest.fixture
def hostile_series(write_series: Callable[..., Path]) -> Path:
    return write_series(description=HOSTILE, SpecificCharacterSet="ISO_IR 192", PatientName="a^b")


@pytest.mark.parametrize("command", ["series", "info"])
def test_texts_of_dicom_in_tables(command: str, hostile_series: Path) -> None:
    assert_shown_only(palpate(command, hostile_series))


def test_names_of_segments_in_a_table(ball_scene: Scene, tmp_path: Path) -> None:
    held = tmp_path / "held.seg.nrrd"
    scene = Scene(ball_scene.volume, [ball_scene.volume.threshold(0.0, name="NAME")])
    export_scene(scene, held)
    # the header is text; a writer of ours would not put orders there
    held.write_bytes(held.read_bytes().replace(b"NAME", HOSTILE.encode()))
    image = tmp_path / "ball.nrrd"
    export_scene(scene, image, kind="scan")
    assert_shown_only(palpate("statistics", image, "--segments", held))


def test_errors_about_ill_formed_headers(tmp_path: Path) -> None:
    bad = tmp_path / "bad.nrrd"
    bad.write_bytes(f"NRRD0004\ntype: {HOSTILE}\ndimension: 3\nsizes: 1 1 1\n\n".encode())
    came = palpate("info", bad)
    assert_nothing_obeyed(came)
    assert "allowed: int8 to int64" in came


def test_names_of_files(scan: Path) -> None:
    hostile = scan.rename(scan.parent / f"{HOSTILE.replace('/', '')}.nrrd")
    assert_shown_only(palpate("info", hostile))
    assert_shown_only(
        palpate("export", hostile, "--threshold", "1", "-o", hostile.parent / "x.mha")
    )
    assert_shown_only(palpate("info", hostile.with_suffix(".nii")))


def test_words_of_recipes(scan: Path, tmp_path: Path) -> None:
    recipe = tmp_path / "recipe.yaml"
    escaped = "".join(f"\\u{ord(letter):04x}" for letter in HOSTILE)
    recipe.write_text(f'"{escaped}": {scan}\n')
    came = palpate("run", recipe)
    assert_nothing_obeyed(came)
    assert "is no option here" in came


def test_csv_for_a_terminal_keeps_its_lines(scan: Path) -> None:
    came = palpate("statistics", scan, "--threshold", "100", "--csv")
    *_, heads, row, nothing = came.split("\r\n")
    # progress of a slow start was on the line before
    heads = heads.rpartition("\x1b[2K")[2]
    assert (heads[:8], row[:10], nothing) == ("segment,", "threshold,", "")


def test_log_lines_and_tracebacks() -> None:
    said = (
        "import logging, warnings; from palpate.base.harmless_text import print_harmlessly; "
        f"print_harmlessly(); told = {HOSTILE!r}; "
    )
    assert_shown_only(on_terminal("-c", f"{said} logging.getLogger('x').warning(told)"))
    assert_shown_only(on_terminal("-c", f"{said} warnings.warn(told)"))
    assert_shown_only(on_terminal("-c", f"{said} raise ValueError(told)"))


def test_progress(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.setattr(console, "QUIET_SECONDS", 0.0)
    with Display() as display:
        display(f"reading {HOSTILE}", 0.25)
        ends = time.monotonic() + 60.0
        while display._bar is None and time.monotonic() < ends:
            time.sleep(0.01)
        display(f"reading {HOSTILE}", 0.75)
    assert_shown_only(capfd.readouterr().err)


def test_tables_are_as_wide_as_what_is_shown(capsys: pytest.CaptureFixture[str]) -> None:
    from rich.table import Table

    table = Table()
    table.add_row("a\x1b\x1b\x1b", "b")
    table.add_row("abcd", "b")
    terminal().print(table)
    assert len({len(line) for line in capsys.readouterr().out.splitlines()}) == 1


def test_words_of_all_scripts_stay() -> None:
    for name in (
        "Łukasz Žižka",
        "山田　太郎",
        "김철수",
        "محمد",
        "می‌خواهم",
        "क्‍ष",
        "µ–x² mm³\t1\r\n",
    ):
        assert harmless(name) == name


def test_bytes_that_are_no_text_are_written(capsys: pytest.CaptureFixture[str]) -> None:
    stream = HarmlessStream.over(sys.stdout)
    assert HarmlessStream.over(stream) is stream
    stream.writelines(["a\udcff", "b\n"])
    assert capsys.readouterr().out == "a?b\n"
