"""The needle on the page in a real browser: tissues, puncture, what is told, and the way out.

The scan is a flat block, as in ``test_browser_tools.py``.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from browser import ROOT, Browser, browser, palpate

pytestmark = pytest.mark.browser

OUTPUT = ROOT / "tests" / "output"
EDGE = 48
"""Voxels along the scan, each 1 mm."""
SURFACE = 23.5
"""Where the block begins along y [mm]; it fills everything from there to the back."""
MIDDLE = EDGE / 2
NEEDLE = "window.palpate.state.needle"
TISSUE = "document.querySelector('[data-testid=needle-tissue-1]')"


@pytest.fixture
def page(tmp_path: Path) -> Iterator[Browser]:
    """The block on the page, seen from before, with the probe close to it."""
    import SimpleITK

    values = np.full((EDGE, EDGE, EDGE), -1000, np.int16)
    values[:, EDGE // 2 :, :] = 1000
    block = tmp_path / "block.mha"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(block))
    options = ("--threshold", "500", "--unit", "HU", "--port", "0")
    with palpate("open", block, *options) as command, browser() as opened:
        assert (
            opened.do("open", url=command.url, width=1366, height=768)["firstPicture"] is not None
        )
        opened.read("window.palpate.setView('A')")
        opened.read(f"window.palpate.place({[MIDDLE, SURFACE - 2, MIDDLE]})")
        opened.wait(f"Math.abs(window.palpate.state.proxy[1] - {SURFACE - 2}) < 0.5")
        yield opened
        assert opened.complaints == []


def hold(page: Browser, *, on: bool) -> None:
    """Holds the key of the tool, or lets it go."""
    kind = "keydown" if on else "keyup"
    page.read(f"void window.dispatchEvent(new KeyboardEvent('{kind}', {{key: 'x'}}))")


def test_a_needle_goes_into_tissue_tells_of_it_and_is_withdrawn(page: Browser) -> None:
    page.do("click", testid="tool-needle")
    # a threshold may be bone: nobody has said what it is
    page.wait("document.body.textContent.includes('Nothing here is soft for the needle')")
    page.read(
        f"void (() => {{ {TISSUE}.value = 'liver';"
        f" {TISSUE}.dispatchEvent(new Event('change', {{ bubbles: true }})); }})()"
    )
    page.wait("window.palpate.state.tool.kind === 'needle'")
    # 20 G unless another one is chosen
    assert page.read("window.palpate.state.tool.radius") == pytest.approx(0.455)

    hold(page, on=True)
    page.wait("window.palpate.state.tool.on")
    page.read(f"window.palpate.hand({[MIDDLE, SURFACE + 12, MIDDLE]})")
    page.wait(f"{NEEDLE}.inside && {NEEDLE}.depth > 1")
    page.shows("needle-events", "text.includes('punctured')")
    page.shows("needle-depth", "parseFloat(text) > 1")
    # the shaft is rubbed, and the tip is in the block
    page.wait(f"{NEEDLE}.friction > 0 && {NEEDLE}.segment === 1")
    page.do("screenshot", path=str(OUTPUT / "needle-in.png"))

    hold(page, on=False)
    page.wait("!window.palpate.state.tool.on")
    # let go it stays in
    assert page.read(f"{NEEDLE}.inside")
    page.do("click", testid="needle-withdraw")
    page.wait(f"!{NEEDLE}.inside")
    page.shows("needle-events", "text.includes('withdrawn')")
    page.wait(f"window.palpate.state.proxy[1] < {SURFACE}")
