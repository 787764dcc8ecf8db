"""A page that cannot start says so, and what to do: it never says "is starting" for ever."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from browser import ROOT, Command, browser, palpate

pytestmark = [pytest.mark.browser, pytest.mark.data]

OUTPUT = ROOT / "tests" / "output"
FAILURE = "document.querySelector('[data-testid=failure]')"
CONTROLS = "document.querySelector('[data-testid=force]')"


@pytest.fixture(scope="module")
def command(data_folder: Path) -> Iterator[Command]:
    """A head to open pages of."""
    with palpate("open", data_folder / "cthead_stanford" / "CThead.mha") as running:
        yield running


def test_a_browser_whose_language_is_no_valid_tag_shows_the_scan(command: Command) -> None:
    # WebKitGTK with LANG=C.UTF-8
    language = (
        "Object.defineProperty(Navigator.prototype, 'language',"
        " { get: () => 'c.utf-8', configurable: true })"
    )
    with browser() as page:
        page.do("beforeOpen", script=language)
        page.do("open", url=command.url, width=1000, height=600)
        page.wait("window.palpate?.ready === true")
        assert page.read(f"{CONTROLS} !== null")
        assert page.complaints == []


@pytest.mark.parametrize(
    ("when", "script"),
    [
        (
            "its scripts are read",
            "Intl.NumberFormat = function () { throw new Error('no numbers') }",
        ),
        ("it is made", "window.Worker = function () { throw new Error('no numbers') }"),
        (
            "its panels are made",
            "window.ResizeObserver = function () { throw new Error('no numbers') }",
        ),
    ],
)
def test_an_exception_at_the_start_is_shown_with_what_to_do(
    command: Command, when: str, script: str
) -> None:
    with browser() as page:
        page.do("beforeOpen", script=script)
        page.do("open", url=command.url, width=1000, height=600, seconds=5)
        page.wait(f"{FAILURE} !== null", seconds=20)
        words = page.text("failure")
        assert "no numbers" in words, when
        assert "Reload" in words
        assert "is starting" not in page.read("document.body.textContent")
        page.do("screenshot", path=str(OUTPUT / f"start-failure-{when.split()[1]}.png"))
