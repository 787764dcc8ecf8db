"""Pages come while the first scan is read: they wait for it, and are told how far that is."""

from __future__ import annotations

import json
from pathlib import Path
from threading import Event, Thread
from typing import Any

import httpx
import pytest
from made_scans import make_ball
from palpate.base.errors import OptionError
from palpate.base.progress import Progress, silent
from palpate.server.job import CancelledWorkError
from palpate.server.loading_scan import LoadingScan
from palpate.server.open_scan import OpenScan
from palpate.server.security import Access
from palpate.server.workbench import Workbench
from running_server import PATIENCE, serving, write_page


def ask(access: Access, path: str, method: str = "GET") -> httpx.Response:
    cookie = {"Cookie": f"{access.cookie}={access.token}"}
    address = f"http://127.0.0.1:{access.port}{path}"
    return httpx.request(method, address, headers=cookie, trust_env=False, timeout=PATIENCE)


class Slow:
    """Reads until it is let go."""

    def __init__(self, failure: Exception | None = None) -> None:
        self.go = Event()
        self.failure = failure

    def __call__(self, progress: Progress) -> OpenScan:
        progress("reading the ball", 0.25)
        assert self.go.wait(PATIENCE)
        progress("reading the ball", 0.5)
        if self.failure is not None:
            raise self.failure
        return OpenScan.begin(make_ball(), notify=lambda _: None)


def lines_of(answer: httpx.Response) -> list[dict[str, Any]]:
    return [json.loads(line) for line in answer.text.splitlines()]


def test_a_page_is_told_how_far_reading_is_and_waits_for_the_scan(tmp_path: Path) -> None:
    slow = Slow()
    loading = LoadingScan("ball.mha", slow)
    workbench = Workbench(loading=loading)
    with serving(workbench, write_page(tmp_path / "page")) as access:
        assert loading.recognised()
        about = ask(access, "/api/library/").json()
        assert about["coming"] == "ball.mha"
        assert about["scan"] is None
        found: dict[str, httpx.Response] = {}

        def wait_for(path: str, method: str) -> None:
            found[path] = ask(access, path, method)

        threads = [
            Thread(target=wait_for, args=("/api/volume", "GET")),
            Thread(target=wait_for, args=("/api/library/coming", "POST")),
        ]
        for thread in threads:
            thread.start()
        assert found == {}
        slow.go.set()
        for thread in threads:
            thread.join(PATIENCE)
        assert found["/api/volume"].headers["x-palpate-dimensions"] == "41 41 41"
        assert lines_of(found["/api/library/coming"])[-1] == {"kind": "done"}
        about = ask(access, "/api/library/").json()
        assert about["coming"] is None
        assert about["scan"] == make_ball().volume.name
    workbench.end()


def test_why_a_scan_does_not_come_is_told_before_serving_ends(tmp_path: Path) -> None:
    slow = Slow(OptionError("no scan; allowed: scans"))
    loading = LoadingScan("ball.mha", slow)
    workbench = Workbench(loading=loading)
    workbench.page_seconds = PATIENCE
    given_up = Event()
    workbench.given_up = given_up.set
    with serving(workbench, write_page(tmp_path / "page")) as access:
        assert loading.recognised()
        slow.go.set()
        # the page comes late: what it waited for has failed meanwhile
        line = lines_of(ask(access, "/api/library/coming", "POST"))[-1]
        assert line == {"kind": "failed", "reason": "no scan. Use scans"}
        assert given_up.wait(PATIENCE)
        assert ask(access, "/api/volume").status_code == 409
    assert isinstance(loading.failure, OptionError)
    workbench.end()


def test_whoever_ends_palpate_ends_reading(tmp_path: Path) -> None:
    def read(progress: Progress) -> OpenScan:
        while True:
            progress("reading", None)

    loading = LoadingScan("ball.mha", read)
    workbench = Workbench(loading=loading)
    # leaving it asks the server to end, and waits until it has
    with serving(workbench, write_page(tmp_path / "page")):
        assert loading.recognised()
    assert workbench.opened is None
    assert loading.failure is None
    assert not loading.recognised()


def test_what_fails_before_values_are_read_is_never_announced() -> None:
    def refuse(progress: Progress) -> OpenScan:
        progress("looking at 3 files", 0.5)
        raise OptionError("no scan")

    loading = LoadingScan("readme.md", refuse)
    assert loading.read() is None
    assert not loading.recognised()
    with pytest.raises(OptionError, match="no scan"):
        loading.follow(silent)


def test_a_cancelled_reading_is_no_failure() -> None:
    def read(progress: Progress) -> OpenScan:
        loading.cancel()
        with pytest.raises(CancelledWorkError):
            progress("reading", 0.5)
        raise CancelledWorkError

    loading = LoadingScan("ball.mha", read)
    assert loading.read() is None
    assert loading.failure is None
