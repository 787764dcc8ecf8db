"""The needle on the page in a real browser: tissues, puncture, what is told, and the way out.

The scan is a flat block, as in ``test_tools.py``.
"""

from __future__ import annotations

from collections.abc import Iterator

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


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """The block on the page, seen from before, with the probe close to it."""
    import SimpleITK

    values = np.full((EDGE, EDGE, EDGE), -1000, np.int16)
    values[:, EDGE // 2 :, :] = 1000
    block = tmp_path_factory.mktemp("block") / "block.mha"
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
    # soft tissue is added by a button, and taken back
    page.do("click", testid="needle-skin")
    page.wait("window.palpate.segments.some(({ name }) => name === 'Skin')")
    page.wait("document.querySelector('[data-testid=needle-skin]') === null")
    page.do("press", key="Control+z")
    page.wait("window.palpate.segments.length === 1")
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


def place_in_axial(page: Browser, point: tuple[float, float, float]) -> tuple[float, float]:
    """Returns where a point is in the axial slice [pixels of the page]."""
    x, y = page.read(
        "(() => { const { plane } = window.palpate.slices.find(({name}) => name === 'axial');"
        " const box = document.querySelector('[data-testid=slice-axial]').getBoundingClientRect();"
        f" const off = {list(point)}.map((c, axis) => c - plane.centre[axis]);"
        " const along = (axis) => off.reduce((sum, c, i) => sum + c * axis[i], 0) / plane.pixel;"
        " return [box.x + box.width / 2 + along(plane.right),"
        " box.y + box.height / 2 - along(plane.up)]; })()"
    )
    return x, y


def click_at(page: Browser, point: tuple[float, float, float]) -> None:
    """Clicks a point of the axial slice through it."""
    # what is told may lie there
    page.read("document.querySelectorAll('.notice button').forEach((each) => each.click())")
    page.read(f"window.palpate.cross({list(point)})")
    page.frames()
    x, y = place_in_axial(page, point)
    page.do("point", x=x, y=y)
    page.do("mouse", down=True)
    page.do("mouse", down=False)


def push_from_entry(page: Browser) -> None:
    """Pushes the needle from the planned entry into the block, with the mouse over the slice."""
    pixel = page.read("window.palpate.slices[0].plane.pixel")
    x, y = place_in_axial(page, (MIDDLE, SURFACE - 3, MIDDLE))
    page.do("point", x=x, y=y)
    page.do("hold", key="Shift")
    page.do("mouse", down=True)
    # on a busy page some of the way is lost: a person pushes on until it is in, here by mm, as far
    # as the block is deep and again
    for moved in range(1, EDGE):
        page.do("point", x=x, y=y + moved / pixel)
        page.frames()
        if page.read(f"{NEEDLE}.inside && {NEEDLE}.depth > 5"):
            break
    page.wait(f"{NEEDLE}.inside && {NEEDLE}.depth > 5")


def choose_direction(page: Browser, follows: str) -> None:
    """Chooses in the needle's card what its direction follows."""
    page.read(
        "void (() => { const choice = document.querySelector('[data-testid=needle-direction]');"
        f" choice.value = '{follows}';"
        " choice.dispatchEvent(new Event('change', { bubbles: true })); })()"
    )


def points_along(wanted: tuple[float, float, float]) -> str:
    """Returns the expression that the direction set is this one."""
    return (
        f"(({NEEDLE}.set_direction ?? [9, 9, 9]).every("
        f"(c, axis) => Math.abs(c - {list(wanted)}[axis]) < 0.1))"
    )


def test_the_direction_of_the_needle_follows_the_view_and_the_push(page: Browser) -> None:
    assert page.read(f"{NEEDLE}.set_direction") is None
    choose_direction(page, "view")
    # the view from before, and from the left
    page.wait(points_along((0.0, 1.0, 0.0)))
    page.read("window.palpate.setView('L')")
    page.wait(points_along((-1.0, 0.0, 0.0)))
    choose_direction(page, "push")
    page.wait(f"{NEEDLE}.set_direction === null")
    page.read("window.palpate.setView('A')")
    page.frames()
    assert page.read(f"{NEEDLE}.set_direction") is None


def take_direction_of_plan(page: Browser) -> None:
    """Takes the planned path's direction by one click; the needle is drawn along it at once."""
    page.do("click", testid="needle-along-plan")
    page.wait(points_along((0.0, 1.0, 0.0)))
    page.wait("document.querySelector('[data-testid=needle-along-plan]') === null")
    page.wait("document.querySelector('[data-testid=needle-axial]') !== null")
    page.do("screenshot", path=str(OUTPUT / "needle-direction.png"))


def take_plan_back(page: Browser) -> None:
    """Takes the plan back by undo; without it the needle follows the push again."""
    page.do("press", key="Control+z")
    page.wait("window.palpate.marks.length === 0")
    page.wait("document.querySelector('[data-testid=needle-off]') === null")
    page.wait(f"{NEEDLE}.set_direction === null")
    page.wait("document.querySelector('[data-testid=needle-axial]') === null")


def test_a_needle_is_planned_in_a_slice_and_told_how_far_off_its_plan_it_is(page: Browser) -> None:
    page.do("press", key="Shift+I")
    page.wait("window.palpate.slices.length === 3")
    assert "the target" in page.text("mark-bar")
    click_at(page, (MIDDLE, SURFACE + 15, MIDDLE))
    assert "goes in" in page.text("mark-bar") or "go in" in page.text("mark-bar")
    click_at(page, (MIDDLE, SURFACE - 3, MIDDLE))
    page.wait("window.palpate.marks.length === 1")
    # to a pixel of the slice at each end
    pixel = page.read("window.palpate.slices[0].plane.pixel")
    page.shows("mark-value-1", "text.endsWith('mm')")
    assert abs(float(page.text("mark-value-1").split()[0]) - 18.0) < 2.0 * pixel + 0.05
    entry = page.read("window.palpate.marks[0].points[1]")
    # all of the way before it goes in: air, then the block
    page.shows("needle-way-planned", "text.includes('threshold')")

    # to the entry, and in along the slice, where the point of the mark lies under the mouse
    page.read(f"window.palpate.place({[4, 4, 4]})")
    page.all_done()
    page.do("click", testid="needle-to-entry")
    page.wait(f"Math.abs(window.palpate.state.proxy[0] - {MIDDLE}) < 1")
    page.wait(f"Math.abs(window.palpate.state.proxy[1] - {SURFACE - 8}) < 1")
    take_direction_of_plan(page)
    push_from_entry(page)
    page.wait("document.querySelector('[data-testid=needle-axial]') !== null")
    page.shows("tool-size", "text.endsWith('mm deep')")
    page.shows("needle-way-passed", "text.includes('threshold')")
    page.shows("needle-way-ahead", "text.includes('threshold')")
    # straight in, on the line to within a voxel
    page.shows("needle-off", "parseFloat(text) < 1")
    page.shows("needle-angle", "parseFloat(text) < 5")
    ahead = SURFACE + 15 - page.read("window.palpate.state.proxy[1]")
    page.shows("needle-ahead", f"Math.abs(parseFloat(text) - {ahead}) < 1.5")
    page.do("screenshot", path=str(OUTPUT / "needle-planned.png"))
    page.do("mouse", down=False)
    page.do("hold", key="Shift", up=True)
    page.wait("!window.palpate.state.tool.on")
    assert page.read("window.palpate.marks[0].points[1]") == entry, "it was not dragged"
    page.do("click", testid="needle-withdraw")
    page.wait(f"!{NEEDLE}.inside")
    # a plan is a mark: undo takes it back
    take_plan_back(page)
