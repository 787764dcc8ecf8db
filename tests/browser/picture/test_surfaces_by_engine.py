"""Surfaces of segments as the engine draws them, beside the same as the browser draws them."""

from __future__ import annotations

import json
from collections.abc import Iterator

import numpy as np
import pytest
import SimpleITK
from browser import ROOT, Browser, browser, palpate
from numpy.typing import NDArray

pytestmark = pytest.mark.browser

OUTPUT = ROOT / "tests" / "output"
SIZE = {"width": 1000, "height": 420}
"""Small: one of both is drawn in software."""
MIDDLES = ((20.0, 32.0, 32.0), (46.0, 32.0, 32.0))
RADIUS = 9.0


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """Two hard balls in a soft one."""
    folder = tmp_path_factory.mktemp("surfaces")
    z, y, x = np.indices((64, 64, 68))
    away = np.linalg.norm(np.stack([x - 33, y - 32, z - 32], -1), axis=-1)
    values = (300 / (1 + np.exp(away - 28))).astype(np.int16)
    labels = np.zeros(z.shape, np.uint8)
    for label, middle in enumerate(MIDDLES, start=1):
        near = np.linalg.norm(np.stack([x, y, z], -1) - middle, axis=-1)
        labels[near <= RADIUS] = label
        values[near <= RADIUS] = 1000
    paths = folder / "scan.mha", folder / "labels.mha"
    for array, path in zip((values, labels), paths, strict=True):
        SimpleITK.WriteImage(SimpleITK.GetImageFromArray(array), str(path))
    with (
        palpate("open", paths[0], "--segments", paths[1]) as command,
        browser() as opened,
    ):
        opened.do("open", url=command.url, **SIZE)
        # the browser works light out in coarse cells
        light = {"occlusion": 0, "shadow": 0}
        opened.read(f"window.palpate.keep('lighting', {json.dumps(light)})")
        opened.all_done()
        assert opened.do("open", url=command.url, **SIZE)["firstPicture"] is not None
        opened.do("click", testid="all-as-surface")
        opened.wait("window.palpate.triangles[1] > 0 && window.palpate.triangles[2] > 0")
        yield opened


def by_both(page: Browser, name: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the picture as the engine draws it, and as the browser does."""
    page.all_done()
    assert page.read("window.palpate.drawer") == {
        "choice": "engine",
        "engine": True,
        "obstacle": None,
    }
    engine = page.picture(OUTPUT / f"surfaces-{name}-engine.png")
    page.draw_by("browser")
    own = page.picture(OUTPUT / f"surfaces-{name}-browser.png")
    page.draw_by("engine")
    return engine, own


def assert_alike(
    pictures: tuple[NDArray[np.float64], NDArray[np.float64]], *, within: float = 4.0
) -> None:
    engine, own = pictures
    # without what the page writes over the picture
    off = np.abs(engine - own)[:, 90:-10]
    assert own.std() > 0.05
    assert off.mean() <= within / 255


def test_opaque_surfaces_in_tissue(page: Browser) -> None:
    assert_alike(by_both(page, "opaque"))


def test_a_surface_that_is_seen_through(page: Browser) -> None:
    opaque = page.picture(OUTPUT / "surfaces-opaque.png")
    page.do("slide", testid="surface-opacity", value=0.4)
    engine, own = by_both(page, "through")
    assert np.abs(engine - opaque).mean() > 0.5 / 255
    assert_alike((engine, own))


def test_a_wireframe(page: Browser) -> None:
    page.do("slide", testid="surface-opacity", value=1.0)
    page.do("click", testid="surface-wireframe")
    assert_alike(by_both(page, "wireframe"))
    page.do("click", testid="surface-wireframe")
    page.all_done()


def test_a_segment_that_was_moved_is_seen_where_it_stands(page: Browser) -> None:
    page.do("click", testid="move-object")
    page.read("window.palpate.setView('A')")
    # the handles stand elsewhere then
    before = page.picture(OUTPUT / "surfaces-unmoved.png")
    page.do("dragElement", testid="arrow-L", x=40, y=0)
    page.wait("window.palpate.state.poses.some(({ id }) => id === 1)")
    page.settled()
    engine, own = by_both(page, "moved")
    assert np.abs(engine - before).mean() > 1 / 255
    assert_alike((engine, own))
    assert page.complaints == []
