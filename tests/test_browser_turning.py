"""A real scan and its large surface while the view turns, and at rest."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
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
    with palpate("open", path) as command, browser() as opened:
        assert opened.do("open", url=command.url, **SIZE)["firstPicture"] is not None
        yield opened


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
def test_a_large_surface_has_few_triangles_while_the_view_turns_and_all_at_rest(
    page: Browser,
) -> None:
    # of bone there are more than half a million
    page.do("click", testid="shown-as-surface")
    page.wait("window.palpate.triangles[1] > 500_000 && window.palpate.finished")
    every = page.read("window.palpate.triangles[1]")
    assert page.read("window.palpate.shown.triangles") == every
    picked = "window.palpate.pick(...window.palpate.middle)"
    before = page.read(picked)

    # on any CPU half a million take longer than half of a frame, 33 ms: about a fifth is drawn
    page.read("void (window.turning = setInterval(() => { window.palpate.bench.turn(0.01); }, 20))")
    page.wait(f"window.palpate.shown.triangles < {every / 4}", seconds=60.0)
    page.read("clearInterval(window.turning)")

    page.wait("window.palpate.finished", seconds=60.0)
    assert page.read("window.palpate.shown.triangles") == every
    # what is picked is of all triangles, whatever was drawn meanwhile
    assert before is not None
    assert page.read(picked) is not None
