"""Pages that share a session, and graphics that are lost, on a real scan in a real browser."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from browser import ROOT, browser, palpate

pytestmark = [pytest.mark.browser, pytest.mark.data]

OUTPUT = ROOT / "tests" / "output"
BONE = 1350
LOSE = """(() => {
  const gl = document.querySelector("canvas").getContext("webgl2");
  window.__graphics = gl.getExtension("WEBGL_lose_context");
  window.__graphics.loseContext();
})()"""
LOST = "document.querySelector('[data-testid=graphics-lost]')"
BRIGHTNESS = """(() => {
  const canvas = document.querySelector("%s"), copy = document.createElement("canvas");
  [copy.width, copy.height] = [canvas.width, canvas.height];
  const context = copy.getContext("2d");
  context.drawImage(canvas, 0, 0);
  const { data } = context.getImageData(0, 0, copy.width, copy.height);
  return data.reduce((sum, shade, i) => sum + (i %% 4 === 0 ? shade : 0), 0) / (data.length / 4);
})()"""
"""Mean of the red of a canvas, 0..255."""
VISIBLE = "document.querySelector('[data-testid=visible-1]').ariaPressed"


@pytest.mark.long
def test_two_pages_follow_one_another_and_lost_graphics_come_back(data_folder: Path) -> None:
    scan = data_folder / "cthead_stanford" / "CThead.mha"
    with (
        palpate("open", scan, "--threshold", str(BONE)) as command,
        browser(drawer="browser") as page,
        browser(drawer="browser") as other,
    ):
        page.do("open", url=command.url, width=1000, height=460)
        before = page.picture(OUTPUT / "graphics_before.png")

        page.read("void (window.__filter = window.palpate.filter)")
        page.read("window.palpate.place([127, 1, 150])")
        page.read("window.palpate.hand([127, 60, 150])")
        page.do("click", testid="tool-eraser")
        page.settled()
        page.read(LOSE)
        # it is told, and what cannot be seen is not done
        page.wait(f"{LOST} !== null")
        words = page.text("graphics-lost")
        assert "Tools are held" in words
        assert "Reload" in words
        page.do("screenshot", path=str(OUTPUT / "graphics_lost.png"))
        page.do("hold", key="x")
        page.all_done()
        page.do("hold", key="x", up=True)
        page.all_done()
        assert page.read("window.palpate.state.can_undo") is False, "nothing was erased unseen"
        page.wait(f"{LOST}.textContent.includes('close the browser')", seconds=30)
        other.do("open", url=command.url, width=1000, height=460)
        other.do("click", testid="visible-1")
        other.all_done()
        page.wait(f"{VISIBLE} === 'false'")
        page.read("window.__graphics.restoreContext()")
        page.wait(f"{LOST} === null")
        restored = page.picture(OUTPUT / "graphics_restored.png")
        # another context may have another GPU
        assert page.read("window.palpate.filter !== window.__filter"), "the filter is measured anew"
        # one hand for both pages: it is said who has it, until it is moved here
        other.shows("hand-led", r"/opened at \d\d:\d\d moves the hand/.test(text)")
        other.do("screenshot", path=str(OUTPUT / "hand_of_another_page.png"))
        never_lost = other.picture(OUTPUT / "graphics_never_lost.png")

        # between two pages of one view only the noise of the rays differs; what the hidden bone
        # changes must stand out from that
        assert np.abs(never_lost - before).mean() > 2 / 255, "the bone is hidden"
        assert np.abs(restored - never_lost).mean() < 1 / 255
        other.read("window.palpate.hand([127, 50, 150])")
        other.wait("document.querySelector('[data-testid=hand-led]') === null")
        page.shows("hand-led", "text.includes('moves the hand')")
        assert page.complaints == []
        assert other.complaints == []


def test_the_picture_that_is_kept_for_lost_graphics_is_the_one_that_was_seen(
    data_folder: Path,
) -> None:
    scan = data_folder / "cthead_stanford" / "CThead.mha"
    with palpate("open", scan) as command, browser(drawer="browser") as page:
        page.do("open", url=command.url, width=1000, height=460)
        page.do("choose", testid="layout-names", value="slices")
        page.finish()
        before = page.read(BRIGHTNESS % "main canvas")
        # slices are drawn again in one frame: the picture is finished all the while
        page.do("dragElement", testid="slice-axial", x=0, y=-150, button="right")
        page.finish()
        page.frames()
        seen = page.read(BRIGHTNESS % "main canvas")
        assert abs(seen - before) > 5, "another level"
        page.read(LOSE)
        page.wait(f"{LOST} !== null")
        page.do("screenshot", path=str(OUTPUT / "graphics_lost_slices.png"))
        assert page.read(BRIGHTNESS % ".lost canvas") == pytest.approx(seen, abs=0.5)
        assert page.complaints == []
