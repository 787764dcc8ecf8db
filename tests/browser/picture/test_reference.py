"""Every mode of the 3-D view of a small real CT against a renderer in NumPy, with jitter off."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import SimpleITK
from browser import ROOT, browser, palpate
from numpy.typing import NDArray
from opened_scan import Opened
from reference_head import GREY, LOOK, MODES, small_head
from reference_renderer import Reference, View, ground_at, on_screen, unit

pytestmark = [pytest.mark.browser, pytest.mark.long]

OUTPUT = ROOT / "tests" / "output"
SIZE = {"width": 1000, "height": 460}
APART = 4
"""Every so many pixels, along both edges, one is held against the reference."""
PROBE = 6.0
"""Radius around the probe in which its ball is seen [mm]."""
Array = NDArray[np.float64]


def remembered(mode: str) -> dict[str, object]:
    """Returns the look as the page remembers it."""
    windows = {name: {"window": w, "level": v} for name, (w, v) in LOOK.windows.items()}
    return {
        "optics": {
            "blend": mode,
            "densities": LOOK.densities,
            "windows": windows,
            "slabs": LOOK.slabs,
            "isoValue": LOOK.iso_value,
        },
        "curve": {
            "name": "Head",
            "curve": {
                "opacities": [{"value": v, "opacity": o} for v, o in LOOK.opacities],
                "colours": [{"value": v, "colour": c} for v, c in LOOK.colours],
            },
            "shift": 0,
            "stretch": 1,
        },
        # neither of them is in the reference: they come from coarse cells
        "lighting": {"occlusion": 0, "shadow": 0},
        # the bone that is offered is no body of its own
        "inside": {"1": "plain"},
    }


@pytest.fixture(scope="module")
def opened(data_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Opened]:
    path = tmp_path_factory.mktemp("small") / "head.mha"
    image = small_head(data_folder / "cthead_stanford" / "CThead.mha")
    SimpleITK.WriteImage(image, str(path))
    with palpate("open", path, "--unit", "HU") as command, browser(drawer="browser") as page:
        page.do("open", url=command.url, **SIZE)
        page.read("localStorage.setItem('palpate.quality', JSON.stringify({ quality: 'still' }))")
        for name, part in remembered("mip").items():
            page.read(f"window.palpate.keep('{name}', {json.dumps(part)})")
        page.all_done()
        page.do("open", url=command.url, **SIZE)
        yield Opened(page, image)


def view_of(opened: Opened, pixels: Array) -> View:
    """Returns the rays of pixels."""
    camera = opened.page.read("window.palpate.camera")
    ends = opened.points_along(pixels, np.array([-float(camera["distance"]), 0.0]))
    right, up, back = (np.array(camera[name]) for name in ("right", "up", "back"))
    directions = unit(ends[:, 1] - ends[:, 0])
    return View(ends[:, 0], directions, up, right, back, float(camera["distance"]))


def away_from_probe(opened: Opened, pixels: Array) -> NDArray[np.bool_]:
    """Says which pixels the ball of the probe does not cover: it is no part of the scan."""
    probe = np.array(opened.page.read("window.palpate.state")["proxy"])
    points = opened.points_along(pixels, np.arange(-200.0, 200.0))
    return np.asarray(np.linalg.norm(points - probe, axis=-1).min(axis=1) > PROBE)


@pytest.mark.data
def test_each_mode_is_the_picture_of_a_renderer_in_numpy(opened: Opened) -> None:
    page, image = opened.page, opened.image
    drawn = {}
    for mode in MODES:
        page.do("choose", testid="blend", value=mode)
        drawn[mode] = page.picture(OUTPUT / f"reference-{mode}.png")

    height, width = drawn["mip"].shape[:2]
    rows, columns = (each.ravel() for each in np.mgrid[0:height:APART, 0:width:APART])
    pixels = np.stack([columns, rows], 1).astype(float)
    view, counted = view_of(opened, pixels), away_from_probe(opened, pixels)
    ground = ground_at((columns + 0.5) / width, 1 - (rows + 0.5) / height)
    spacing, origin = np.array(image.GetSpacing()), np.array(image.GetOrigin())
    reference = Reference(SimpleITK.GetArrayFromImage(image), spacing, origin, LOOK)
    for mode in MODES:
        expected = on_screen(reference.picture(mode, view), ground, bent=mode not in GREY)
        off = np.abs(drawn[mode][rows, columns] - expected)[counted]
        mean, within = float(off.mean()) * 255, float(np.mean(off.max(axis=1) <= 8 / 255))
        assert mean < 1, (mode, mean)
        assert within >= 0.999, (mode, within)
        # there is something to be seen, and it is not the same all over
        assert np.ptp(expected[counted]) > 0.5, mode
    assert not page.complaints
