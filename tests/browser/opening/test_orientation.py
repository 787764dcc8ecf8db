"""A scan whose file tells no orientation is shown with its own axes, not with sides of a body."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from browser import ROOT, browser, palpate

pytestmark = [pytest.mark.browser]

OUTPUT = ROOT / "tests" / "output"
EDGES = "[...document.querySelectorAll('[data-testid^=edge-]')].map((each) => each.textContent)"


def block(folder: Path) -> Path:
    """Raw voxels of something in air."""
    values = np.full((24, 28, 32), -1000, "<i2")
    values[6:18, 7:21, 8:24] = 800
    path = folder / "block.raw"
    path.write_bytes(values.tobytes())
    return path


def test_unknown_sides_are_axes_and_given_ones_are_letters(tmp_path: Path) -> None:
    raw = ["--raw", "32x28x24,int16", "--voxel-size", "2,2,2"]
    with palpate("open", block(tmp_path), *raw) as command, browser() as page:
        page.do("open", url=command.url, width=1366, height=768)
        page.do("click", testid="layout-four")
        page.wait(f"{EDGES}.length >= 16")
        assert set(" ".join(page.read(EDGES)).split()) <= {"+x", "−x", "+y", "−y", "+z", "−z"}
        help_text = page.read("document.querySelector('[data-testid=edge-top]').title")
        assert "does not tell" in help_text
        page.do("clickText", text="Positions")
        assert "orientation unknown" in page.text("frame")
        page.read("window.palpate.cross([30, 20, 10])")
        page.shows("read-axial", "/x .*y .*z /.test(text)")
        assert (
            page.read(
                "[...document.querySelectorAll('svg text')].some((t) => t.textContent === 'A')"
            )
            is False
        )
        names = "[...document.querySelectorAll('[data-testid^=slice-]')].map((e) => e.ariaLabel)"
        assert {"x–y slice", "x–z slice", "y–z slice"} <= set(page.read(names))
        page.do("screenshot", path=str(OUTPUT / "orientation-unknown.png"))
        assert page.complaints == []

        # whoever knows it says it on the page, by a click
        before = page.read("performance.timeOrigin")
        page.do("click", testid="orientation-LPS")
        page.wait(f"performance.timeOrigin > {before} && window.palpate?.ready === true")
        page.wait(f"{EDGES}.length >= 4")
        assert set("".join(page.read(EDGES))) <= set("APLRSI")
        assert "(LPS)" in page.text("frame")
