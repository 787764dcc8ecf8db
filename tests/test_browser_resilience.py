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
VISIBLE = "document.querySelector('[data-testid=visible-1]').ariaPressed"


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
        never_lost = other.picture(OUTPUT / "graphics_never_lost.png")

        # between two pages of one view only the noise of the rays differs; what the hidden bone
        # changes must stand out from that
        assert np.abs(never_lost - before).mean() > 2 / 255, "the bone is hidden"
        assert np.abs(restored - never_lost).mean() < 1 / 255
        assert page.complaints == []
        assert other.complaints == []
