"""Segments found and changed at the page: grown from a click, shaped, taken back."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
import SimpleITK
from browser import ROOT, Browser, browser, palpate

pytestmark = pytest.mark.browser

OUTPUT = ROOT / "tests" / "output"
SIZE = {"width": 1366, "height": 768}
PLACE_OF_BALL = """(() => {
  const slice = window.palpate.slices.find(({ name }) => name === 'axial');
  const { plane, rect } = slice;
  const off = [34, 24, 24].map((c, axis) => c - plane.centre[axis]);
  const along = (axis) => off.reduce((sum, c, place) => sum + c * axis[place], 0) / plane.pixel;
  return [0.5 + along(plane.right) / rect.width, 0.5 - along(plane.up) / rect.height];
})()"""
"""Where (34, 24, 24), between core and border, is on the axial slice, in shares of its pane."""


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """A ball of 500 around a core of 900, and a small one, on the page."""
    path = tmp_path_factory.mktemp("found") / "balls.mha"
    z, y, x = np.indices((48, 48, 64))
    places = np.stack([x, y, z], axis=-1)
    values = np.zeros((48, 48, 64), np.int16)
    values[np.linalg.norm(places - (24, 24, 24), axis=-1) <= 16] = 500
    values[np.linalg.norm(places - (24, 24, 24), axis=-1) <= 6] = 900
    values[np.linalg.norm(places - (54, 24, 24), axis=-1) <= 4] = 500
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(path))
    with palpate("open", path, "--threshold", "250,600") as command, browser() as opened:
        assert opened.do("open", url=command.url, **SIZE)["firstPicture"] is not None
        yield opened


SHOWN_SIZE = "document.querySelector('[data-testid=segment-1] .size').textContent"


def test_shapes_change_by_one_step_of_undo_and_a_click_grows_a_region(page: Browser) -> None:
    page.do("clickText", text="Change shape")
    sizes = [page.read(SHOWN_SIZE)]
    for kind in ("keep-largest", "fill-holes", "grow"):
        page.do("choose", testid="shape-kind", value=kind)
        page.do("click", testid="shape-apply")
        page.wait(f"{SHOWN_SIZE} !== {sizes[-1]!r}")
        sizes.append(page.read(SHOWN_SIZE))
    page.finish()
    page.do("screenshot", path=str(OUTPUT / "segment_shape.png"))
    for size in reversed(sizes[:-1]):
        page.do("press", key="Control+z")
        page.wait(f"{SHOWN_SIZE} === {size!r}")

    page.do("click", testid="find-segments")
    page.do("click", testid="layout-four")
    page.read("window.palpate.cross([24, 24, 24])")
    page.finish()
    page.do("click", testid="grow-click")
    # Escape means none
    page.do("press", key="Escape")
    page.wait("document.querySelector('[data-testid=grow-click]').ariaPressed === 'false'")
    page.do("click", testid="grow-click")
    place = page.read(PLACE_OF_BALL)
    page.do("clickAt", testid="slice-axial", x=place[0], y=place[1])
    page.shows("segment-2", "/Region 2/.test(text)")
    page.finish()
    page.do("screenshot", path=str(OUTPUT / "segment_grown.png"))
    page.do("press", key="Control+z")
    page.wait("document.querySelector('[data-testid=segment-2]') === null")

    page.do("choose", testid="otsu-classes", value="3")
    page.do("click", testid="otsu-make")
    page.wait(
        "[...document.querySelectorAll('[data-testid^=segment-]')]"
        ".some(({ textContent }) => /Otsu 3 of 3/.test(textContent))"
    )
