"""What is seen is what is felt, on the page in a real browser.

The scan is a flat block of bone, dense but for a strip at its right side, written here: where its
surface is, and what must be felt on it, is known without any code of Palpate.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from browser import ROOT, Browser, browser, palpate
from numpy.typing import NDArray

pytestmark = pytest.mark.browser

OUTPUT = ROOT / "tests" / "output"

EDGE = 48
"""Voxels along the scan, each 1 mm."""
SURFACE = 23.5
"""Where the block begins along y [mm]; it fills everything from there to the back."""
MIDDLE = EDGE / 2
STRIP = 12
"""Voxels of the strip along x: 400 HU, where the rest has 1000."""


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """A block of bone in air on the page, seen from before."""
    import SimpleITK

    values = np.full((EDGE, EDGE, EDGE), -1000, np.int16)
    values[:, EDGE // 2 :, :] = 1000
    values[:, EDGE // 2 :, :STRIP] = 400
    path = tmp_path_factory.mktemp("block") / "block.mha"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(path))
    options = ("--threshold", "300", "--unit", "HU", "--port", "0")
    with palpate("open", path, *options) as command, browser() as page:
        opening = page.do("open", url=command.url, width=1200, height=560)
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


def in_picture(page: Browser, pixels: NDArray[np.float64], low: float, high: float) -> Any:
    """Returns the pixels of the block's front from one place along x to another [mm]."""
    front = [MIDDLE, SURFACE, MIDDLE]
    size = page.read(f"window.palpate.pixelSizeAt({front})")
    across, down = page.read("window.palpate.middle")
    columns = [round(across + (x - MIDDLE) / size) for x in (low, high)]
    rows = [round(down + (z - MIDDLE) / size) for z in (8, EDGE - 8)]
    return pixels[slice(*rows), slice(*columns)]


def is_there(page: Browser, testid: str) -> bool:
    return bool(page.read(f"document.querySelector('[data-testid={testid}]') !== null"))


def test_hiding_what_is_touched_ends_the_contact_and_undo_brings_it_back(page: Browser) -> None:
    page.shows("touched", "text === 'Free: nothing is touched'")
    assert np.linalg.norm(press(page)["force"]) > 0.5
    page.shows("touched", "text === 'threshold · hard · 1000 HU'")
    page.do("click", testid="visible-1")
    page.all_done()
    page.wait("!window.palpate.state.contact")
    free = page.settled()
    assert free["force"] == [0.0, 0.0, 0.0]
    assert free["proxy"][1] == pytest.approx(SURFACE + 3, abs=0.1)
    page.shows("touched", "text === 'Free: in threshold, which is hidden'")
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


def parts(page: Browser, name: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the pixels of the strip and of the dense bone."""
    pixels = page.picture(OUTPUT / f"felt_{name}.png")
    strip = in_picture(page, pixels, 2.0, STRIP - 2.0)
    return strip, in_picture(page, pixels, STRIP + 2.0, EDGE - 2.0)


def test_the_picture_changes_where_touch_does(page: Browser) -> None:
    strip, dense = parts(page, "all")
    assert np.abs(strip.mean((0, 1)) - dense.mean((0, 1))).max() < 0.1, "one bone"

    page.do("fill", testid="threshold", text="700")
    page.all_done()
    page.read(f"window.palpate.place({[STRIP / 2, SURFACE + 10, MIDDLE]})")
    page.shows("touched", "text === 'Free: in bone of no segment'")
    hinted, still_dense = parts(page, "raised")
    assert np.abs(still_dense - dense).mean() < 0.02
    assert strip.mean() - hinted.mean() > 0.2, "what is not felt is not drawn as bone"
    assert hinted.mean() > 0.1, "it is hinted at"

    page.draw_by("browser")
    by_browser, _ = parts(page, "by_browser")
    page.draw_by("engine")
    assert np.abs(by_browser - hinted).mean() < 0.03

    page.do("click", testid="only-touched")
    page.frames()
    hidden, still_dense = parts(page, "only")
    assert np.abs(still_dense - dense).mean() < 0.02
    assert hidden.mean() < hinted.mean() - 0.02, "nothing of it is left"
    page.do("press", key="Control+z")
    page.frames()
    assert np.abs(parts(page, "undone")[0] - hinted).mean() < 0.01

    page.do("press", key="Control+z")
    page.all_done()
    assert np.abs(parts(page, "again")[0] - strip).mean() < 0.02


CUT = 34.5
"""Where the clip box cuts the block along y [mm], 11 voxels deep."""


@pytest.fixture
def clipped(page: Browser) -> Iterator[Browser]:
    """The page with the front of the scan cut away down into the block; nothing is, afterwards."""
    page.do("click", testid="clip-box")
    page.do("slide", testid="clip-A", value=35)
    assert page.text("clip-A-value") == "35.0 mm"
    page.all_done()
    yield page
    page.do("release")
    page.do("click", testid="clip-reset")
    page.all_done()


def sink(page: Browser) -> dict[str, Any]:
    """Has the hand go from before the block to 3 mm behind the cut; returns the state at rest."""
    page.read(f"window.palpate.place({[MIDDLE, SURFACE - 10, MIDDLE]})")
    page.all_done()
    page.read(f"window.palpate.hand({[MIDDLE, CUT + 3, MIDDLE]})")
    page.wait("window.palpate.state.contact")
    return page.settled()


def test_what_the_clip_cuts_away_is_not_felt_and_the_cut_is(clipped: Browser) -> None:
    page = clipped
    felt = sink(page)
    assert felt["proxy"][1] == pytest.approx(CUT, abs=0.1)
    assert np.linalg.norm(felt["force"]) > 0.5
    assert felt["safety"]["violations"] == 0
    # switched off it is felt again, around the probe first: that is brought out
    page.do("click", testid="clip-touch")
    page.all_done()
    assert sink(page)["proxy"][1] == pytest.approx(SURFACE, abs=0.1)
    page.do("click", testid="clip-touch")
    page.all_done()
    assert sink(page)["proxy"][1] == pytest.approx(CUT, abs=0.1)
    # the clip is a step of the page's undo, and touch goes with it
    page.do("press", key="Control+z")
    page.all_done()
    assert sink(page)["proxy"][1] == pytest.approx(SURFACE, abs=0.1)
    page.do("press", key="Control+Shift+z")
    page.all_done()
    assert sink(page)["proxy"][1] == pytest.approx(CUT, abs=0.1)


def test_a_press_of_the_mouse_lands_on_the_cut_where_it_is_seen(clipped: Browser) -> None:
    page = clipped
    page.do("press", key="t")
    # beside the middle, where the handle of the face stands
    page.do("dragElement", testid="canvas", **{"from": [60.0, 40.0]}, hold=True)
    page.wait("window.palpate.state.contact")
    state = page.settled()
    page.do("release")
    page.do("press", key="t")
    assert state["proxy"][1] == pytest.approx(CUT, abs=0.2)
    assert np.linalg.norm(state["force"]) == pytest.approx(1.0, rel=0.1)
    assert state["safety"]["violations"] == 0
    page.wait("!window.palpate.state.contact")
