"""What is seen is what is felt, on the page in a real browser.

The scan is a flat block, written here: where its surface is, and what must be felt on it, is
known without any code of Palpate.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from browser import Browser, browser, palpate

pytestmark = pytest.mark.browser

EDGE = 48
"""Voxels along the scan, each 1 mm."""
SURFACE = 23.5
"""Where the block begins along y [mm]; it fills everything from there to the back."""
MIDDLE = EDGE / 2


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """A block of bone in air on the page, seen from before."""
    import SimpleITK

    values = np.full((EDGE, EDGE, EDGE), -1000, np.int16)
    values[:, EDGE // 2 :, :] = 1000
    path = tmp_path_factory.mktemp("block") / "block.mha"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(path))
    options = ("--threshold", "500", "--unit", "HU", "--port", "0")
    with palpate("open", path, *options) as command, browser() as page:
        opening = page.do("open", url=command.url, width=1366, height=768)
        assert opening["firstPicture"] is not None
        page.read("window.palpate.setView('A')")
        yield page
        assert page.complaints == []


@pytest.fixture(autouse=True)
def before_the_block(page: Browser) -> None:
    """Has the probe before the block, which is shown and felt."""
    if not is_pressed(page, "visible-1"):
        page.do("click", testid="visible-1")
    if not is_pressed(page, "touchable-1"):
        page.do("click", testid="touchable-1")
    page.all_done()
    page.read(f"window.palpate.place({[MIDDLE, SURFACE - 10, MIDDLE]})")
    page.all_done()
    page.wait("!window.palpate.state.contact")


def is_pressed(page: Browser, testid: str) -> bool:
    return bool(
        page.read(f"document.querySelector('[data-testid={testid}]').ariaPressed === 'true'")
    )


def push(page: Browser) -> None:
    """Has the hand push 3 mm into the block."""
    wanted = [MIDDLE, SURFACE + 3, MIDDLE]
    page.read(f"window.palpate.hand({wanted})")
    # the device takes it in its own thread, which a busy machine may hold up while the servo runs
    page.wait(f"window.palpate.state.hand.every((c, i) => Math.abs(c - {wanted}[i]) < 0.01)")


def press(page: Browser) -> dict[str, Any]:
    """Pushes and returns the state once everything rests in contact."""
    push(page)
    page.wait("window.palpate.state.contact")
    return page.settled()


def is_there(page: Browser, testid: str) -> bool:
    return bool(page.read(f"document.querySelector('[data-testid={testid}]') !== null"))


def test_hiding_what_is_touched_ends_the_contact_and_undo_brings_it_back(page: Browser) -> None:
    assert np.linalg.norm(press(page)["force"]) > 0.5
    page.do("click", testid="visible-1")
    page.all_done()
    page.wait("!window.palpate.state.contact")
    free = page.settled()
    assert free["force"] == [0.0, 0.0, 0.0]
    assert free["proxy"][1] == pytest.approx(SURFACE + 3, abs=0.1)
    title = "document.querySelector('[data-testid=touchable-1]').title"
    assert "Hidden, so the probe does not feel it" in page.read(title)

    page.read(f"window.palpate.place({[MIDDLE, SURFACE - 10, MIDDLE]})")
    page.all_done()
    page.do("press", key="Control+z")
    page.all_done()
    assert is_pressed(page, "visible-1")
    felt = press(page)
    assert felt["proxy"][1] == pytest.approx(SURFACE, abs=0.1)
    assert felt["safety"]["violations"] == 0


def test_a_pinned_segment_is_felt_while_it_is_hidden_and_marked_in_the_list(page: Browser) -> None:
    assert not is_there(page, "pinned-1")
    page.do("click", testid="touched-while-hidden")
    page.all_done()
    # the mark is of what is hidden
    assert not is_there(page, "pinned-1")
    page.do("click", testid="visible-1")
    page.all_done()
    page.wait("document.querySelector('[data-testid=pinned-1]') !== null")
    told = page.read("document.querySelector('[data-testid=pinned-1]').title")
    assert told == "Hidden, and the probe feels it nevertheless: touched while hidden"
    assert press(page)["proxy"][1] == pytest.approx(SURFACE, abs=0.1)

    page.do("click", testid="touched-while-hidden")
    page.all_done()
    page.wait("!window.palpate.state.contact")
    assert not is_there(page, "pinned-1")
