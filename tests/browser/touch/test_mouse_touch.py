"""Touch with the mouse in a real browser: pressed on what is drawn, the probe comes onto it.

The scan is a flat block, written here; its surface faces the viewer.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import Browser, browser, palpate

pytestmark = pytest.mark.browser

EDGE = 48
"""Voxels along the scan, each 1 mm."""
SURFACE = 23.5
"""Where the block begins along y [mm]; it fills everything from there to the back."""


@pytest.fixture(scope="module")
def opened(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """The block on the page, seen from before, in touch mode."""
    import SimpleITK

    values = np.full((EDGE, EDGE, EDGE), -1000, np.int16)
    values[:, EDGE // 2 :, :] = 1000
    path: Path = tmp_path_factory.mktemp("block") / "block.mha"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(path))
    options = ("--threshold", "500", "--unit", "HU", "--port", "0")
    with palpate("open", path, *options) as command, browser() as page:
        assert page.do("open", url=command.url, width=800, height=480)["firstPicture"] is not None
        page.read("window.palpate.setView('A')")
        page.do("press", key="t")
        yield page


@pytest.fixture
def page(opened: Browser) -> Iterator[Browser]:
    """The page with nothing pressed and no tool."""
    yield opened
    opened.do("release")
    opened.do("press", key="h")
    opened.read(f"window.palpate.place({[EDGE / 2, SURFACE - 10, EDGE / 2]})")
    opened.wait("window.palpate.state.contact === false")
    assert opened.complaints == []


def press(page: Browser, x: float = 0.0, y: float = 0.0) -> dict[str, Any]:
    """Presses so far from the middle [pixels] and holds; returns the state at rest."""
    page.do("dragElement", testid="canvas", **{"from": [x, y]}, hold=True)
    page.wait("window.palpate.state.contact")
    return page.settled()


def newtons(state: dict[str, Any]) -> float:
    return float(np.linalg.norm(state["force"]))


def test_a_press_on_the_block_touches_it_with_the_pressure_and_release_lifts(page: Browser) -> None:
    assert "Press on" in page.text("hint")
    state = press(page)
    assert newtons(state) == pytest.approx(1.0, rel=0.1)
    assert state["proxy"][1] == pytest.approx(SURFACE, abs=0.6)
    assert "pressure 1.0 N" in page.text("hint")
    # its arrow points at the viewer: the number stands beside the probe
    page.shows("force-number", "text === '1.0 N'")
    page.do("release")
    page.wait("window.palpate.state.contact === false")
    lifted = page.settled()
    assert newtons(lifted) == 0.0
    assert lifted["safety"]["violations"] == 0


def test_a_drag_slides_along_under_the_pointer(page: Browser) -> None:
    first = press(page, x=-40)
    before = page.read("window.palpate.camera")
    box = page.read(
        "(({x, y, width, height}) => [x + width / 2, y + height / 2])"
        "(document.querySelector('[data-testid=canvas]').getBoundingClientRect())"
    )
    for step in range(-40, 41, 8):
        page.do("point", x=box[0] + step, y=box[1])
    page.wait(f"window.palpate.state.proxy[0] > {first['proxy'][0] + 3}")
    last = page.settled()
    assert last["contact"]
    # as far right of the middle as it was left of it
    middle = before["target"][0]
    assert last["proxy"][0] - middle == pytest.approx(middle - first["proxy"][0], abs=1.0)
    assert newtons(last) == pytest.approx(1.0, rel=0.1)
    assert page.read("window.palpate.camera") == before


def test_the_wheel_changes_the_pressure_and_shows_it_at_the_pointer(page: Browser) -> None:
    press(page)
    page.do("wheel", y=-700)
    page.do("wheel", y=-450)
    page.shows("pressure-ring", "parseFloat(text) > 2")
    harder = page.settled()
    shown = float(page.text("pressure-ring").removesuffix(" N"))
    assert newtons(harder) == pytest.approx(shown, rel=0.1)
    page.do("wheel", y=700)
    page.do("wheel", y=450)
    page.shows("pressure-ring", "text === '1.0 N'")


def test_a_press_beside_everything_turns_the_picture(page: Browser) -> None:
    before = page.read("window.palpate.camera")
    left = page.read("document.querySelector('[data-testid=canvas]').clientWidth / 2") - 10
    page.do("dragElement", testid="canvas", **{"from": [-left, -60]}, x=30)
    assert page.read("window.palpate.camera") != before
    assert not page.read("window.palpate.state.contact")
    page.read("window.palpate.setView('A')")


def test_with_a_tool_left_only_presses_and_x_or_shift_has_it_work(page: Browser) -> None:
    page.do("press", key="e")
    voxels = "window.palpate.state.tool.voxels"
    state = press(page)
    assert not state["tool"]["on"]
    assert page.read(voxels) == 0
    assert "X or Shift + left erases" in page.text("hint")
    page.do("release")
    page.wait("window.palpate.state.contact === false")

    page.do("stroke", held=True)
    page.wait(f"{voxels} > 0")
    page.do("release")
    page.wait("!window.palpate.state.tool.on")
    page.do("press", key="Control+z")
    page.all_done()


def test_one_finger_touches_and_two_turn_and_zoom(page: Browser) -> None:
    page.do("fingers", **{"from": [[0, 0]]}, hold=True)
    page.wait("window.palpate.state.contact")
    assert newtons(page.settled()) == pytest.approx(1.0, rel=0.1)
    page.do("fingersUp")
    page.wait("window.palpate.state.contact === false")

    before = page.read("window.palpate.camera")
    page.do("fingers", **{"from": [[-40, 0], [40, 0]], "to": [[-20, 0], [60, 0]]})
    turned = page.read("window.palpate.camera")
    assert turned["back"] != before["back"]
    assert turned["distance"] == pytest.approx(before["distance"])
    page.do("fingers", **{"from": [[-40, 0], [40, 0]], "to": [[-80, 0], [80, 0]]})
    near = page.read("window.palpate.camera")
    assert near["distance"] == pytest.approx(turned["distance"] / 2, rel=0.01)
    assert not page.read("window.palpate.state.contact")
    page.read("window.palpate.setView('A')")


def test_out_of_touch_mode_two_fingers_move_the_picture_and_zoom_about_their_middle(
    page: Browser,
) -> None:
    page.do("press", key="Escape")
    before = page.read("window.palpate.camera")
    page.do("fingers", **{"from": [[60, 20], [100, 20]], "to": [[40, 20], [120, 20]]})
    near = page.read("window.palpate.camera")
    assert near["distance"] == pytest.approx(before["distance"] / 2, rel=0.01)
    assert near["back"] == before["back"]
    # what lay between them still does: right of the middle by 80 pixels
    mm = page.read("window.palpate.pixelSizeAt(window.palpate.camera.target)")
    right = np.subtract(near["target"], before["target"]) @ np.array(near["right"])
    assert right == pytest.approx(80 * mm, rel=0.05)
    page.do("press", key="t")
    page.read("window.palpate.setView('A')")


@pytest.mark.parametrize("force", [0.4, 0.9])
def test_how_hard_a_pen_is_pressed_is_the_force(page: Browser, force: float) -> None:
    page.do("pen", force=force)
    page.wait("window.palpate.state.contact")
    assert newtons(page.settled()) == pytest.approx(force, rel=0.1)
    page.do("penUp")
    page.wait("window.palpate.state.contact === false")


def test_in_the_view_plane_every_move_leads_the_hand_and_the_choice_is_remembered(
    page: Browser,
) -> None:
    with page.settings():
        page.do("click", testid="mouse-plane")
    assert "Move the mouse" in page.text("hint")
    page.do("point", x=400, y=240)
    before = page.read("window.palpate.state.hand")
    page.do("point", x=430, y=240)
    page.wait(f"window.palpate.state.hand[0] > {before[0]} + 0.5")
    assert page.read("JSON.parse(localStorage['palpate.mouse']).way") == "plane"
    with page.settings():
        page.do("click", testid="mouse-surface")
