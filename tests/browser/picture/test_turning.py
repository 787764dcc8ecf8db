"""A real scan and its large surface while the view turns, and at rest."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import SimpleITK
from browser import Browser, browser, palpate

pytestmark = pytest.mark.browser

SIZE = {"width": 960, "height": 400}
"""Small: the pictures are drawn in software."""


TURNING = """new Promise((resolve) => {
  const { bench } = window.palpate, divisors = [];
  let pieces = bench.pieces;
  const step = () => {
    if (bench.pieces !== pieces) {
      pieces = bench.pieces;
      divisors.push(window.palpate.shown.divisor);
    }
    bench.turn(0.003);
    if (divisors.length < 8) requestAnimationFrame(step); else resolve(divisors);
  };
  requestAnimationFrame(step);
})"""
"""Turns the view until eight pictures were drawn; by what the resolution of each is divided."""


@pytest.fixture(scope="module")
def page(data_folder: Path) -> Iterator[Browser]:
    """CThead, with air above it."""
    path = data_folder / "cthead_stanford" / "CThead.mha"
    with palpate("open", path) as command, browser(drawer="browser") as opened:
        assert opened.do("open", url=command.url, **SIZE)["firstPicture"] is not None
        yield opened


@pytest.mark.long
@pytest.mark.data
def test_a_view_that_turns_after_a_rest_begins_no_finer_than_it_goes_on(page: Browser) -> None:
    page.finish()
    page.read(TURNING)
    for _ in range(3):
        # strips of air, the last ones of a picture at rest, are quicker than a skull that turns
        page.finish()
        divisors = page.read(TURNING)
        assert divisors[0] >= divisors[-1] / 2, divisors


@pytest.mark.data
def test_the_screen_has_fewer_pixels_while_it_shows_nothing_but_a_coarse_picture(
    page: Browser,
) -> None:
    width = "document.querySelector('canvas[aria-hidden]').width"
    # in so little time no CPU draws more than a coarse picture
    with page.settings():
        page.do("slide", testid="frame-budget", value=10)
    page.finish()
    whole = page.read(width)
    with moving(page):
        page.wait(f"window.palpate.shown.divisor >= 4 && {width} === {whole // 2}")
    assert page.read(width) == whole

    # slices beside it are as fine as ever
    page.do("click", testid="layout-slice")
    page.finish()
    with moving(page):
        page.wait("window.palpate.shown.divisor >= 4")
        page.frames()
        assert page.read(width) == whole
    page.do("click", testid="layout-view")
    page.finish()


@pytest.fixture(scope="module")
def surface(page: Browser) -> int:
    """The bone as a surface; gives its triangles: there are more than half a million."""
    # on any CPU half a million take longer than half of it
    with page.settings():
        page.do("slide", testid="frame-budget", value=33)
    page.do("click", testid="shown-as-surface")
    page.wait("window.palpate.triangles[1] > 500_000 && window.palpate.finished")
    triangles: int = page.read("window.palpate.triangles[1]")
    return triangles


@contextmanager
def moving(page: Browser) -> Iterator[None]:
    """Turns the view a little to and fro."""
    page.read(
        "void (window.there = 0.002, window.turning = setInterval(() => {"
        " window.palpate.bench.turn(window.there); window.there *= -1; }, 20))"
    )
    try:
        yield
    finally:
        page.read("void clearInterval(window.turning)")
    page.finish()


def bone(page: Browser, path: Path) -> float:
    """Returns the share of the view that is as bright as lit bone: tissue has less blue."""
    page.do("screenshot", path=str(path), testid="canvas")
    pixels = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(path)))
    return float((pixels[..., :3].min(axis=-1) > 110).mean())


@pytest.mark.data
def test_a_large_surface_is_its_voxels_while_the_view_turns_and_all_triangles_at_rest(
    page: Browser, surface: int, tmp_path: Path
) -> None:
    assert page.read("window.palpate.shown.triangles") == surface
    picked = "window.palpate.pick(...window.palpate.middle)"
    before = page.read(picked)
    resting = bone(page, tmp_path / "resting.png")
    assert resting > 0.03

    with moving(page):
        page.wait("window.palpate.shown.triangles === 0", seconds=60.0)
        # fine pixels are wide ones now
        assert bone(page, tmp_path / "moving.png") == pytest.approx(resting, rel=0.3)

    assert page.read("window.palpate.shown.triangles") == surface
    assert bone(page, tmp_path / "again.png") == pytest.approx(resting, rel=0.02)
    # what is picked is of all triangles, whatever was drawn meanwhile
    assert before is not None
    assert page.read(picked) is not None


@pytest.mark.long
@pytest.mark.data
def test_so_is_one_that_is_seen_through(page: Browser, surface: int, tmp_path: Path) -> None:
    page.do("slide", testid="surface-opacity", value=0.5)
    page.all_done()
    page.finish()
    # in more layers than one
    assert page.read("window.palpate.shown.triangles") > surface
    resting = bone(page, tmp_path / "resting.png")
    assert resting > 0.03
    with moving(page):
        page.wait("window.palpate.shown.triangles === 0", seconds=60.0)
        assert bone(page, tmp_path / "moving.png") == pytest.approx(resting, rel=0.3)
    assert page.read("window.palpate.shown.triangles") > surface
    page.do("slide", testid="surface-opacity", value=1.0)
    page.all_done()


@pytest.mark.data
def test_a_large_surface_has_few_triangles_while_the_view_turns_where_no_body_can_stand_for_it(
    page: Browser, surface: int
) -> None:
    # there voxels of segments are values like others
    page.do("choose", testid="blend", value="mip")
    page.finish()
    assert page.read("window.palpate.shown.triangles") == surface
    with moving(page):
        # of bone a thirteenth
        page.wait(f"window.palpate.shown.triangles < {surface / 10}", seconds=60.0)
        assert page.read("window.palpate.shown.triangles") > 0
    assert page.read("window.palpate.shown.triangles") == surface
