"""Large surfaces of a real scan while the view turns, and at rest."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from browser import Browser, browser, palpate

pytestmark = pytest.mark.browser

SIZE = {"width": 960, "height": 400}
"""Small: the pictures are drawn in software."""


@pytest.fixture
def page(data_folder: Path) -> Iterator[Browser]:
    """CThead, whose bone is a surface of more than half a million triangles."""
    path = data_folder / "cthead_stanford" / "CThead.mha"
    with palpate("open", path) as command, browser() as opened:
        assert opened.do("open", url=command.url, **SIZE)["firstPicture"] is not None
        opened.do("click", testid="shown-as-surface")
        opened.wait("window.palpate.triangles[1] > 500_000 && window.palpate.finished")
        yield opened


@pytest.mark.data
def test_a_large_surface_has_few_triangles_while_the_view_turns_and_all_at_rest(
    page: Browser,
) -> None:
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
