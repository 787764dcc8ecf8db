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
def test_wheel_drag_and_crosshair_lead_through_the_scan(opened: Opened) -> None:
    page = opened.page
    before = page.read("window.palpate.crosshair")
    step = opened.image.GetSpacing()[2]
    # away from the person looks farther from the feet: toward the head
    page.do("wheelOver", testid="slice-axial", y=180)
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


@pytest.mark.data
def test_slices_go_where_the_probe_goes_and_bring_it_where_they_are_clicked(
    opened: Opened,
) -> None:
    page = opened.page
    page.do("doubleClickAt", testid="slice-coronal", x=0.2, y=0.2)
    asked = page.read("window.palpate.crosshair")
    state = page.settled()
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
  const parts = ['.views', '.edge', '.scale', '.read > *', '.name',
    'svg[aria-label*=Views]']
  const boxes = parts.flatMap((part) => [...document.querySelectorAll(`.picture ${part}`)].map(
    (each) => [part, each.getBoundingClientRect()]))
  const meet = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1
    && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1
  const met = ([part, box], i) => boxes.slice(i + 1).filter((other) => meet(box, other[1]))
    .map(([other]) => `${part} on ${other}`)
  return boxes.length < 27 ? `only ${boxes.length} parts` : boxes.flatMap(met)
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
