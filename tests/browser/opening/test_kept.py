"""What is kept of a scan stays with that scan, in a real browser: marks, clipping, window, look."""

from __future__ import annotations

import os
import shutil
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK
from browser import Browser, browser, free_port, palpate

pytestmark = pytest.mark.browser

SIZE = {"width": 1000, "height": 560}


def written(path: Path, seed: int) -> Path:
    """Writes a small scan: a ball in noise."""
    path.parent.mkdir(parents=True, exist_ok=True)
    grid = np.indices((40, 40, 40)) - 19.5
    values = np.where(np.linalg.norm(grid, axis=0) < 15, 1000, 0)
    noise = np.random.default_rng(seed).integers(0, 50, values.shape)
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray((values + noise).astype(np.int16)), str(path))
    return path


@pytest.fixture(scope="module")
def page() -> Iterator[Browser]:
    """A browser that stays the same while scans come and go."""
    with browser() as started:
        yield started
        assert started.complaints == []


@contextmanager
def shown(page: Browser, path: Path, state: Path, port: int) -> Iterator[str]:
    """Opens a file on a page, always at the same address; gives the address with its token."""
    with palpate("open", path, "--threshold", "500", "--port", str(port), state=state) as command:
        assert page.do("open", url=command.url, **SIZE)["firstPicture"] is not None
        yield command.url
        page.all_done()
        # a page that stays would go on with the next scan by itself
        page.read("void (location.href = 'about:blank')")
        page.wait("location.href === 'about:blank'")
        command.stop()


def holds_a_mark(path: Path) -> bool:
    """Says whether a file of what is kept has a mark."""
    return '"mark.' in path.read_text("utf-8")


def change_all(page: Browser) -> None:
    """Changes one thing of each kind that is kept with a scan."""
    page.read("window.palpate.addMark('point', [[10, 11, 12]])")
    page.read("window.palpate.addMark('distance', [[10, 11, 12], [20, 11, 12]])")
    page.read("window.palpate.keep('clip', { box: { on: true } })")
    page.read("window.palpate.keep('window', { window: 321, level: 123 })")
    page.read("window.palpate.keep('lighting', { brightness: 0.5 })")
    page.all_done()


def kept(page: Browser) -> dict[str, Any]:
    """Returns what the page knows of the scan that is kept."""
    found: dict[str, Any] = page.read("window.palpate.kept")
    return found


def test_a_scan_of_another_patient_has_nothing_of_the_first(page: Browser, tmp_path: Path) -> None:
    first = written(tmp_path / "anna" / "ct.nii.gz", 1)
    second = written(tmp_path / "berta" / "ct.nii.gz", 2)
    elsewhere = tmp_path / "moved" / "other-name.nii.gz"
    elsewhere.parent.mkdir()
    shutil.copy(first, elsewhere)
    state, port = tmp_path / "state", free_port()
    with shown(page, first, state, port):
        assert page.read("window.palpate.marks") == []
        change_all(page)
        marks, whole = page.read("window.palpate.marks"), kept(page)
        assert len(marks) == 2
    with shown(page, second, state, port):
        assert page.read("window.palpate.marks") == []
        assert kept(page) == {}
    with shown(page, elsewhere, state, port):
        assert page.read("window.palpate.marks") == marks
        assert kept(page) == whole
    # another scan under the first one's name
    written(first, 3)
    with shown(page, first, state, port):
        assert page.read("window.palpate.marks") == []
        assert kept(page) == {}
    stored = page.read("JSON.stringify(Object.entries(localStorage))")
    assert "ct.nii" not in stored
    assert "Distance" not in stored


def test_two_pages_of_one_session_lose_nothing_of_each_other(page: Browser, tmp_path: Path) -> None:
    scan, state, port = written(tmp_path / "ct.nii.gz", 4), tmp_path / "state", free_port()
    with shown(page, scan, state, port) as url, browser() as other:
        assert other.do("open", url=url, **SIZE)["firstPicture"] is not None
        for place in range(5):
            page.read(f"window.palpate.addMark('point', [[10, 11, {place}]])")
        page.all_done()
        # it sees them, and its own one stands beside them
        other.wait("window.palpate.marks.length === 5")
        other.read("window.palpate.addMark('point', [[30, 11, 12]])")
        page.wait("window.palpate.marks.length === 6")
        other.all_done()
        assert other.read("window.palpate.marks") == page.read("window.palpate.marks")
        # undo takes back what was made here, and nothing of the other page
        page.do("press", key="Control+z")
        page.wait("window.palpate.marks.length === 5")
        other.wait("window.palpate.marks.length === 5")
        points = [mark["points"][0] for mark in other.read("window.palpate.marks")]
        assert points == [*([10, 11, place] for place in range(4)), [30, 11, 12]]
        assert other.complaints == []


def test_marks_outlive_an_engine_that_is_killed(tmp_path: Path) -> None:
    scan, state = written(tmp_path / "ct.nii.gz", 5), tmp_path / "state"
    with palpate("open", scan, "--threshold", "500", state=state) as command, browser() as page:
        assert page.do("open", url=command.url, **SIZE)["firstPicture"] is not None
        page.read("window.palpate.addMark('point', [[10, 11, 12]])")
        page.all_done()
        while not any(map(holds_a_mark, (state / "scans").glob("[!.]*.json"))):
            assert command.process.poll() is None
            time.sleep(0.05)
        os.kill(command.process.pid, signal.SIGKILL)
    with palpate("open", scan, "--threshold", "500", state=state) as command, browser() as page:
        assert page.do("open", url=command.url, **SIZE)["firstPicture"] is not None
        assert len(page.read("window.palpate.marks")) == 1
