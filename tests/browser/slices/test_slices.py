"""Slices of a real scan in a real browser: what they show, and that they follow touch and edits.

The oracle is SimpleITK: it resamples the file itself onto the plane that the page says it shows.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK
from browser import ROOT, Browser, browser, palpate
from numpy.typing import NDArray

pytestmark = pytest.mark.browser

OUTPUT = ROOT / "tests" / "output"
Picture = NDArray[np.float64]
NAMES = ("axial", "coronal", "sagittal")


NOTCH = 120
"""Of the wheel, as browsers count it."""


def point_on(plane: dict[str, Any], x: float, y: float) -> NDArray[np.float64]:
    """Returns the point of a slice at shares of its pane."""
    right, up = np.array(plane["right"]), np.array(plane["up"])
    across, upward = (x - 0.5) * plane["width"], (0.5 - y) * plane["height"]
    return np.asarray(np.array(plane["centre"]) + plane["pixel"] * (across * right + upward * up))


@dataclass(frozen=True)
class Opened:
    """A scan on the page, in four panes."""

    page: Browser
    image: Any

    def plane(self, name: str) -> dict[str, Any]:
        """Returns where a slice lies, and its pane."""
        found = self.page.read(f"window.palpate.slices.find(({{name}}) => name === {name!r})")
        assert found is not None
        return {**found["plane"], **found["rect"]}

    def shot(self, name: str) -> Picture:
        """Returns a slice as it is drawn, RGB 0..1, shape [h, w, 3]."""
        self.page.finish()
        path = OUTPUT / f"slice_{name}.png"
        path.parent.mkdir(parents=True, exist_ok=True)
        self.page.do("screenshot", path=str(path), testid=f"slice-{name}")
        pixels = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(path)))
        return np.asarray(pixels[..., :3], np.float64) / 255.0

    def resampled(self, name: str) -> Picture:
        """Returns the file's values in the middle of each pixel of a slice; NaN outside."""
        plane = self.plane(name)
        right, up, centre = (np.array(plane[key]) for key in ("right", "up", "centre"))
        width, height, size = round(plane["width"]), round(plane["height"]), plane["pixel"]
        first = centre - right * size * (width - 1) / 2 + up * size * (height - 1) / 2
        normal = np.cross(right, -up)
        slicer = SimpleITK.ResampleImageFilter()
        slicer.SetSize((width, height, 1))
        slicer.SetOutputSpacing((size, size, 1.0))
        slicer.SetOutputOrigin(first.tolist())
        slicer.SetOutputDirection(np.stack([right, -up, normal], 1).ravel().tolist())
        slicer.SetInterpolator(SimpleITK.sitkLinear)
        slicer.SetDefaultPixelValue(float("nan"))
        slicer.SetOutputPixelType(SimpleITK.sitkFloat64)
        return np.asarray(SimpleITK.GetArrayFromImage(slicer.Execute(self.image))[0], np.float64)

    def window(self) -> tuple[float, float]:
        """Returns the values that are black and white, as the page writes them."""
        width, level = (
            float(self.page.read(f"document.querySelector('[data-testid={testid}]').value"))
            for testid in ("window-width", "window-level")
        )
        return level - width / 2, level + width / 2


@pytest.fixture(scope="module")
def opened(data_folder: Path) -> Iterator[Opened]:
    """A CT with thick slices, its liver and its bone as segments."""
    path = data_folder / "amos_0336" / "amos_0336.mhd"
    with palpate("open", path, "--unit", "HU", "--threshold", "250") as command, browser() as page:
        opening = page.do("open", url=command.url, width=1280, height=860)
        assert opening["firstPicture"] is not None
        page.do("click", testid="layout-four")
        page.wait("window.palpate.slices.length === 3")
        yield Opened(page, SimpleITK.ReadImage(str(path)))


@pytest.mark.data
@pytest.mark.parametrize("name", NAMES)
def test_a_slice_shows_the_values_of_the_file_by_window_and_level(
    opened: Opened, name: str
) -> None:
    opened.page.do("choose", testid="window-preset", value="Abdomen")
    np.testing.assert_allclose(opened.window(), (-135, 215))
    shows_the_file(opened, name)


@pytest.mark.data
def test_an_oblique_slice_lies_as_the_view_does_and_shows_the_values_of_the_file(
    opened: Opened,
) -> None:
    page = opened.page
    page.do("choose", testid="window-preset", value="Abdomen")
    page.do("click", testid="layout-slice")
    page.do("choose", testid="slice-single", value="oblique")
    page.read("window.palpate.setView('A')")
    for key in 4 * ["Shift+ArrowRight"] + 4 * ["Shift+ArrowDown"]:
        page.do("press", key=key)
    camera = page.read("window.palpate.camera")
    plane = opened.plane("oblique")
    np.testing.assert_allclose(plane["right"], camera["right"], atol=1e-6)
    np.testing.assert_allclose(plane["up"], camera["up"], atol=1e-6)
    assert np.abs(camera["back"]).min() > 0.1, "along no axis of the scan"
    # its pane is twice as wide as high, and the body stands upright in it: a fifth of it
    shows_the_file(opened, "oblique", filled=0.15)
    page.do("click", testid="layout-four")


def shows_the_file(opened: Opened, name: str, *, filled: float = 0.3) -> None:
    """Checks a slice, filled so far by the scan, by the values of the file; window "Abdomen"."""
    values = opened.resampled(name)
    drawn = opened.shot(name)
    inside = np.isfinite(values)
    assert inside.mean() > filled
    grey = np.clip((values + 135) / 350, 0, 1)

    # bone has a tint and an outline: elsewhere it is the value itself
    plain = inside & (values < 200) & (np.ptp(drawn, axis=2) < 0.02)
    assert plain.mean() > 0.6 * inside.mean()
    off = np.abs(drawn[..., 1] - grey)[plain]
    assert off.mean() < 1.5 / 255, off.mean() * 255
    # a mirrored slice is far off
    mirrored = np.abs(drawn[:, ::-1, 1] - grey)[plain & plain[:, ::-1]]
    assert mirrored.mean() > 10 / 255


@pytest.mark.data
def test_segments_have_an_outline_and_a_tint(opened: Opened) -> None:
    values = opened.resampled("axial")
    drawn = opened.shot("axial")
    bone = np.nan_to_num(values, nan=-1000) >= 250
    assert bone.sum() > 500
    inner = bone & np.roll(bone, 3, 0) & np.roll(bone, -3, 0) & np.roll(bone, 3, 1)
    edge = bone & ~(
        np.roll(bone, 1, 0) & np.roll(bone, -1, 0) & np.roll(bone, 1, 1) & np.roll(bone, -1, 1)
    )
    # ivory has less blue than red; white has not
    ivory = drawn[..., 0] - drawn[..., 2]
    assert ivory[edge].mean() > 0.08
    assert 0.005 < ivory[inner].mean() < ivory[edge].mean()
    away = np.isfinite(values) & (values < 150)
    assert np.abs(ivory[away]).mean() < 0.01


@pytest.mark.data
def test_the_read_out_tells_the_value_and_the_place_of_the_file(opened: Opened) -> None:
    page = opened.page
    box = page.read(
        "document.querySelector('[data-testid=slice-axial]').getBoundingClientRect().toJSON()"
    )
    plane = opened.plane("axial")
    page.do("point", x=box["x"] + 0.45 * plane["width"], y=box["y"] + 0.4 * plane["height"])
    right, up, centre = (np.array(plane[key]) for key in ("right", "up", "centre"))
    point = (
        centre
        - 0.05 * plane["width"] * plane["pixel"] * right
        + 0.1 * plane["height"] * plane["pixel"] * up
    )
    index = opened.image.TransformPhysicalPointToIndex(point.tolist())
    value = opened.image.GetPixel(index)
    page.shows("read-axial", f"text.startsWith('{value} HU')")
    told = page.text("read-axial")
    x, y, z = point
    for coordinate, letters in zip((x, y, z), ("LR", "PA", "SI"), strict=True):
        assert f"{letters[0 if coordinate >= 0 else 1]} {abs(coordinate):.1f}" in told


@pytest.mark.data
def test_two_fingers_zoom_and_move_a_slice_and_one_moves_the_crosshair(opened: Opened) -> None:
    page = opened.page
    page.do("clickAt", testid="slice-axial", x=0.5, y=0.5)
    cross, before = page.read("window.palpate.crosshair"), opened.plane("axial")
    apart = {"from": [[-30, 0], [30, 0]], "to": [[-60, 0], [60, 0]]}
    page.do("fingers", testid="slice-axial", **apart)
    page.wait(
        f"window.palpate.slices.find(s => s.name === 'axial').plane.pixel < {0.6 * before['pixel']}"
    )
    zoomed = opened.plane("axial")
    assert zoomed["pixel"] == pytest.approx(before["pixel"] / 2, rel=0.02)
    # about the place between them
    np.testing.assert_allclose(zoomed["centre"], before["centre"], atol=0.5)

    together = {"from": [[-30, 0], [30, 0]], "to": [[-10, 10], [50, 10]]}
    page.do("fingers", testid="slice-axial", **together)
    moved = np.subtract(opened.plane("axial")["centre"], zoomed["centre"])
    right, up = np.array(zoomed["right"]), np.array(zoomed["up"])
    expected = zoomed["pixel"] * (-20 * right + 10 * up)
    np.testing.assert_allclose(moved, expected, atol=2 * zoomed["pixel"])
    # the first finger came down alone, and set nothing
    assert page.read("window.palpate.crosshair") == pytest.approx(cross, abs=1e-3)

    page.do("fingers", testid="slice-axial", **{"from": [[40, 0]]})
    page.wait(f"Math.hypot(...window.palpate.crosshair.map((c, i) => c - {cross}[i])) > 5")
    page.do("click", testid="fit-slices")


@pytest.mark.data
def test_wheel_drag_and_crosshair_lead_through_the_scan(opened: Opened) -> None:
    page = opened.page
    # to the middle of a slice first
    page.do("wheelOver", testid="slice-axial", y=NOTCH)
    before = page.read("window.palpate.crosshair")
    step = opened.image.GetSpacing()[2]
    # away from the person looks farther from the feet: toward the head
    page.do("wheelOver", testid="slice-axial", y=NOTCH, times=3)
    page.wait(f"Math.abs(window.palpate.crosshair[2] - {before[2]} - {3 * step}) < 0.01")
    assert opened.plane("axial")["centre"][2] == pytest.approx(before[2] + 3 * step, abs=0.01)

    # a click in the axial slice moves the other two there
    page.do("clickAt", testid="slice-axial", x=0.6, y=0.3)
    crosshair = page.read("window.palpate.crosshair")
    assert crosshair[2] == pytest.approx(before[2] + 3 * step, abs=0.01)
    assert opened.plane("sagittal")["centre"][0] == pytest.approx(crosshair[0], abs=1e-6)
    assert opened.plane("coronal")["centre"][1] == pytest.approx(crosshair[1], abs=1e-6)
    assert crosshair[0] != pytest.approx(before[0], abs=5)

    # the right button sets window and level
    low, high = opened.window()
    page.do("dragElement", testid="slice-axial", x=60, y=0, button="right")
    wider = opened.window()
    assert wider[1] - wider[0] > 1.1 * (high - low)


def number(page: Browser, name: str) -> int:
    """Returns which slice a pane says that it shows."""
    return int(page.text(f"number-{name}").split("/")[0])


@pytest.mark.data
def test_a_notch_of_the_wheel_is_a_slice_and_the_read_out_follows(opened: Opened) -> None:
    page = opened.page
    page.read("window.palpate.cross(window.palpate.crosshair.map((c, i) => i === 2 ? 1000 : c))")
    before = number(page, "axial")
    # as quickly as a wheel turns: none is left out
    page.do("wheelOver", testid="slice-axial", y=NOTCH, times=25, every=40)
    page.shows("number-axial", f"text.startsWith('{before + 25}/')")
    page.do("wheelOver", testid="slice-axial", y=-NOTCH, times=25, every=40)
    page.shows("number-axial", f"text.startsWith('{before}/')")

    # the mouse stays where it is, and the value is that of the slice that is seen by now
    for _ in range(3):
        page.do("wheelOver", testid="slice-axial", y=NOTCH)
        point = point_on(opened.plane("axial"), 0.5, 0.5)
        z = opened.image.TransformPhysicalPointToIndex(point.tolist())[2]
        page.shows("number-axial", f"text.startsWith('{z + 1}/{opened.image.GetSize()[2]}')")
        index = opened.image.TransformPhysicalPointToIndex(point.tolist())
        page.shows("read-axial", f"text.startsWith('{opened.image.GetPixel(index)} HU')")
        assert opened.plane("axial")["centre"][2] == pytest.approx(
            opened.image.TransformIndexToPhysicalPoint((0, 0, z))[2], abs=1e-3
        )


@pytest.mark.data
def test_small_moves_on_a_trackpad_add_up_and_a_swipe_aside_turns_no_slice(opened: Opened) -> None:
    page = opened.page
    before = number(page, "axial")

    def swipe(across: int, down: int) -> None:
        # as browsers tell those of two fingers
        page.read(
            "void document.querySelector('[data-testid=slice-axial]').dispatchEvent(new WheelEvent("
            f"'wheel', {{deltaX: {across}, deltaY: {down}, wheelDeltaX: {-3 * across},"
            f" wheelDeltaY: {-3 * down}, bubbles: true, cancelable: true}}))"
        )

    told = []
    for _ in range(16):
        swipe(0, 5)
        page.frames()
        told.append(number(page, "axial") - before)
    assert told == [0] * 7 + [1] * 8 + [2]
    for _ in range(5):
        swipe(120, 11)
    page.frames()
    assert number(page, "axial") == before + 2


@pytest.mark.data
def test_digits_over_a_slice_choose_its_window_and_elsewhere_a_side(opened: Opened) -> None:
    page = opened.page
    camera = page.read("window.palpate.camera.back")
    middle = page.read(
        "(({x, y, width, height}) => [x + width / 2, y + height / 2])"
        "(document.querySelector('[data-testid=slice-axial]').getBoundingClientRect())"
    )
    page.do("point", x=middle[0], y=middle[1])
    page.do("press", key="3")
    page.shows("window-axial", "text.includes('W 1000 L 400') && text.includes('Bone')")
    page.do("press", key="2")
    page.shows("window-coronal", "text.includes('L -500') && text.includes('Lung')")
    np.testing.assert_allclose(opened.window(), (-1200, 200))
    assert page.read("window.palpate.camera.back") == camera
    page.do("press", key="Control+z")
    np.testing.assert_allclose(opened.window(), (-100, 900))

    # the same list is in the pane
    page.do("click", testid="window-sagittal")
    page.do("click", testid="pane-window-1")
    page.shows("window-axial", "text.includes('Abdomen')")
    assert page.read("document.querySelector('[data-testid=card-sagittal]')") is None

    page.do("clickAt", testid="canvas", x=0.9, y=0.9)
    page.do("press", key="3")
    page.wait("window.palpate.camera.back[0] > 0.99 || window.palpate.camera.back[0] < -0.99")
    np.testing.assert_allclose(opened.window(), (-135, 215))
    page.do("press", key="Escape")
    page.do("press", key="?")
    page.wait("document.querySelector('#help-title') !== null")
    told = page.read("document.querySelector('[role=dialog][aria-modal]').textContent")
    assert "3 over a slice" in told
    page.do("press", key="Escape")
    page.read("window.palpate.setView('A')")


@pytest.mark.data
def test_a_double_click_gives_a_slice_the_whole_picture_and_another_takes_it_back(
    opened: Opened,
) -> None:
    page = opened.page
    page.do("doubleClickAt", testid="slice-sagittal", x=0.4, y=0.5)
    page.wait("window.palpate.slices.length === 1")
    whole = opened.plane("sagittal")
    assert whole["x"] == whole["y"] == 0
    # it fills the canvas, and shows the file there
    assert whole["width"] == page.read("document.querySelector('canvas').clientWidth")
    page.do("choose", testid="window-preset", value="Abdomen")
    shows_the_file(opened, "sagittal", filled=0.2)
    page.do("doubleClickAt", testid="slice-sagittal", x=0.4, y=0.5)
    page.wait("window.palpate.slices.length === 3")
    assert page.read("document.querySelector('[data-testid=pick-card]')") is None

    # the 3-D view by its key; the picture is the one from before
    page.do("clickAt", testid="canvas", x=0.02, y=0.5)
    page.do("press", key="Shift+F")
    page.wait("window.palpate.slices.length === 0")
    page.do("press", key="Shift+F")
    page.wait("window.palpate.slices.length === 3")


@pytest.mark.data
def test_layouts_have_names_and_are_remembered(opened: Opened) -> None:
    page = opened.page
    seen = "getComputedStyle(document.querySelector('[data-testid=canvas]')).visibility"
    page.do("choose", testid="layout-names", value="slices")
    page.wait("window.palpate.slices.length === 3")
    assert page.read(seen) == "hidden"
    # together they have all of it
    planes = [opened.plane(name) for name in NAMES]
    canvas = page.read(
        "(({clientWidth, clientHeight}) => clientWidth * clientHeight)"
        "(document.querySelector('canvas'))"
    )
    assert sum(plane["width"] * plane["height"] for plane in planes) > 0.97 * canvas
    url = page.read("window.location.href")
    page.do("open", url=url, width=1280, height=860)
    page.wait("window.palpate.slices.length === 3")
    assert page.read(seen) == "hidden"
    camera = page.read("window.palpate.camera")
    page.do("choose", testid="layout-names", value="big")
    page.wait("window.palpate.slices.length === 3")
    assert page.read(seen) == "visible"
    # one of them, whichever was chosen, is large
    page.wait(
        "(() => { const [least, middle, most] = window.palpate.slices"
        ".map(({ rect: { width, height } }) => width * height).sort((a, b) => a - b);"
        " return least > 0 && most > 3 * middle; })()"
    )
    page.do("choose", testid="layout-names", value="four")
    # what was not seen has kept its view
    np.testing.assert_allclose(page.read("window.palpate.camera.back"), camera["back"], atol=1e-6)
    page.finish()
    assert np.mean(page.picture(OUTPUT / "view_again.png").max(axis=2) > 0.5) > 0.05


@pytest.mark.data
def test_a_slab_is_chosen_in_the_pane_and_is_the_persons_own(opened: Opened) -> None:
    page = opened.page
    thin = opened.image.GetSpacing()[2]
    page.shows("thickness-axial", f"text === '{thin:.1f} mm'")
    page.do("click", testid="thickness-axial")
    page.do("click", testid="pane-slab-least")
    page.shows("thickness-axial", "text === 'MinIP 10.0 mm'")
    page.do("slide", testid="pane-slab", value=20)
    page.shows("thickness-coronal", "/^MinIP (19|20|21)/.test(text)")
    kept = page.text("thickness-coronal")
    page.do("press", key="Escape")
    page.wait("document.querySelector('[data-testid=card-axial]') === null")
    remembered = page.read("JSON.parse(localStorage.getItem('palpate.slices'))")
    assert remembered["slabMode"] == "least"
    # it goes with the page, whichever scan is open
    url = page.read("window.location.href")
    page.do("open", url=url, width=1280, height=860)
    page.shows("thickness-axial", f"text === '{kept}'")
    page.do("click", testid="thickness-axial")
    page.do("click", testid="pane-slab-single")
    page.shows("thickness-axial", f"text === '{thin:.1f} mm'")
    page.do("press", key="Escape")


@pytest.mark.data
def test_a_finger_on_the_bar_goes_through_all_slices(opened: Opened) -> None:
    page = opened.page
    top, bottom = page.read(
        "(({x, width, top, bottom}) => [[x + width - 6, top + 20], [x + width - 6, bottom - 20]])"
        "(document.querySelector('[data-testid=bar-axial]').getBoundingClientRect())"
    )
    middle = page.read(
        "(({x, y, width, height}) => [x + width / 2, y + height / 2])"
        "(document.querySelector('[data-testid=canvas]').getBoundingClientRect())"
    )
    count = opened.image.GetSize()[2]
    crosshair = page.read("window.palpate.crosshair")
    start, end = ([a - b for a, b in zip(place, middle, strict=True)] for place in (top, bottom))
    # toward the person is toward the feet: on top
    page.do("fingers", **{"from": [start], "to": [end], "hold": True})
    page.shows("number-axial", f"parseInt(text) > {0.9 * count}")
    page.do("fingersUp")
    page.do("fingers", **{"from": [end], "to": [start]})
    page.shows("number-axial", f"parseInt(text) < {0.1 * count}")
    # the other two stay where they are
    np.testing.assert_allclose(page.read("window.palpate.crosshair")[:2], crosshair[:2], atol=1e-6)


@pytest.mark.data
def test_slices_go_where_the_probe_goes_and_bring_it_where_they_are_clicked(
    opened: Opened,
) -> None:
    page = opened.page
    asked = point_on(opened.plane("coronal"), 0.2, 0.2)
    page.do("hold", key="Shift")
    page.do("doubleClickAt", testid="slice-coronal", x=0.2, y=0.2)
    page.do("hold", key="Shift", up=True)
    state = page.settled()
    assert page.read("window.palpate.slices.length") == 3
    assert np.hypot.reduce(np.array(state["proxy"]) - asked) < 60
    proxy = np.array(state["proxy"])
    higher = proxy + np.array([0.0, 0.0, 12.0])
    page.read(f"window.palpate.hand({higher.tolist()})")
    moved = np.array(page.settled()["proxy"])
    assert np.linalg.norm(moved - proxy) > 1
    page.wait(
        f"Math.hypot(...window.palpate.crosshair.map((c, i) => c - {moved.tolist()}[i])) < 0.2"
    )


@pytest.mark.data
def test_a_slab_shows_the_largest_value_of_its_thickness(opened: Opened) -> None:
    page = opened.page
    single = opened.shot("axial")[..., 1]
    page.do("clickText", text="Slab and segments")
    page.do("choose", testid="slab-mode", value="largest")
    page.do("slide", testid="slab", value=30)
    thick = opened.shot("axial")[..., 1]
    # nothing gets darker, and ribs appear
    assert (thick >= single - 0.25).mean() > 0.97
    assert thick.mean() > single.mean() + 0.02
    page.do("slide", testid="slab", value=0)


@pytest.mark.data
def test_layout_and_window_are_remembered(opened: Opened) -> None:
    page = opened.page
    page.do("choose", testid="window-preset", value="Lung")
    page.do("press", key="l")
    page.wait("window.palpate.slices.length === 0")
    page.do("click", testid="layout-slice")
    page.wait("window.palpate.slices.length === 1")
    page.do("choose", testid="slice-single", value="sagittal")
    url = page.read("window.location.href")
    page.do("open", url=url, width=1280, height=860)
    page.wait("window.palpate.slices.length === 1")
    assert page.read("window.palpate.slices[0].name") == "sagittal"
    np.testing.assert_allclose(opened.window(), (-1200, 200))
    page.do("click", testid="layout-four")


OVERLAPS = """(() => {
  const parts = ['.views', '.edge', '.scale', '.read > *', '.name', '.info:not(.notice) > *',
    '[data-testid^=bar-]',
    'svg[aria-label*=Views]']
  const boxes = parts.flatMap((part) => [...document.querySelectorAll(`.picture ${part}`)].map(
    (each) => [part, each.getBoundingClientRect()]))
  const meet = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1
    && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1
  const met = ([part, box], i) => boxes.slice(i + 1).filter((other) => meet(box, other[1]))
    .map(([other]) => `${part} on ${other}`)
  return boxes.length < 39 ? `only ${boxes.length} parts` : boxes.flatMap(met)
})()"""
"""What stands on what over the picture."""


@pytest.mark.data
def test_in_a_small_window_nothing_stands_on_anything_else(opened: Opened) -> None:
    page = opened.page
    page.do("click", testid="layout-four")
    for width, height in ((1366, 768), (900, 700)):
        page.do("resize", width=width, height=height)
        page.wait("window.palpate.slices.length === 3")
        page.finish()
        assert page.read(OVERLAPS) == []
    # the view is seen where it stands by now, and nothing of where slices stood before
    view = page.picture(OUTPUT / "small_view.png")
    assert np.mean(view.max(axis=2) > 0.5) > 0.05
    page.do("resize", width=1280, height=860)
