"""The workbench: one open scan at most, exchanged while the server runs, and what comes back."""

from __future__ import annotations

from asyncio import AbstractEventLoop, get_running_loop, run_coroutine_threadsafe
from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path

import httpx
import numpy as np
import pytest
from made_scans import make_ball
from palpate.base.errors import OptionError
from palpate.saved.journal import Journal
from palpate.server.closing import EXCHANGED
from palpate.server.open_scan import OpenScan
from palpate.server.security import Access
from palpate.server.workbench import Workbench
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume, VolumeTraits
from running_server import PATIENCE, Page, page_at, serving, write_page
from websockets.exceptions import ConnectionClosed, InvalidStatus

ABOVE = SessionOptions(real_time=False, start=(20.0, 20.0, 34.0))
"""The probe 6 mm above the ball's top, and time that stands still until it is told to pass."""


def get(access: Access, path: str) -> httpx.Response:
    address = f"http://127.0.0.1:{access.port}{path}"
    cookie = {"Cookie": f"{access.cookie}={access.token}"}
    return httpx.get(address, headers=cookie, trust_env=False, timeout=PATIENCE)


def looking(access: Access) -> AbstractContextManager[Page]:
    address = f"127.0.0.1:{access.port}/api/live?token={access.token}"
    return page_at(address, access.port, origin=f"http://127.0.0.1:{access.port}")


def drilled(folder: Path) -> np.ndarray:
    """Drills the ball, in a journal; returns the scan's values after it."""
    with Session(make_ball(), options=ABOVE) as session:
        journal = Journal(session, folder=folder)
        journal.start()
        session.set_tool("drill", radius=2.0, segment_ids=[1])
        session.stroke(on=True)
        session.hand((20.0, 20.0, 22.0))
        session.let_pass(1.0)
        session.stroke(on=False)
        left = session.segment(1).mask()
    journal.close()
    ball = make_ball().volume.array
    return np.where((ball == 100) & (left == 0), np.int16(-1000), ball)


def test_edits_that_were_brought_back_before_the_server_began_are_in_the_picture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = drilled(tmp_path)
    assert (expected != make_ball().volume.array).any()
    monkeypatch.setenv("PALPATE_STATE", str(tmp_path))
    opened = OpenScan.begin(make_ball(), journalled=True, recover=True, notify=lambda _: None)
    workbench = Workbench(opened)
    with serving(workbench, write_page(tmp_path / "page")) as access:
        # what was brought back is told before the first state
        with looking(access) as page:
            page.receive("state")
        answer = get(access, "/api/volume")
        np.testing.assert_array_equal(
            np.frombuffer(answer.content, "<i2").reshape(41, 41, 41), expected
        )
    workbench.end()


def other() -> Scene:
    """A scan of another size and name than the ball."""
    values = np.arange(4 * 5 * 6, dtype=np.int16).reshape(4, 5, 6)
    return Scene(Volume(values, spacing=(1, 1, 1), traits=VolumeTraits(name="other")))


def exchanged(workbench: Workbench, loop: AbstractEventLoop, make: Callable[[], OpenScan]) -> None:
    run_coroutine_threadsafe(workbench.exchange(make), loop).result(PATIENCE)


class Watched(Workbench):
    """Tells in which loop it is served."""

    loop: AbstractEventLoop

    async def start(self) -> None:
        self.loop = get_running_loop()
        await super().start()


def test_another_scan_takes_the_place_of_the_open_one(tmp_path: Path) -> None:
    first = OpenScan.begin(make_ball(), notify=lambda _: None)
    workbench = Watched(first)
    with serving(workbench, write_page(tmp_path / "page")) as access:
        with looking(access) as page:
            page.receive("state")
            exchanged(workbench, workbench.loop, lambda: OpenScan.begin(other()))
            with pytest.raises(ConnectionClosed) as closed:
                page.receive("never")
            assert closed.value.rcvd is not None
            assert closed.value.rcvd.code == EXCHANGED
        assert not first.session.is_running
        answer = get(access, "/api/volume")
        assert answer.headers["x-palpate-dimensions"] == "6 5 4"
        with looking(access) as page:
            assert page.receive("hello")["scan"]["name"] == "other"
            page.receive("state")
    workbench.end()


def test_without_a_scan_the_server_says_so_and_takes_one_later(tmp_path: Path) -> None:
    workbench = Watched()
    with serving(workbench, write_page(tmp_path / "page")) as access:
        assert get(access, "/").status_code == 200
        answer = get(access, "/api/volume")
        assert (answer.status_code, answer.text[:15]) == (409, "no scan is open")
        with pytest.raises(InvalidStatus, match="403"), looking(access):
            pass
        exchanged(workbench, workbench.loop, lambda: OpenScan.begin(other()))
        assert get(access, "/api/volume").status_code == 200
    workbench.end()


def test_where_the_new_scan_cannot_begin_nothing_is_open(tmp_path: Path) -> None:
    def fails() -> OpenScan:
        raise OptionError("not this one")

    first = OpenScan.begin(make_ball(), notify=lambda _: None)
    workbench = Watched(first)
    with serving(workbench, write_page(tmp_path / "page")) as access:
        with pytest.raises(OptionError, match="not this one"):
            exchanged(workbench, workbench.loop, fails)
        assert get(access, "/api/volume").status_code == 409
        assert not first.session.is_running
    workbench.end()


def test_what_cannot_be_kept_of_the_old_scan_is_told_and_the_new_one_opens(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(_: OpenScan) -> None:
        raise OSError(28, "No space left on device")

    first = OpenScan.begin(make_ball(), notify=lambda _: None)
    workbench = Watched(first)
    with serving(workbench, write_page(tmp_path / "page")) as access:
        with monkeypatch.context() as patch:
            patch.setattr(OpenScan, "end", full)
            exchanged(workbench, workbench.loop, lambda: OpenScan.begin(other()))
        assert get(access, "/api/volume").status_code == 200
        assert "No space left" in workbench.take_notices()[0]
    workbench.end()
