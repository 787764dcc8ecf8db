"""Blend modes and transfer functions of a real scan in a real browser.

The oracle is NumPy: it samples the file itself along the rays of the page's own camera.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import SimpleITK
from browser import ROOT, Browser, browser, palpate
from numpy.typing import NDArray
from opened_scan import Opened

pytestmark = pytest.mark.browser

OUTPUT = ROOT / "tests" / "output"
SIZE = {"width": 1000, "height": 460}
"""Small: each picture is drawn in software until it is as fine as it gets."""
SMALL = {"width": 780, "height": 360}
"""For what is drawn a hundred times."""
Array = NDArray[np.float64]


@pytest.fixture(scope="module")
def opened(data_folder: Path) -> Iterator[Opened]:
    """A contrast CT of the trunk, seen from the front."""
    path = data_folder / "amos_0336" / "amos_0336.mhd"
    with palpate("open", path, "--unit", "HU") as command, browser(drawer="browser") as page:
        assert page.do("open", url=command.url, **SIZE)["firstPicture"] is not None
        # tests draw on the CPU, which people are told of
        page.wait("document.body.textContent.includes('without a graphics card')")
        page.read("window.palpate.setView('A')")
        yield Opened(page, SimpleITK.ReadImage(str(path)))


@pytest.mark.data
def test_a_mip_is_the_largest_value_on_each_ray_of_the_file(opened: Opened) -> None:
    page = opened.page
    page.do("choose", testid="blend", value="mip")
    drawn = page.picture(OUTPUT / "mip.png")[..., 1]
    width, level = (
        float(page.read(f"document.querySelector('[data-testid={testid}]').value"))
        for testid in ("picture-window", "picture-level")
    )
    height, across = drawn.shape
    rows, columns = np.mgrid[60 : height - 60 : 7, 60 : across - 60 : 7]
    pixels = np.stack([columns.ravel(), rows.ravel()], 1).astype(float)
    values = opened.values_along(pixels, np.arange(-420, 420, 0.4))
    most = np.nanmax(np.where(np.isnan(values), -5000, values), axis=1)
    grey = np.clip((most - level) / width + 0.5, 0, 1)
    shown = drawn[rows.ravel(), columns.ravel()]

    # black is the page's own ground, of which dark grey has a share
    lit = grey > 0.3
    assert lit.mean() > 0.03
    off = np.abs(shown - grey)[lit]
    assert np.median(off) < 4 / 255, np.median(off) * 255
    assert np.mean(off < 12 / 255) > 0.9
    mirrored = np.abs(drawn[rows.ravel(), across - 1 - columns.ravel()] - grey)[lit]
    assert np.median(mirrored) > 12 / 255
    assert shown[grey == 0].mean() < 0.15


@pytest.mark.long
@pytest.mark.data
def test_modes_are_remembered_and_look_as_they_are_called(opened: Opened) -> None:
    page = opened.page
    pictures = {}
    for mode in ("shaded", "composite", "absorption", "emission", "average", "iso"):
        page.do("choose", testid="blend", value=mode)
        pictures[mode] = page.picture(OUTPUT / f"{mode}.png")

    def colour(picture: Array) -> float:
        height = picture.shape[0]
        middle = picture[height // 3 : 2 * height // 3, 200:500]
        return float(np.mean(np.ptp(middle, axis=2)))

    # a radiograph and a mean are grey, tissue is not
    assert colour(pictures["absorption"]) < 0.06 < colour(pictures["composite"])
    assert colour(pictures["average"]) < 0.06 < colour(pictures["shaded"])
    different = [
        float(np.abs(pictures[one] - pictures[other]).mean())
        for one in pictures
        for other in pictures
        if one < other
    ]
    assert min(different) > 0.01

    url = page.read("location.href")
    page.do("open", url=url, **SIZE)
    assert page.read("document.querySelector('[data-testid=blend]').value") == "iso"
    assert not page.complaints


@pytest.mark.data
def test_alt_drag_changes_window_and_level_in_the_picture(opened: Opened) -> None:
    page = opened.page
    page.do("choose", testid="blend", value="mip")
    before, camera = page.text("picture-window-value"), page.read("window.palpate.camera")
    page.do("altDrag", x=60, y=0)
    page.shows("picture-window-value", f"text !== '{before}'")
    assert page.read("window.palpate.camera") == camera


@pytest.mark.data
def test_each_preset_is_shown_by_a_picture_of_this_scan(opened: Opened) -> None:
    page = opened.page
    page.do("click", testid="group-view")
    page.do("choose", testid="blend", value="shaded")
    tiles = "[...document.querySelectorAll('[data-testid^=preset-CT] img.tile')]"
    page.wait(f"{tiles}.length === 8 && {tiles}.every(({{ naturalWidth }}) => naturalWidth > 100)")
    assert page.read(f"new Set({tiles}.map(({{ src }}) => src)).size") == 8


@pytest.mark.data
def test_a_preset_its_points_and_an_imported_one_change_the_picture(opened: Opened) -> None:
    page = opened.page
    page.do("choose", testid="blend", value="composite")
    pictures = {}
    for name in ("CT-Lung", "CT-Muscle"):
        page.do("click", testid="preset")
        page.do("click", testid=f"preset-{name}")
        page.shows("preset", f"text === '{name}'")
        pictures[name] = page.picture(OUTPUT / f"{name}.png")
    assert np.abs(pictures["CT-Lung"] - pictures["CT-Muscle"]).mean() > 0.03

    # a point is dragged, then moved with a key; both are taken back
    page.do("clickText", text="Curve")
    point = "document.querySelector('[data-testid=opacity-point-2]')"
    before = page.read(f"{point}.ariaValueText")
    page.read(f"void {point}.scrollIntoView({{ block: 'center' }})")
    page.do("dragElement", testid="opacity-point-2", y=-25)
    page.shows("preset", "text === 'CT-Muscle *'")
    dragged = page.read(f"{point}.ariaValueText")
    assert dragged != before
    page.do("press", key="ArrowRight")
    page.wait(f"{point}.ariaValueText !== '{dragged}'")
    page.do("press", key="Control+z")
    page.wait(f"{point}.ariaValueText === '{dragged}'")
    page.do("press", key="Control+z")
    page.shows("preset", "text === 'CT-Muscle'")
    assert page.read(f"{point}.ariaValueText") == before

    def paste(text: str) -> None:
        page.read(
            "(() => { const field = document.querySelector('[data-testid=preset-text]');"
            f" field.value = {text!r};"
            " field.dispatchEvent(new Event('input', { bubbles: true })); })()"
        )
        page.do("click", testid="preset-import")

    page.do("clickText", text="Import a preset")
    paste('<VolumeProperty name="Knee" scalarOpacity="4 0 0 9" colorTransfer="" />')
    assert "scalar opacity function says 4 numbers and has 3" in page.text("preset-complaint")
    paste(
        '<VolumeProperty name="Knee" scalarOpacity="6 -900 0 -200 0.2 400 1"'
        ' colorTransfer="8 -900 0 0 1 400 0 1 0" />'
    )
    page.shows("preset", "text === 'Knee'")
    knee = page.picture(OUTPUT / "imported.png")
    assert np.abs(knee - pictures["CT-Muscle"]).mean() > 0.03
    assert not page.complaints


@pytest.mark.data
def test_a_stop_changes_the_colour_of_its_values_and_is_taken_back(opened: Opened) -> None:
    page = opened.page
    page.do("choose", testid="blend", value="composite")
    page.do("click", testid="preset")
    page.do("click", testid="preset-CT-Muscle")
    unfold(page, "Curve", testid="colour-stop-1")
    muscle = page.picture(OUTPUT / "stop.png")
    stop = "document.querySelector('[data-testid=colour-stop-1]')"
    page.do("click", testid="colour-stop-1")
    before = page.read(f"{stop}.ariaValueText")
    page.read(
        "(() => { const field = document.querySelector('[aria-label=\"Colour of the stop\"]');"
        " field.value = '#00ff00';"
        " field.dispatchEvent(new Event('change', { bubbles: true })); })()"
    )
    page.wait(f"{stop}.ariaValueText.endsWith('#00ff00')")
    green = page.picture(OUTPUT / "stop_green.png")
    assert (green[..., 1] - green[..., 0]).mean() > (muscle[..., 1] - muscle[..., 0]).mean() + 0.02
    page.do("press", key="Control+z")
    page.wait(f"{stop}.ariaValueText === {before!r}")
    assert not page.complaints


def unfold(page: Browser, title: str, *, testid: str) -> None:
    """Opens what is folded under a title, if what is wanted there is not seen."""
    if page.read(f"document.querySelector('[data-testid={testid}]') === null"):
        page.do("clickText", text=title)


@pytest.mark.data
def test_a_look_that_is_put_back_has_its_mode_too(opened: Opened) -> None:
    page = opened.page
    mode = "document.querySelector('[data-testid=blend]').value"
    page.read("document.querySelector('[aria-label=\"Reset the look\"]').click()")
    before = page.read(mode)
    page.do("choose", testid="blend", value="emission")
    page.read("document.querySelector('[aria-label=\"Reset the look\"]').click()")
    page.wait(f"{mode} === {before!r}")
    assert before != "emission"


@pytest.mark.long
@pytest.mark.data
def test_a_segment_is_a_body_or_tissue_inside_the_volume(opened: Opened) -> None:
    page = opened.page
    page.do("choose", testid="blend", value="shaded")
    # whatever curve was chosen before
    page.read("document.querySelector('[aria-label=\"Reset the look\"]').click()")
    # a colour that nothing in the scan has
    page.read(
        "(() => { const field = document.querySelector('[data-testid=segment-1] [type=color]');"
        " field.value = '#2040ff';"
        " field.dispatchEvent(new Event('change', { bubbles: true })); })()"
    )
    page.all_done()
    pictures = []
    for mode in ("solid", "tinted", "plain"):
        page.read(f"document.querySelector('[data-testid=inside-{mode}]').click()")
        pictures.append(page.picture(OUTPUT / f"inside_{mode}.png"))
    solid, tinted, plain = (float(np.mean(each[..., 2] > each[..., 0] + 0.2)) for each in pictures)
    assert plain < 0.001
    # most pixels are beside the segment
    assert solid > 0.012
    assert tinted > 0.012
    assert np.abs(pictures[0] - pictures[1]).mean() > 0.002


@pytest.mark.long
@pytest.mark.data
def test_two_eyes_see_the_scan_and_each_of_them_points(opened: Opened) -> None:
    page = opened.page
    page.do("choose", testid="blend", value="shaded")
    page.read("window.palpate.setView('A')")
    page.do("press", key="Shift+S")
    anaglyph = page.picture(OUTPUT / "anaglyph.png")
    page.do("press", key="Shift+S")
    # what an eye sees is half as wide now, and so the view farther away
    page.read("window.palpate.setView('A')")
    both = page.picture(OUTPUT / "side_by_side.png")
    width = both.shape[1] // 2
    left, right = both[40:-150, :width], both[40:-150, -width:]

    # nearly the same, and shifted against one another where it is nearer or farther than the middle
    assert 0.002 < np.abs(left - right).mean() < 0.05
    assert np.abs(left - both[40:-150, 40 : 40 + width]).mean() > 2 * np.abs(left - right).mean()
    # an anaglyph has red rims where a picture has none
    rim = anaglyph[..., 0] - anaglyph[..., 1:].max(axis=2)
    assert np.mean(rim > 0.1) > 0.002

    # the same place of the scan, seen by either eye
    camera = page.read("window.palpate.camera")
    height = both.shape[0]
    # the breastbone
    place = (0.5 * width, 0.3 * height)
    seen = np.array(page.read(f"window.palpate.pick({place[0]}, {place[1]})")["point"])
    near = float((seen - camera["target"]) @ camera["back"])
    apart = camera["distance"] / 30
    pixel = 2 * camera["distance"] * np.tan(camera["field"] / 2) / height
    shift = -apart * near / (camera["distance"] - near) / pixel
    again = both.shape[1] - width + place[0] + shift
    other = np.array(page.read(f"window.palpate.pick({again}, {place[1]})")["point"])
    assert abs(near) > 20
    beside = [(other - seen) @ camera[axis] for axis in ("right", "up")]
    # another way through skin ends a little deeper or sooner
    assert np.abs(beside).max() < 0.5, beside
    assert abs((other - seen) @ camera["back"]) < 6, (seen, other)

    # a double click in the right eye's picture brings the probe before what is seen there
    page.do("doubleClickAt", testid="canvas", x=again / both.shape[1], y=place[1] / height)
    state = page.settled()
    assert np.linalg.norm(np.array(state["proxy"]) - seen) < 8, (state["proxy"], seen)

    page.do("open", url=page.read("location.href"), **SIZE)
    with page.settings():
        assert page.read("document.querySelector('[data-testid=stereo]').value") == "side"
    with page.settings():
        page.do("choose", testid="stereo", value="off")
    assert not page.complaints


@pytest.mark.data
def test_the_picture_of_one_eye_can_stand_above_that_of_the_other(opened: Opened) -> None:
    page = opened.page
    page.do("choose", testid="blend", value="shaded")
    with page.settings():
        page.do("choose", testid="stereo", value="stacked")
    page.read("window.palpate.setView('A')")
    both = page.picture(OUTPUT / "top_bottom.png")
    height = both.shape[0] // 2
    upper, lower = both[:height, 100:-100], both[-height:, 100:-100]
    # the same rows in both, shifted sideways
    apart = np.abs(upper - lower).mean()
    assert 0.002 < apart < 0.05
    assert np.abs(upper[:-20] - lower[20:]).mean() > 2 * apart
    with page.settings():
        page.do("choose", testid="stereo", value="off")
    assert not page.complaints


@pytest.mark.data
@pytest.mark.long
def test_a_finer_quality_takes_more_steps_and_comes_nearer_to_a_still_image(opened: Opened) -> None:
    page = opened.page
    page.do("open", url=page.read("location.href"), **SIZE)
    page.do("resize", **SMALL)
    page.do("choose", testid="blend", value="mip")
    # drawn in software: one picture of one step per voxel unless a person wants more
    with page.settings():
        assert page.read("document.querySelector('[data-testid=quality]').value") == "fast"
        assert page.text("frame-budget-value") == "110 ms"

    shown, pictures = {}, {}
    for quality in ("still", "fine", "fast"):
        with page.settings():
            page.do("choose", testid="quality", value=quality)
        page.frames()
        page.wait("window.palpate.finished", seconds=240.0)
        shown[quality] = page.read("window.palpate.shown")
        path = OUTPUT / f"quality-{quality}.png"
        page.do("screenshot", path=str(path), testid="canvas")
        pixels = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(path)))
        pictures[quality] = pixels[..., :3] / 255.0
    # the view rests: all are whole, the finest of 24 pictures with five steps per voxel
    told = {quality: (each["stepsPerVoxel"], each["passes"]) for quality, each in shown.items()}
    assert told == {"still": (5, 24), "fine": (2, 16), "fast": (1, 1)}
    assert {each["divisor"] for each in shown.values()} == {1}
    fast, fine = (np.abs(pictures[each] - pictures["still"]).mean() for each in ("fast", "fine"))
    assert fine < 0.5 * fast, (fine, fast)

    # both choices are there at the next visit
    with page.settings():
        page.do("slide", testid="frame-budget", value=8)
        page.do("choose", testid="quality", value="balanced")
    page.do("open", url=page.read("location.href"), **SIZE)
    with page.settings():
        assert page.read("document.querySelector('[data-testid=quality]').value") == "balanced"
        assert page.text("frame-budget-value") == "8 ms"
        page.do("choose", testid="quality", value="fast")
        page.do("slide", testid="frame-budget", value=110)
    assert not page.complaints
