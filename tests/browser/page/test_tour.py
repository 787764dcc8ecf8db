"""The tour for who is here for the first time: it goes along with what a person does.

The scan is a flat block of bone in air, written here.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import SimpleITK
from browser import ROOT, Browser, browser, palpate

pytestmark = pytest.mark.browser

OUTPUT = ROOT / "tests" / "output"
EDGE = 48
OPTIONS = ("--threshold", "300", "--unit", "HU", "--port", "0")
NOT_SEEN = f"localStorage.setItem('palpate.tour', {json.dumps(json.dumps({'seen': False}))})"
CARD = "document.querySelector('[data-testid=tour]')"
WIDE = {"width": 1366, "height": 768}


@pytest.fixture(scope="module")
def url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    values = np.full((EDGE, EDGE, EDGE), -1000, np.int16)
    values[:, EDGE // 2 :, :] = 1000
    path = tmp_path_factory.mktemp("block") / "block.mha"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(path))
    with palpate("open", path, *OPTIONS) as command:
        yield command.url


@pytest.fixture(scope="module")
def page(url: str) -> Iterator[Browser]:
    with browser() as opened:
        # a page that a program drives shows no tour by itself
        assert opened.do("open", url=url, **WIDE)["firstPicture"]
        assert opened.read(f"{CARD} === null")
        opened.read(NOT_SEEN)
        yield opened
        assert opened.complaints == []


def visit(page: Browser, url: str, width: int = 1366, height: int = 768) -> None:
    """Comes as for the first time, and sees the first step."""
    page.read(NOT_SEEN)
    page.do("open", url=url, width=width, height=height)
    page.shows("tour-says", "text.includes('Turn it')")


def free_of_the_middle(page: Browser) -> bool:
    """Says whether the card is on the page, and covers nothing of the picture's middle."""
    return bool(
        page.read(
            f"(() => {{ const card = {CARD}.getBoundingClientRect();"
            " const seen = document.querySelector('[data-testid=canvas]').getBoundingClientRect();"
            " const [w, h] = [seen.width / 4, seen.height / 4];"
            " return card.left >= 0 && card.top >= 0 && card.right <= innerWidth"
            " && card.bottom <= innerHeight && (card.right <= seen.left + w"
            " || card.left >= seen.right - w || card.bottom <= seen.top + h"
            " || card.top >= seen.bottom - h); })()"
        )
    )


def test_the_tour_goes_on_by_what_is_done_and_is_not_shown_again(page: Browser, url: str) -> None:
    visit(page, url)
    # it may be the view of before, and turning is the first step
    page.read("window.palpate.setView('A')")
    page.frames()
    assert free_of_the_middle(page)
    assert [found for found in page.do("axe")["value"] if "tour" in str(found)] == []
    page.do("screenshot", path=str(OUTPUT / "tour-turn.png"))
    page.do("drag", x=30, y=0)
    page.shows("tour-says", "text.includes('Touch it')")
    page.read("window.palpate.setView('A')")

    page.do("press", key="t")
    page.shows("tour-says", "text.includes('amber arrow')")
    page.do("dragElement", testid="canvas", hold=True)
    page.shows("tour-says", "text.includes('Choose what is felt')")
    page.do("release")
    # leaving touch does not leave the tour
    page.do("press", key="Escape")
    page.frames()
    page.do("screenshot", path=str(OUTPUT / "tour-threshold.png"))
    assert free_of_the_middle(page)
    page.do("fill", testid="threshold", text="200")
    page.shows("tour-says", "text.includes('Take the drill')")

    page.do("press", key="d")
    page.shows("tour-says", "text.includes('hold Shift')")
    assert free_of_the_middle(page)
    page.do("screenshot", path=str(OUTPUT / "tour-drill.png"))
    page.do("press", key="t")
    page.do("stroke", held=True)
    page.shows("tour-says", "text.includes('Take it back')")
    page.do("release")
    page.all_done()
    page.do("press", key="Control+z")
    page.wait(f"{CARD} === null")

    page.do("open", url=url, **WIDE)
    page.wait("window.palpate.ready")
    page.frames()
    assert page.read(f"{CARD} === null")


def test_esc_and_skip_leave_it_and_the_help_brings_it_back(page: Browser, url: str) -> None:
    visit(page, url)
    page.do("press", key="Escape")
    page.wait(f"{CARD} === null")
    page.do("press", key="?")
    page.do("click", testid="show-tour")
    page.shows("tour-says", "text.includes('Turn it')")
    # whoever asked for it can go on by the keyboard alone
    page.wait("document.activeElement?.dataset.testid === 'tour-next'")
    for title in ("Touch it", "Choose what is felt", "Drill", "Take it back"):
        page.do("press", key="Enter")
        page.shows("tour-says", f"text.includes('{title}')")
    page.do("click", testid="tour-skip")
    page.wait(f"{CARD} === null")
    assert page.read("document.activeElement?.dataset.testid") == "canvas"


@pytest.mark.parametrize(("width", "height"), [(900, 700), (480, 800)])
def test_in_a_small_window_it_speaks_of_what_can_be_seen(
    page: Browser, url: str, width: int, height: int
) -> None:
    visit(page, url, width, height)
    for step in range(5):
        page.frames()
        page.do("screenshot", path=str(OUTPUT / f"tour-{width}-{step}.png"))
        assert free_of_the_middle(page), step
        page.do("click", testid="tour-next")
    page.wait(f"{CARD} === null")


def test_with_no_scan_open_it_begins_with_opening_one(tmp_path: Path) -> None:
    with palpate("open", "--port", "0", state=tmp_path) as command, browser() as page:
        page.do("open", url=command.url, **WIDE)
        assert page.read(f"{CARD} === null")
        page.read(NOT_SEEN)
        page.do("open", url=command.url, **WIDE)
        page.shows("tour-says", "text.includes('Open a scan')")
        page.frames()
        page.do("screenshot", path=str(OUTPUT / "tour-open.png"))
        assert page.do("axe")["value"] == []
        page.do("press", key="Escape")
        page.wait(f"{CARD} === null")
        assert page.complaints == []
