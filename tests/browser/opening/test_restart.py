"""A page goes on by itself once its server is started again; of one that was stopped it says so."""

from __future__ import annotations

import signal
from pathlib import Path

import pytest
from browser import ROOT, browser, palpate

pytestmark = [pytest.mark.browser, pytest.mark.data]

OUTPUT = ROOT / "tests" / "output"
ROWS = "document.querySelectorAll('[data-testid^=visible-]').length"
MESSAGE = "document.querySelector('[data-testid=message]')"


def test_a_page_goes_on_after_its_server_was_killed_and_started_again(
    data_folder: Path, tmp_path: Path
) -> None:
    wanted: list[str | Path] = [
        "open",
        data_folder / "cthead_stanford" / "CThead.mha",
        "--threshold",
        "1350",
    ]
    with browser() as page:
        with palpate(*wanted, state=tmp_path) as command:
            page.do("open", url=command.url, width=1366, height=768)
            page.do("click", testid="find-segments")
            page.do("click", testid="otsu-make")
            # bone by its threshold, and the classes above the lowest
            page.wait(f"{ROWS} === 3")
            page.read("window.palpate.setView('R')")
            page.all_done()
            page.finish()
            camera = page.read("window.palpate.camera")
            command.process.send_signal(signal.SIGKILL)
            page.wait(f"{MESSAGE} !== null")
            assert "start it again with the same scan" in page.text("message")
        page.do("resize", width=900, height=700)
        page.do("screenshot", path=str(OUTPUT / "restart-lost.png"))
        page.do("resize", width=1366, height=768)
        page.read("window.__before = true")
        with palpate(*wanted, state=tmp_path) as again:
            # the same port, and another token
            assert again.url.partition("?")[0] == command.url.partition("?")[0]
            assert again.url != command.url
            page.wait(
                "window.__before === undefined && window.palpate?.ready === true", seconds=120.0
            )
            # changes are back without a question
            page.wait(f"{ROWS} === 3 && {MESSAGE} === null")
            page.wait("window.palpate.state.can_undo")
            assert page.read("window.palpate.camera") == camera
            page.do("screenshot", path=str(OUTPUT / "restart-back.png"))
            assert page.read("document.querySelector('[data-testid=recovery]')") is None
            # touch goes on
            page.read("window.palpate.place([127, 1, 150])")
            page.all_done()
            # stopped on purpose: the page says so, and goes on saying it
            assert again.stop() == 0
            page.wait(f"{MESSAGE}?.textContent.includes('The session has ended')")
        page.read("new Promise((resolve) => setTimeout(resolve, 5000))")
        words = page.text("message")
        assert "The session has ended" in words
        assert "start Palpate" in words
        assert "same scan" in words
        for theme in ("dark", "light"):
            page.read(f"document.documentElement.dataset.theme = '{theme}'")
            page.do("screenshot", path=str(OUTPUT / f"restart-ended-{theme}.png"))
        with palpate(*wanted, state=tmp_path):
            page.wait(
                f"window.palpate?.ready === true && {MESSAGE} === null && {ROWS} === 3",
                seconds=120.0,
            )
