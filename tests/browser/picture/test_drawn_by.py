"""The 3-D view as the engine draws it, beside the same as the browser draws it."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import SimpleITK
from browser import ROOT, Browser, browser, palpate
from numpy.typing import NDArray
from slow_way import SlowWay, slow_way

pytestmark = pytest.mark.browser

OUTPUT = ROOT / "tests" / "output"
SIZE = {"width": 1000, "height": 460}
"""Small: one of both is drawn in software."""
SAVED = "performance.getEntriesByType('resource').filter((e) => e.name.includes('/picture')).length"
PROGRESS = "document.querySelector('[data-testid=image-progress]')?.textContent ?? null"


@pytest.fixture(scope="module")
def way(data_folder: Path) -> Iterator[SlowWay]:
    path = data_folder / "cthead_stanford" / "CThead.mha"
    with palpate("open", path) as command, slow_way(command.url) as way:
        yield way


@pytest.fixture(scope="module")
def page(way: SlowWay) -> Iterator[Browser]:
    with browser(drawer="") as opened:
        opened.do("open", url=way.url, **SIZE)
        # the browser works light out in coarse cells
        light = {"occlusion": 0, "shadow": 0}
        opened.read(f"window.palpate.keep('lighting', {json.dumps(light)})")
        opened.all_done()
        assert opened.do("open", url=way.url, **SIZE)["firstPicture"] is not None
        yield opened


@pytest.mark.data
def test_where_the_browser_draws_by_the_cpu_the_engine_draws(page: Browser) -> None:
    assert page.read("window.palpate.drawer") == {
        "choice": "auto",
        "engine": True,
        "obstacle": None,
    }
    assert page.text("drawn-by") == "engine"
    assert page.read("window.palpate.shown.divisor") <= 4
    page.finish()
    assert page.read("window.palpate.shown.divisor") == 1
    # the tests below compare what both draw: not whichever is quicker on this machine
    page.draw_by("engine")


@pytest.mark.data
def test_both_draw_the_same_picture(page: Browser) -> None:
    engine = page.picture(OUTPUT / "drawn-by-engine.png")
    page.draw_by("browser")
    own = page.picture(OUTPUT / "drawn-by-browser.png")
    page.draw_by("engine")
    off = np.abs(engine - own)[:, 90:-10]
    assert own.std() > 0.1
    assert off.mean() <= 4 / 255


@pytest.mark.data
def test_a_segment_that_is_hidden_is_gone_from_the_picture(page: Browser) -> None:
    before = page.picture(OUTPUT / "drawn-by-engine-bone.png")
    page.do("click", testid="visible-1")
    page.all_done()
    after = page.picture(OUTPUT / "drawn-by-engine-hidden.png")
    page.do("click", testid="visible-1")
    page.all_done()
    assert np.abs(after - before).mean() > 0.02


@pytest.mark.data
def test_each_cut_into_a_segment_is_seen_without_a_turn_of_the_view(page: Browser) -> None:
    page.do("press", key="e")
    # the first makes voxels of a threshold, which alone would change the picture
    cut(page, right=-90)
    before = page.picture(OUTPUT / "drawn-by-engine-cut.png")
    cut(page, right=40)
    after = page.picture(OUTPUT / "drawn-by-engine-cuts.png")
    # the hole of one touch covers some hundreds of the view's 200 000 pixels
    assert (np.abs(after - before).max(axis=2) > 0.1).mean() > 1e-4
    # only what was cut is drawn again until the cut is done, so that the rest stays sharp
    page.read(
        "void (() => { window.__coarsest = 1; const look = () => {"
        " window.__coarsest = Math.max(window.__coarsest, window.palpate.shown.divisor);"
        " requestAnimationFrame(look); }; look(); })()"
    )
    cut(page, right=10)
    assert page.read("window.__coarsest") == 1
    for _ in range(3):
        page.do("press", key="Control+z")
        page.all_done()
    page.do("press", key="h")


def cut(page: Browser, *, right: int) -> None:
    """Erases where bone is met so many pixels beside the middle of the view.

    The probe is back where it was then: it is seen too.
    """
    start = page.read("window.palpate.state.proxy")
    edit = page.read("window.palpate.lastEdit")
    aim = (
        "(({width, height}) => window.palpate.pick(width / 2 + %d, 0.4 * height).point)"
        "(document.querySelector('[data-testid=canvas]').getBoundingClientRect())"
    )
    point = page.read(aim % right)
    page.read(f"window.palpate.place({point})")
    hold(page, "keydown")
    deep = "((point, {back}) => point.map((p, i) => p - 4 * back[i]))"
    page.read(f"window.palpate.hand({deep}({point}, window.palpate.camera))")
    page.wait(f"window.palpate.lastEdit > {edit}")
    hold(page, "keyup")
    page.wait("!window.palpate.state.tool.on")
    page.read(f"window.palpate.place({start})")
    page.wait(f"Math.hypot(...window.palpate.state.proxy.map((p, i) => p - {start}[i])) < 0.01")
    page.all_done()


def hold(page: Browser, kind: str) -> None:
    """Holds the key of the tool, or lets it go."""
    page.read(f"void window.dispatchEvent(new KeyboardEvent('{kind}', {{key: 'x'}}))")


@pytest.mark.data
def test_over_a_slow_line_pictures_are_small_and_look_the_same(page: Browser, way: SlowWay) -> None:
    # over such a line the browser may well be quicker
    page.draw_by("engine")
    before = page.picture(OUTPUT / "drawn-by-engine-near.png")
    way.rate = 300e3
    try:
        for _ in range(4):
            page.read("window.palpate.bench.turn(0.05)")
            page.frames()
            page.wait("window.palpate.shown.divisor > 1")
        began, handed = time.monotonic(), way.handed
        page.read("window.palpate.bench.turn(-0.2)")
        page.finish()
        # beside states, which take less than 120 000 in a second
        sent = way.handed - handed - 120e3 * (time.monotonic() - began)
        far = page.picture(OUTPUT / "drawn-by-engine-far.png")
    finally:
        way.rate = None
    assert np.abs(far - before).mean() <= 2 / 255
    assert sent < 1e6, "one that is not packed has two million bytes"
    assert page.read("window.palpate.drawer.engine")


@pytest.mark.data
def test_a_view_that_turns_is_followed_before_the_engine_has_drawn_it(
    page: Browser, way: SlowWay
) -> None:
    true = assert_a_turn_is_followed(page, way)
    # the same view without a turned picture before it
    page.draw_by("browser")
    page.draw_by("engine")
    again = page.picture(OUTPUT / "drawn-by-engine-turned-again.png")
    # the first one came over a line that had stood still, and may be packed
    assert np.abs(again - true).mean() < 1 / 255
    page.read("window.palpate.bench.turn(-0.1)")
    page.finish()


@pytest.mark.data
@pytest.mark.parametrize("mode", ["absorption", "emission", "mip"])
def test_a_view_through_the_scan_is_followed_too(page: Browser, way: SlowWay, mode: str) -> None:
    page.do("choose", testid="blend", value=mode)
    # what lies before and behind its depth moves otherwise
    assert_a_turn_is_followed(page, way, share=0.85)
    page.read("window.palpate.bench.turn(-0.1)")
    page.do("choose", testid="blend", value="shaded")
    page.finish()


def assert_a_turn_is_followed(
    page: Browser, way: SlowWay, *, share: float = 0.7
) -> NDArray[np.float64]:
    """Turns the view while nothing comes; returns its true picture.

    The turned picture is off by no more than a share of what the one before it is.
    """
    page.finish()
    before = canvas(page, "turned-before")
    numbers = page.read("window.palpate.bench.numbers")
    way.rate = 0.0
    try:
        page.read("window.palpate.bench.turn(0.1)")
        page.wait(f"window.palpate.bench.numbers.turns > {numbers['turns']}")
        page.frames()
        turned = canvas(page, "turned")
        # no picture has come, and what stands in for one is not taken for it
        assert page.read("window.palpate.bench.numbers.shown") == numbers["shown"]
        assert not page.read("window.palpate.finished")
    finally:
        way.rate = None
    page.finish()
    true = page.picture(OUTPUT / "drawn-by-engine-turned-true.png")
    moved = np.abs(true - before).mean()
    assert np.abs(turned - before).mean() > 0.5 * moved
    # coarse as it is, it is nearer to the true picture than the one before
    assert np.abs(turned - true).mean() < share * moved
    return true


def canvas(page: Browser, name: str) -> NDArray[np.float64]:
    """Returns the 3-D view as it is now, finished or not."""
    path = OUTPUT / f"drawn-by-engine-{name}.png"
    page.do("screenshot", path=str(path), testid="canvas")
    return pixels_of(path)


@pytest.mark.data
def test_a_resized_view_keeps_its_picture_and_without_answers_the_browser_draws(
    page: Browser, way: SlowWay
) -> None:
    page.finish()
    way.rate = 0.0
    try:
        page.do("resize", width=SIZE["width"] - 60, height=SIZE["height"] + 80)
        page.frames()
        page.do("screenshot", path=str(OUTPUT / "drawn-by-engine-resized.png"), testid="canvas")
        resized = pixels_of(OUTPUT / "drawn-by-engine-resized.png")
        assert not page.read("window.palpate.finished")
        # the ground alone is dark
        assert (resized.max(axis=2) > 0.4).mean() > 0.05
        page.wait("window.palpate.drawer.engine === false")
        with page.settings():
            assert page.text("drawer-obstacle").startswith(
                "Drawn by this browser: the engine sent no picture for 10 s; "
            )
    finally:
        way.rate = None
    page.finish()
    # who chooses again need not wait until it is tried
    page.draw_by("browser")
    page.draw_by("engine")
    page.wait("window.palpate.drawer.engine")
    page.do("resize", **SIZE)
    page.finish()


def pixels_of(path: Path) -> NDArray[np.float64]:
    """Returns the colours of a picture, 0 to 1."""
    pixels = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(path)))
    return np.asarray(pixels[..., :3], np.float64) / 255.0


@pytest.mark.data
def test_a_picture_that_is_saved_looks_as_the_one_on_the_screen(page: Browser) -> None:
    shown = page.picture(OUTPUT / "drawn-by-engine.png")
    saved = saved_picture(page, magnification=2)
    assert np.abs(saved - shown).mean() <= 4 / 255
    # and with a surface of triangles
    page.do("click", testid="shown-as-surface")
    page.wait("window.palpate.triangles[1] > 0")
    page.all_done()
    with_surface = page.picture(OUTPUT / "drawn-by-engine-surface.png")
    assert np.abs(with_surface - shown).mean() > 1 / 255
    saved = saved_picture(page, magnification=2)
    assert np.abs(saved - with_surface).mean() <= 4 / 255
    page.do("click", testid="shown-as-volume")
    page.all_done()


@pytest.mark.data
def test_marks_are_in_a_saved_picture_as_on_the_screen_unless_left_out(page: Browser) -> None:
    page.do("press", key="m")
    ends = ((0.42, 0.33), (0.56, 0.42))
    for x, y in ends:
        page.do("clickAt", testid="canvas", x=x, y=y)
    page.wait("window.palpate.marks.length === 1")
    page.do("press", key="Escape")
    shown = page.picture(OUTPUT / "drawn-by-engine-marks.png")
    saved = saved_picture(page, magnification=2)
    height, width = shown.shape[:2]
    for x, y in ends:
        row, column = round(y * height), round(x * width)
        around = (slice(row - 10, row + 10), slice(column - 10, column + 10))
        assert pink_share(shown[around]) > 0.05
        assert np.abs(saved[around] - shown[around]).mean() <= 8 / 255
    # a screenshot of the picture is without what is written over it
    assert pink_share(saved) > 1.5 * pink_share(shown)
    assert pink_share(saved_picture(page, magnification=2, marks=False)) == 0
    page.do("press", key="Control+z")
    page.wait("window.palpate.marks.length === 0")


def pink_share(picture: NDArray[np.float64]) -> float:
    """Returns the share of pixels with the colour of marks."""
    red, green, blue = picture[..., 0], picture[..., 1], picture[..., 2]
    return float(((red > 0.7) & (green < 0.75 * red) & (blue > 1.15 * green)).mean())


def saved_picture(page: Browser, *, magnification: int, marks: bool = True) -> NDArray[np.float64]:
    """Returns what the engine draws for a file: at the size of the view."""
    before = page.read(SAVED)
    page.do("click", testid="save-image")
    page.do("choose", testid="image-size", value=str(magnification))
    if not marks:
        page.do("click", testid="image-marks")
    path = OUTPUT / "saved-by-engine.png"
    page.do("download", testid="image-save", path=str(path))
    assert page.read(SAVED) == before + 1
    pixels = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(path)))[..., :3] / 255.0
    height, width = (edge // magnification for edge in pixels.shape[:2])
    blocks = pixels.reshape(height, magnification, width, magnification, 3)
    mean: NDArray[np.float64] = blocks.mean(axis=(1, 3))
    return mean


@pytest.mark.data
def test_the_view_turns_while_a_picture_is_saved_and_cancel_leaves_nothing(page: Browser) -> None:
    before = page.read("window.palpate.camera.back[0]")
    page.do("click", testid="save-image")
    page.do("choose", testid="image-size", value="8")
    page.do("click", testid="image-save")
    page.do("press", key="3")
    page.wait("window.palpate.camera.back[0] > 0.99 && window.palpate.shown.finished")
    assert page.read(PROGRESS) is not None
    page.do("click", testid="image-cancel")
    page.wait(f"{PROGRESS} === null")
    page.do("press", key="r")
    page.wait(f"window.palpate.camera.back[0] === {before}")
    page.finish()
    assert page.complaints == []


@pytest.mark.data
@pytest.mark.parametrize("mode", ["side", "anaglyph", "stacked"])
def test_both_draw_the_same_pictures_of_two_eyes(page: Browser, mode: str) -> None:
    with page.settings():
        page.do("choose", testid="stereo", value=mode)
    if mode == "stacked":
        with page.settings():
            page.do("click", testid="stereo-squeezed")
    page.finish()
    assert page.read("window.palpate.drawer.engine")
    engine = page.picture(OUTPUT / f"drawn-by-engine-{mode}.png")
    page.draw_by("browser")
    own = page.picture(OUTPUT / f"drawn-by-browser-{mode}.png")
    page.draw_by("engine")
    if mode == "stacked":
        with page.settings():
            page.do("click", testid="stereo-squeezed")
    with page.settings():
        page.do("choose", testid="stereo", value="off")
    page.finish()
    flat = page.picture(OUTPUT / "drawn-by-engine-flat.png")
    assert np.abs(engine - own)[:, 90:-10].mean() <= 4 / 255
    assert np.abs(engine - flat)[:, 90:-10].mean() > 2 * np.abs(engine - own)[:, 90:-10].mean()


@pytest.mark.data
def test_two_eyes_follow_a_turn_and_are_saved(page: Browser, way: SlowWay) -> None:
    with page.settings():
        page.do("choose", testid="stereo", value="side")
    assert_a_turn_is_followed(page, way)
    page.read("window.palpate.bench.turn(-0.1)")
    page.finish()
    shown = page.picture(OUTPUT / "drawn-by-engine-side.png")
    page.do("click", testid="save-image")
    page.do("choose", testid="image-size", value="1")
    path = OUTPUT / "saved-side.png"
    page.do("download", testid="image-save", path=str(path))
    assert np.abs(pixels_of(path) - shown)[:, 90:-10].mean() <= 5 / 255
    with page.settings():
        page.do("choose", testid="stereo", value="off")
    page.finish()


@pytest.mark.data
def test_a_choice_is_remembered(page: Browser) -> None:
    page.draw_by("browser")
    page.do("open", url=page.read("location.href"), **SIZE)
    assert page.read("window.palpate.drawer.choice") == "browser"
    page.draw_by("auto")
    page.do("open", url=page.read("location.href"), **SIZE)
    assert page.read("window.palpate.drawer.engine")
    page.finish()
    assert page.complaints == []
