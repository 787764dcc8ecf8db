"""Framing, transfer functions and modes are as the page has them.

``as_the_page.json`` is what the page works out (viewer/tests/core/appearance/as_the_page.test.ts).
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
from palpate.pictures.appearance import Appearance, Lighting, Mode
from palpate.pictures.camera import Camera
from palpate.pictures.choices import View
from palpate.pictures.extent import Extent, extent_of
from palpate.pictures.felt_look import hinted
from palpate.pictures.look_of_scan import appearance_of, exceeded_by
from palpate.pictures.looks import looks
from palpate.pictures.shown_segments import ShownBodies
from palpate.pictures.transfer import Transfer, transfer_of_preset, transfer_of_tissue
from palpate.pictures.views import camera_of
from palpate.volumes.histogram import Anchors, Histogram
from palpate.volumes.volume import Volume, VolumeTraits

PAGE: dict[str, Any] = json.loads(Path(__file__).with_name("as_the_page.json").read_text("utf-8"))


def scan_of_page() -> Volume:
    """Returns the ellipsoid that the page's test has, its grid with a corner at 0."""
    about = PAGE["scan"]
    axes = [np.arange(count) for count in about["dimensions"]]
    x, y, z = (
        (axis - middle) / half
        for axis, middle, half in zip(axes, about["middle"], about["half"], strict=True)
    )
    inside = x**2 + y[:, None] ** 2 + z[:, None, None] ** 2 <= 1.0
    spacing = about["spacing"]
    return Volume(
        np.where(inside, 300, -1000).astype(np.int16),
        spacing=spacing,
        origin=[edge / 2.0 for edge in spacing],
        traits=VolumeTraits(unit="HU"),
    )


def numbers(transfer: Transfer) -> list[list[float]]:
    return [[value, *colour, extinction] for value, colour, extinction in transfer]


def page_numbers(rows: list[Any]) -> list[list[float]]:
    return [[value, *colour, extinction] for value, colour, extinction in rows]


def test_the_space_that_is_shown_is_found_as_the_page_finds_it() -> None:
    assert np.allclose(extent_of(scan_of_page()).outline, PAGE["outline"])


@pytest.mark.parametrize("case", PAGE["cameras"], ids=lambda case: str(case["size"]))
@pytest.mark.parametrize("view", [*get_args(View), "orthographic"])
def test_views_are_framed_as_on_the_page(view: str, case: dict[str, Any]) -> None:
    extent = Extent(np.array(PAGE["outline"]))
    name: Any = "first" if view == "orthographic" else view
    size = tuple(case["size"])
    camera = camera_of(name, extent, size, orthographic=view == "orthographic")
    page = case["views"][view]
    for field in Camera.__struct_fields__:
        made, wanted = getattr(camera, field), page.get(field, 0.0)
        assert (made is None) == (wanted is None)
        assert made is None or np.allclose(made, wanted, rtol=1e-7, atol=1e-7), field


@pytest.mark.parametrize("case", PAGE["looks"], ids=lambda case: str(case["anchors"]))
def test_transfer_functions_are_those_of_the_page(case: dict[str, Any]) -> None:
    anchors = Anchors(*case["anchors"])
    assert np.allclose(numbers(transfer_of_tissue(anchors)), page_numbers(case["tissue"]))
    hints = numbers(hinted(transfer_of_tissue(anchors), anchors))
    assert np.allclose(hints, page_numbers(case["hinted"]), rtol=1e-6, atol=1e-7)
    assert set(case["presets"]) == {preset.name for preset in looks().presets}
    for preset in looks().presets:
        made = numbers(transfer_of_preset(preset, anchors, tuple(PAGE["limits"])))
        wanted = page_numbers(case["presets"][preset.name])
        assert len(made) == len(wanted)
        # a point between two may be rounded to another last digit
        assert np.allclose(made, wanted, rtol=1e-6, atol=1e-7), preset.name


@pytest.mark.parametrize("case", PAGE["looks"], ids=lambda case: str(case["anchors"]))
@pytest.mark.parametrize("mode", get_args(Mode))
def test_modes_begin_as_on_the_page(
    mode: Mode, case: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    anchors = Anchors(*case["anchors"])
    monkeypatch.setattr("palpate.pictures.look_of_scan.exceeded_by", lambda *_: PAGE["limits"][1])
    volume = scan_of_page()
    monkeypatch.setitem(volume.__dict__, "anchors", anchors)
    made: Appearance = appearance_of(volume, ShownBodies(), mode=mode)
    page = case["modes"][mode]
    assert made.density == page["density"]
    assert np.allclose(made.window, [page["window"]["window"], page["window"]["level"]])
    assert made.iso_value == page["isoValue"]
    assert made.slab == page["slab"]
    assert np.isclose(made.tissue_from, page["tissueFrom"])


def test_the_brightest_value_is_found_as_on_the_page() -> None:
    about = PAGE["histogram"]
    histogram = Histogram(about["low"], about["high"], np.array(about["counts"], np.uint64))
    for share, value in PAGE["brightest"]:
        assert exceeded_by(histogram, share) == pytest.approx(value)


def test_qualities_are_those_of_the_page() -> None:
    told = {
        name: {"stepsPerVoxel": each.steps_per_voxel, "passes": each.passes}
        for name, each in looks().qualities.items()
    }
    assert told == PAGE["qualities"]


def test_light_begins_as_on_the_page() -> None:
    assert Lighting(**looks().lighting) == Lighting()
