"""An engine that stands still: what is known is shown as old, nothing is done blindly after it."""

from __future__ import annotations

import signal
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from browser import ROOT, Browser, Command, browser, palpate

pytestmark = [pytest.mark.browser, pytest.mark.data]

OUTPUT = ROOT / "tests" / "output"
MESSAGE = "document.querySelector('[data-testid=message]')"
LIGHT = "document.querySelector('[data-testid=status-light]').dataset.colour"
VISIBLE = "document.querySelector('[data-testid=visible-1]').ariaPressed"
OLD = "document.querySelectorAll('[data-testid=last-known]').length"


@pytest.fixture(scope="module")
def shown(data_folder: Path) -> Iterator[tuple[Command, Browser]]:
    """A head whose bone is touched, and a page that shows it."""
    head = data_folder / "cthead_stanford" / "CThead.mha"
    with palpate("open", head, "--threshold", "1350") as command, browser() as page:
        page.do("open", url=command.url, width=1366, height=768)
        page.read("window.palpate.place([127, 1, 150])")
        page.read("window.palpate.hand([127, 40, 150])")
        page.settled()
        yield command, page


def test_what_is_known_of_an_engine_that_stands_still_is_shown_as_old(
    shown: tuple[Command, Browser],
) -> None:
    command, page = shown
    page.wait(f"{LIGHT} === 'green'")
    assert page.read(OLD) == 0
    command.process.send_signal(signal.SIGSTOP)
    try:
        page.wait(f"{LIGHT} === 'amber'", seconds=20)
        assert "Not answering" in page.text("status-light")
        assert page.read(OLD) > 0, "the force is marked as the last known one"
        page.do("screenshot", path=str(OUTPUT / "paused-amber.png"))
        # then what happened and what to do
        page.wait(f"{MESSAGE} !== null", seconds=20)
        words = page.text("message")
        assert "does not answer" in words
        assert "goes on by itself" in words
        page.do("screenshot", path=str(OUTPUT / "paused-words.png"))
    finally:
        command.process.send_signal(signal.SIGCONT)
    page.wait(f"{MESSAGE} === null && {LIGHT} === 'green' && {OLD} === 0")


def test_what_was_asked_of_an_engine_that_stood_still_is_dropped_and_told(
    shown: tuple[Command, Browser],
) -> None:
    command, page = shown
    page.all_done()
    page.read("document.querySelectorAll('.notice button').forEach((each) => each.click())")
    assert page.read(VISIBLE) == "true"
    command.process.send_signal(signal.SIGSTOP)
    try:
        page.do("click", testid="visible-1")
        page.read("void Array.from({ length: 9 }, () => window.palpate.hand([127, 90, 150]))")
        page.wait(f"{MESSAGE} !== null", seconds=20)
    finally:
        command.process.send_signal(signal.SIGCONT)
    page.wait(f"{MESSAGE} === null && {LIGHT} === 'green'")
    page.shows("notice", "text.includes('was not done')")
    page.all_done()
    assert page.read(VISIBLE) == "true", "the bone is still shown"
    # what is asked from now on is done
    page.do("click", testid="visible-1")
    page.all_done()
    assert page.read(VISIBLE) == "false"
    page.do("click", testid="visible-1")
    page.all_done()
    assert page.read(VISIBLE) == "true"


def test_a_short_standstill_drops_nothing(shown: tuple[Command, Browser]) -> None:
    command, page = shown
    page.all_done()
    assert page.read(VISIBLE) == "true"
    command.process.send_signal(signal.SIGSTOP)
    try:
        page.do("click", testid="visible-1")
        time.sleep(0.2)
    finally:
        command.process.send_signal(signal.SIGCONT)
    page.all_done()
    assert page.read(VISIBLE) == "false"
    page.do("click", testid="visible-1")
    page.all_done()


def test_a_page_that_was_long_hidden_shows_force_and_contact_as_they_are_now(
    shown: tuple[Command, Browser],
) -> None:
    command, page = shown
    free = [127, 1, 80]
    page.read(f"window.palpate.place({free})")
    page.all_done()
    page.read("window.palpate.hand([127, 128, 80])")
    page.shows("force", "parseFloat(text) > 0.1")
    page.wait("window.palpate.state.contact")
    page.do("freeze", on=True)
    # meanwhile another page takes the hand away, and it stays there
    with browser() as other:
        other.do("open", url=command.url, width=640, height=480)
        other.read(f"window.palpate.place({free})")
        other.wait("!window.palpate.state.contact")
        other.all_done()
    page.do("freeze", on=False)
    page.shows("force", "parseFloat(text) === 0")
    page.shows("touched", "text.includes('nothing is touched')")
    page.wait(f"{LIGHT} === 'green' && {OLD} === 0 && {MESSAGE} === null")
    assert page.read("window.palpate.state.contact") is False
