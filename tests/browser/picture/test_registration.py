"""Registration on the page in a real browser: a head brought to a moved copy of itself.

The oracle is the transform by which SimpleITK has moved the copy.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK
from browser import ROOT, Browser, browser, palpate

pytestmark = pytest.mark.browser

OUTPUT = ROOT / "tests" / "output"
SHRINK = (3, 3, 3)
PLACES = np.array([[120.0, 120, 100], [70, 120, 140], [170, 100, 60], [120, 190, 90]])
"""In the head [mm]."""
TOLD = "window.palpate.registration"
SHIFT = "window.palpate.second.second_from_first[3]"
CURVE = "[data-testid=registration-curve]"
BAR = "document.querySelector('[data-testid=pair-bar]')"


def moved(head: Any) -> tuple[Any, Any]:
    """A copy of the head that lies turned and shifted, and where points of the head lie in it."""
    centre = head.TransformContinuousIndexToPhysicalPoint([n / 2 for n in head.GetSize()])
    turn = SimpleITK.Euler3DTransform(centre, 0.06, -0.04, 0.12, (9.0, -7.0, 5.0))
    back = turn.GetInverse()
    copy = SimpleITK.Resample(head, head, back, SimpleITK.sitkLinear, 0.0, SimpleITK.sitkInt16)
    return copy, turn


@pytest.fixture(scope="module")
def heads(
    data_folder: Path, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[tuple[Browser, Any]]:
    """A coarse head with its moved copy, and how it was moved."""
    folder = tmp_path_factory.mktemp("heads")
    whole = SimpleITK.ReadImage(str(data_folder / "cthead_stanford" / "CThead.mha"))
    head = SimpleITK.Cast(SimpleITK.BinShrink(whole, SHRINK), SimpleITK.sitkInt16)
    copy, turn = moved(head)
    for image, name in ((head, "head.mha"), (copy, "copy.mha")):
        SimpleITK.WriteImage(image, str(folder / name))
    with (
        palpate("open", folder / "head.mha", "--with", folder / "copy.mha") as command,
        browser() as page,
    ):
        assert page.do("open", url=command.url, width=1366, height=768)["firstPicture"] is not None
        yield page, turn


def errors(page: Browser, turn: Any) -> Any:
    """How far places of the head are from where the copy has them, as it stands now [mm]."""
    matrix = np.reshape(page.read("window.palpate.second.second_from_first"), (4, 4))
    there = [turn.TransformPoint(place.tolist()) for place in PLACES]
    return np.linalg.norm(PLACES @ matrix[:3, :3].T + matrix[:3, 3] - there, axis=1)


@pytest.mark.data
def test_the_page_finds_how_a_head_was_moved(heads: tuple[Browser, Any], tmp_path: Path) -> None:
    page, turn = heads
    assert errors(page, turn).min() > 5.0
    page.do("click", testid="compare-checkerboard")
    page.wait("window.palpate.slices.length === 3")
    page.do("choose", testid="registration-metric", value="correlation")
    page.do("click", testid="register")
    page.wait(f"{TOLD}.doing === null && {TOLD}.steps === 1", seconds=240)
    assert page.read(f"{TOLD}.failure") is None
    page.wait(f"{SHIFT} !== 0")
    assert errors(page, turn).max() < 1.0
    assert "Correlation" in page.text("registration-found")
    assert int(page.read(f"document.querySelector('{CURVE}').dataset.steps")) > 10
    page.finish()
    page.do("screenshot", path=str(OUTPUT / "registration.png"))

    # before and after, undo and redo
    page.do("click", testid="registration-before")
    page.wait(f"{SHIFT} === 0")
    page.do("click", testid="registration-after")
    page.wait(f"{SHIFT} !== 0")
    page.do("press", key="Control+z")
    page.wait(f"{TOLD}.steps === 0 && {SHIFT} === 0")
    page.do("press", key="Control+y")
    page.wait(f"{TOLD}.steps === 1 && {SHIFT} !== 0")

    path = tmp_path / "saved.tfm"
    page.do("clickText", text="Keep the result")
    page.do("download", testid="save-transform", path=str(path))
    saved = SimpleITK.ReadTransform(str(path))
    apart = [
        np.subtract(saved.TransformPoint(place), turn.TransformPoint(place))
        for place in PLACES.tolist()
    ]
    assert np.linalg.norm(apart, axis=1).max() < 1.0
    assert page.complaints == []


@pytest.mark.data
def test_pairs_are_set_by_clicks_in_slices(heads: tuple[Browser, Any]) -> None:
    page, _ = heads
    page.do("choose", testid="registration-start", value="landmarks")
    page.do("click", testid="pair-add")
    page.shows("pair-bar", "text.includes('first scan')")
    page.finish()
    page.do("screenshot", path=str(OUTPUT / "registration_pairs.png"))
    for pane, x, y in (("axial", 0.45, 0.4), ("axial", 0.6, 0.6), ("coronal", 0.5, 0.35)):
        page.do("clickAt", testid=f"slice-{pane}", x=x, y=y)
        page.shows("pair-bar", "text.includes('second scan')")
        # the same place of the screen: as the scan stands now, both points lie together
        page.do("clickAt", testid=f"slice-{pane}", x=x + 0.02, y=y)
        page.wait(f"{BAR}?.textContent.includes('second scan') !== true")
    page.wait(f"{BAR} === null")
    apart = float(page.text("pair-2").removeprefix("Pair 3").split()[0])
    assert 0.5 < apart < 20.0
    assert page.read("document.querySelector('[data-testid=register]').disabled") is False
    page.do("screenshot", path=str(OUTPUT / "registration_pairs_set.png"))
