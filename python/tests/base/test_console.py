"""What is shown while work goes on, and how failures are said."""

from __future__ import annotations

import os
import sys
import time

import pytest
from palpate.base import console
from palpate.base.console import Display, clear_line, fail, quiet_libraries, replace_line, warn


def test_a_failure_is_one_printable_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert fail("cannot\n read \x1b[31mthis\x07") == 2
    assert capsys.readouterr().err == "palpate: cannot read ?[31mthis?\n"


def test_a_warning_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    warn("spacing is\nunknown")
    assert capsys.readouterr().err == "palpate: warning: spacing is unknown\n"


def test_a_warning_does_not_stand_behind_a_line_that_goes(
    capsys: pytest.CaptureFixture[str],
) -> None:
    replace_line("1 left", last=False)
    warn("torn")
    clear_line()
    assert capsys.readouterr().err == "\r1 left\x1b[K\r\x1b[Kpalpate: warning: torn\n"
    # what is the last of its kind stays
    replace_line("0 left", last=True)
    fail("torn")
    assert capsys.readouterr().err == "\r0 left\x1b[K\npalpate: torn\n"


def test_libraries_are_quiet_and_we_are_not(capfd: pytest.CaptureFixture[str]) -> None:
    before = sys.stderr
    with quiet_libraries():
        os.write(2, b"from a library\n")
        sys.stderr.write("from us\n")
    os.write(2, b"afterwards\n")
    assert sys.stderr is before
    assert capfd.readouterr().err == "from us\nafterwards\n"


def test_stderr_comes_back_after_an_error(capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(ValueError, match="stop"), quiet_libraries():
        raise ValueError("stop")
    os.write(2, b"here\n")
    assert capfd.readouterr().err == "here\n"


@pytest.fixture
def terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    """Has rich take the pipe for a terminal."""
    monkeypatch.setenv("FORCE_COLOR", "1")


@pytest.mark.usefixtures("terminal")
def test_work_that_takes_time_is_shown(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(console, "QUIET_SECONDS", 0.0)
    with Display() as display:
        display("reading 20 slices", 0.25)
        ends = time.monotonic() + 60.0
        while display._bar is None and time.monotonic() < ends:
            time.sleep(0.01)
        display("reading 20 slices", 0.75)
    assert "reading 20 slices" in capfd.readouterr().err


@pytest.mark.usefixtures("terminal")
def test_work_that_is_over_soon_is_not_shown(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(console, "QUIET_SECONDS", 3600.0)
    with Display() as display:
        display("reading 20 slices", 0.25)
    assert capfd.readouterr().err == ""
    # on a machine that is late the time comes when the work is over
    display._show()
    assert display._bar is None
    assert capfd.readouterr().err == ""
