"""A second scan with the first in a real browser: the same lung at two dates, by a known transform.

The oracle is SimpleITK: it lays the second file on the plane of a slice, through the transform.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
import SimpleITK
from browser import ROOT, Browser, browser, palpate
from numpy.typing import NDArray
from palpate import protocol

pytestmark = pytest.mark.browser

OUTPUT = ROOT / "tests" / "output"
Picture = NDArray[np.float64]

TURN = SimpleITK.Euler3DTransform((-80.0, -40.0, -1280.0), 0.0, 0.0, 0.1, (-12.0, -18.0, 36.0))
"""From points of the first scan to the second's."""


@pytest.fixture(scope="module")
def lungs(data_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """The baseline with the follow-up, in four panes."""
    folder = data_folder / "elastix_lung_pair"
    transform = tmp_path_factory.mktemp("second") / "turn.tfm"
    SimpleITK.WriteTransform(TURN, str(transform))
    first, second = folder / "3DCT_lung_baseline.mha", folder / "3DCT_lung_followup.mha"
    options = ("--with", second, "--transform", transform)
    with palpate("open", first, *options) as command, browser() as page:
        opening = page.do("open", url=command.url, width=1280, height=860)
        assert opening["firstPicture"] is not None
        page.do("click", testid="layout-four")
        page.wait("window.palpate.slices.length === 3")
        page.do("clickText", text="Second scan")
        assert page.text("second-name") == "3DCT_lung_followup"
        yield page


def axial(page: Browser) -> tuple[Picture, dict[str, Any]]:
    """The axial slice as it is drawn, RGB 0..1 [h, w, 3], and where it lies."""
    page.finish()
    path = OUTPUT / "second_axial.png"
    path.parent.mkdir(parents=True, exist_ok=True)
    page.do("screenshot", path=str(path), testid="slice-axial")
    pixels = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(path)))
    found = page.read("window.palpate.slices.find(({name}) => name === 'axial')")
    return np.asarray(pixels[..., :3], np.float64) / 255.0, {**found["plane"], **found["rect"]}


def laid(image: Any, plane: dict[str, Any], transform: Any) -> Picture:
    """Values of a file in the middle of each pixel of a slice; NaN outside."""
    right, up, centre = (np.array(plane[key]) for key in ("right", "up", "centre"))
    width, height, size = round(plane["width"]), round(plane["height"]), plane["pixel"]
    first = centre - right * size * (width - 1) / 2 + up * size * (height - 1) / 2
    reference = SimpleITK.Image([width, height, 1], SimpleITK.sitkUInt8)
    reference.SetSpacing((size, size, 1.0))
    reference.SetOrigin(first.tolist())
    reference.SetDirection(np.stack([right, -up, np.cross(right, -up)], 1).ravel().tolist())
    lain = SimpleITK.Resample(
        image, reference, transform, SimpleITK.sitkLinear, float("nan"), SimpleITK.sitkFloat64
    )
    return np.asarray(SimpleITK.GetArrayFromImage(lain)[0], np.float64)


def grey(values: Picture, page: Browser, scan: str) -> Picture:
    width, level = (
        float(page.read(f"document.querySelector('[data-testid={scan}{which}]').value"))
        for which in ("width" if scan == "window-" else "window", "level")
    )
    return np.clip((values - level) / width + 0.5, 0, 1)


@pytest.mark.data
def test_slices_show_the_second_scan_where_its_transform_puts_it(
    lungs: Browser, data_folder: Path
) -> None:
    folder = data_folder / "elastix_lung_pair"
    second = SimpleITK.ReadImage(str(folder / "3DCT_lung_followup.mha"))
    lungs.do("choose", testid="second-fusion", value="blend")
    lungs.do("choose", testid="second-tint", value="grey")
    lungs.do("slide", testid="second-opacity", value=1)
    drawn, plane = axial(lungs)
    values = laid(second, plane, TURN)
    expected = grey(values, lungs, "second-")
    # where the slice of the first scan is, without marks on it
    first = SimpleITK.ReadImage(str(folder / "3DCT_lung_baseline.mha"))
    inside = np.isfinite(laid(first, plane, SimpleITK.Transform())) & np.isfinite(values)
    plain = inside & (np.ptp(drawn, axis=2) < 0.02)
    assert plain.mean() > 0.3
    off = np.abs(drawn[..., 1] - expected)[plain]
    assert np.median(off) < 2 / 255
    assert np.mean(off < 12 / 255) > 0.95
    # without its transform it is far off
    elsewhere = grey(laid(second, plane, SimpleITK.Transform()), lungs, "second-")
    assert np.nanmean(np.abs(drawn[..., 1] - elsewhere)[plain]) > 15 / 255

    # squares of both by turns: about half of the pixels are those of each
    lungs.do("choose", testid="second-fusion", value="checkerboard")
    squares, _ = axial(lungs)
    same = np.abs(squares - drawn).max(axis=2)[plain] < 2 / 255
    assert 0.3 < same.mean() < 0.9


def tissue(value: float, page: Browser) -> str:
    """What a value of the second scan stands for."""
    scan = page.read("window.palpate.second.scan")
    soft, bone = scan["soft_tissue"], scan["bone"]
    ends = {"air": -900, "lung": -250, "fat": -20, "fluid": 20, "soft tissue": bone}
    if scan["unit"] == "":
        ends = {"dark": 2 * soft - bone, "tissue": bone}
    last = "bright tissue" if scan["unit"] == "" else "bone"
    return next((name for name, end in ends.items() if value < end), last)


@pytest.mark.data
def test_a_click_says_the_values_of_both_scans(lungs: Browser, data_folder: Path) -> None:
    second = SimpleITK.ReadImage(str(data_folder / "elastix_lung_pair" / "3DCT_lung_followup.mha"))
    lungs.do("clickAt", testid="slice-axial", x=0.45, y=0.5)
    lungs.do("click", testid="picked-cross")
    there = TURN.TransformPoint(lungs.read("window.palpate.crosshair"))
    expected = second.GetPixel(second.TransformPhysicalPointToIndex(there))
    assert float(lungs.text("picked-second").removesuffix(" HU")) == pytest.approx(expected)
    assert lungs.text("picked-tissue") == f"Second scan: {tissue(expected, lungs)}"
    lungs.do("press", key="Escape")


@pytest.mark.data
def test_points_of_its_own_transfer_function_are_dragged_and_taken_back(lungs: Browser) -> None:
    lungs.do("choose", testid="second-preset", value="CT-Lung")
    lungs.do("choose", testid="second-fusion", value="blend")
    preset = lungs.picture(OUTPUT / "second_curve_preset.png")
    lungs.do("clickText", text="Curve of the second scan")
    is_same = "document.querySelector('[data-testid=second-curve-reset]').disabled"
    assert lungs.read(is_same)

    point = "document.querySelector('[data-testid=second-opacity-point-2]')"
    lungs.read(f"void {point}.scrollIntoView({{ block: 'center' }})")
    # its first tissue counts for much more, the first scan's for as much as before
    lungs.do("dragElement", testid="second-opacity-point-2", y=-40)
    lungs.wait(f"!{is_same}")
    denser = lungs.picture(OUTPUT / "second_curve_denser.png")
    # unchanged it differs by nothing at all
    assert np.abs(denser - preset).mean() > 1 / 255
    (kept,) = (
        part
        for name, part in lungs.read("window.palpate.kept").items()
        if name.startswith("second.")
    )
    assert kept["preset"] == "CT-Lung"
    assert len(kept["curve"]["opacities"]) >= 3

    # the drag is one step, and the button leads back as well
    lungs.do("press", key="Control+z")
    lungs.wait(is_same)
    np.testing.assert_allclose(lungs.picture(OUTPUT / "second_curve_undone.png"), preset, atol=0.01)
    lungs.do("press", key="Control+y")
    lungs.wait(f"!{is_same}")
    lungs.do("click", testid="second-curve-reset")
    lungs.wait(is_same)
    lungs.do("clickText", text="Curve of the second scan")


@pytest.mark.long
@pytest.mark.data
def test_the_engine_draws_both_as_the_browser_does(lungs: Browser) -> None:
    lungs.do("choose", testid="second-preset", value="CT-Lung")
    lungs.do("choose", testid="second-fusion", value="blend")
    lungs.do("choose", testid="second-tint", value="grey")
    lungs.do("slide", testid="second-opacity", value=0.6)
    # both light volumes have cells of their own, which a mode of grey does without; by turns pixels
    # on the sides of the cells may be those of the one scan or the other
    for fusion, mode, mean, within in (
        ("blend", "shaded", 1 / 255, 0.98),
        ("blend", "mip", 1 / 255, 0.999),
        ("checkerboard", "mip", 1 / 255, 0.998),
        ("checkerboard", "shaded", 1 / 255, 0.96),
        ("checkerboard", "iso", 2 / 255, 0.93),
    ):
        which = f"{fusion}_{mode}"
        lungs.do("choose", testid="second-fusion", value=fusion)
        lungs.draw_by("browser")
        lungs.do("choose", testid="blend", value=mode)
        browser_s = lungs.picture(OUTPUT / f"second_{which}_by_browser.png")
        lungs.draw_by("engine")
        assert lungs.read("window.palpate.drawer.obstacle") is None
        engine_s = lungs.picture(OUTPUT / f"second_{which}_by_engine.png")
        off = np.abs(engine_s - browser_s)
        assert off.mean() <= mean, which
        assert np.mean(off.max(axis=2) <= 8 / 255) >= within, which
        lungs.do("click", testid="second-view")
        alone = lungs.picture(OUTPUT / f"second_{which}_alone.png")
        lungs.do("click", testid="second-view")
        assert np.mean(np.abs(alone - engine_s).max(axis=2) > 8 / 255) > 0.05, which
    lungs.draw_by("browser")
    lungs.do("choose", testid="second-fusion", value="blend")
    lungs.do("choose", testid="blend", value="shaded")


@pytest.mark.long
@pytest.mark.data
def test_the_view_shows_it_too_and_follows_another_transform(lungs: Browser) -> None:
    lungs.do("choose", testid="second-preset", value="CT-Lung")
    lungs.do("choose", testid="second-fusion", value="blend")
    shown = lungs.picture(OUTPUT / "second_view.png")
    lungs.do("click", testid="second-view")
    without = lungs.picture(OUTPUT / "second_view_without.png")
    assert np.abs(shown - without).mean() > 0.5 / 255
    lungs.do("click", testid="second-view")
    # a switch that is taken back before the page is drawn again shows what is
    switch = "document.querySelector('[data-testid=second-view]')"
    undo = "new KeyboardEvent('keydown', { key: 'z', ctrlKey: true })"
    shown_at_once = lungs.read(
        f"({switch}.click(), window.dispatchEvent({undo}), {switch}.checked)"
    )
    assert not shown_at_once
    lungs.wait(f"{switch}.checked")
    # cells of one and the other are neither both at once nor the first alone
    lungs.do("choose", testid="second-fusion", value="checkerboard")
    lungs.do("slide", testid="second-square", value=60)
    cells = lungs.picture(OUTPUT / "second_view_cells.png")
    assert min(np.abs(cells - other).mean() for other in (shown, without)) > 0.3 / 255
    lungs.do("choose", testid="second-fusion", value="blend")
    lungs.finish()
    before, _ = axial(lungs)

    told = lungs.read("window.palpate.second")
    away = np.eye(4)
    away[:3, 3] = 1000.0
    message = msgspec.convert(
        {**told, "second_from_first": away.ravel().tolist()}, protocol.SecondScan
    )
    packed = list(protocol.encode_to_page(message))
    lungs.read(f"window.palpate.receive(new Uint8Array({packed}))")
    gone = lungs.picture(OUTPUT / "second_view_away.png")
    np.testing.assert_allclose(gone, without, atol=2 / 255)
    after, _ = axial(lungs)
    assert np.abs(after - before).mean() > 5 / 255


def tells_of_the_second(page: Browser, where: NDArray[np.bool_]) -> None:
    """A click where the second scan alone is seen tells which tissue of it that is."""
    page.finish()
    places = np.argwhere(where)
    middle = np.argmin(np.linalg.norm(places - places.mean(axis=0), axis=1))
    y, x = (places[middle] + 0.5) / where.shape
    page.do("clickAt", testid="canvas", x=float(x), y=float(y))
    assert page.text("picked-name") == "Outside of the first scan"
    value = float(page.text("picked-second").removesuffix(" HU"))
    assert page.text("picked-tissue") == f"Second scan: {tissue(value, page)}"
    page.do("press", key="Escape")


@pytest.mark.data
def test_a_page_takes_it_away_adds_it_moves_it_and_projects_it(
    lungs: Browser, data_folder: Path, tmp_path: Path
) -> None:
    lungs.do("click", testid="remove-second")
    lungs.wait("window.palpate.second === null")
    lungs.do("click", testid="add-second")
    path = data_folder / "elastix_lung_pair" / "3DCT_lung_followup.mha"
    lungs.do("fill", testid="open-path", text=str(path))
    lungs.do("click", testid="open-look")
    lungs.shows("second-name", "text === '3DCT_lung_followup'")
    assert lungs.read("window.palpate.second.is_moved") is False

    # half a scan beside the first: it is seen there too
    transform = tmp_path / "beside.tfm"
    shift = SimpleITK.TranslationTransform(3, (150.0, 0.0, 0.0))
    SimpleITK.WriteTransform(shift, str(transform))
    lungs.do("give", testid="second-transform-file", path=str(transform))
    lungs.wait("window.palpate.second?.is_moved === true")
    assert lungs.read("window.palpate.second.second_from_first")[3] == 150.0
    lungs.do("choose", testid="blend", value="mip")
    lungs.do("choose", testid="second-tint", value="warm")
    shown = lungs.picture(OUTPUT / "second_mip.png")
    lungs.do("click", testid="second-view")
    without = lungs.picture(OUTPUT / "second_mip_without.png")
    # where the first has nothing: warm colours on what was the ground
    beside = (np.ptp(without, axis=2) < 0.1) & (without.max(axis=2) < 0.15)
    warm = (shown[..., 0] - shown[..., 2] > 0.2) & beside
    assert warm.mean() > 0.01
    lungs.do("click", testid="second-view")

    tells_of_the_second(lungs, warm)

    # squares of the view by turns: the first alone, and the second in its colours
    lungs.do("choose", testid="second-fusion", value="checkerboard")
    lungs.do("slide", testid="second-square", value=40)
    squares = lungs.picture(OUTPUT / "second_mip_squares.png")
    both = (shown[..., 0] - shown[..., 2] > 0.2) & ~beside
    first = np.abs(squares - without).max(axis=2) < 3 / 255
    second = squares[..., 0] - squares[..., 2] > 0.2
    assert 0.25 < first[both].mean() < 0.75
    assert 0.25 < second[both].mean() < 0.75
    assert (first | second)[both].mean() > 0.9
    lungs.do("choose", testid="second-fusion", value="blend")
    lungs.do("choose", testid="blend", value="shaded")


def test_segments_of_the_second_scan_come_to_the_first(
    lungs: Browser, data_folder: Path, tmp_path: Path
) -> None:
    mask = data_folder / "elastix_lung_pair" / "3DCT_lung_followup_mask.mha"
    # where the second scan was laid beside the first, nothing of them meets it
    lungs.do("give", testid="second-segments-file", path=str(mask))
    lungs.wait("/none of 1 segments reaches/i.test(document.body.textContent)")
    assert lungs.read("document.querySelector('[data-testid=segment-2]')") is None

    transform = tmp_path / "turn.tfm"
    SimpleITK.WriteTransform(TURN, str(transform))
    lungs.do("give", testid="second-transform-file", path=str(transform))
    lungs.wait("Math.abs(window.palpate.second?.second_from_first[3]) < 149")
    lungs.do("give", testid="second-segments-file", path=str(mask))
    lungs.shows("segment-2", "/label 1/.test(text)")
