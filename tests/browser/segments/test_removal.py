"""What is in the way goes: the table, after a look at it, and all outside of the clip box."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import SimpleITK
from browser import ROOT, Browser, browser, palpate

pytestmark = pytest.mark.browser

OUTPUT = ROOT / "tests" / "output"
COUNT = "document.querySelectorAll('[data-testid^=\"visible-\"]').length"
BONE = (
    "Number(/([0-9\\s\u2009\u202f]+) voxels/.exec("
    "document.querySelector('[data-testid=segment-1] .size').textContent)[1].replace(/\\D/g, ''))"
)
"""Voxels of the first segment, as its card tells them."""
OPTIONS = ("--threshold", "300", "--unit", "HU", "--port", "0")


@pytest.fixture(scope="module")
def lying(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A body with a bone through it, on a table as dense as bone."""
    z, y, x = np.indices((32, 64, 64), sparse=True)
    values = np.full((32, 64, 64), -1000, np.int16)
    values[((x - 32) / 24.0) ** 2 + ((y - 24) / 14.0) ** 2 + 0.0 * z < 1.0] = 40
    values[:, 20:28, 28:36] = 800
    values[:, 46:48, 4:60] = 700
    path = tmp_path_factory.mktemp("lying") / "lying.mha"
    image = SimpleITK.GetImageFromArray(values)
    image.SetSpacing((3.0, 3.0, 3.0))
    SimpleITK.WriteImage(image, str(path))
    return path


@pytest.fixture(scope="module")
def page(lying: Path) -> Iterator[Browser]:
    with palpate("open", lying, *OPTIONS) as command, browser() as opened:
        assert opened.do("open", url=command.url, width=1366, height=768)["firstPicture"]
        yield opened
        assert opened.complaints == []


def test_a_table_is_shown_before_it_goes_and_one_undo_brings_it_back(page: Browser) -> None:
    both = page.read(BONE)
    page.do("click", testid="find-table")
    page.shows("table-bar", "text.includes('Table')")
    page.wait(f"{COUNT} === 2")
    page.picture(OUTPUT / "removal-table.png")
    assert page.read(BONE) == both
    page.do("click", testid="table-keep")
    page.wait(f"{COUNT} === 1")

    page.do("click", testid="find-table")
    page.shows("table-bar", "text.includes('Table')")
    page.do("click", testid="table-remove")
    page.wait(f"{COUNT} === 1 && {BONE} === {32 * 8 * 8}")
    page.picture(OUTPUT / "removal-gone.png")
    page.do("press", key="Control+z")
    page.wait(f"{COUNT} === 2 && {BONE} === {both}")
    page.do("press", key="Control+z")
    page.wait(f"{COUNT} === 1")


def test_a_table_that_is_there_is_suggested_once_and_goes_in_one_step(page: Browser) -> None:
    url = page.read("location.href")
    # a page that a program drives is not asked, unless it says so
    asked = "window.palpate.keep('table', {asked: false})"
    page.read(asked)
    page.all_done()
    page.do("open", url=url, width=1366, height=768)
    page.shows("table-suggested", "text.includes('This scan shows a table. Remove it?')")
    page.do("screenshot", path=str(OUTPUT / "removal-suggested.png"))
    both = page.read(BONE)
    page.do("click", testid="suggested-remove")
    page.wait(f"{COUNT} === 1 && {BONE} === {32 * 8 * 8}")
    assert page.read("document.querySelector('[data-testid=table-suggested]') === null")
    page.do("press", key="Control+z")
    page.wait(f"{BONE} === {both}")

    page.read(asked)
    page.all_done()
    page.do("open", url=url, width=1366, height=768)
    page.shows("table-suggested", "true")
    page.do("click", testid="suggested-keep")
    page.wait("document.querySelector('[data-testid=table-suggested]') === null")
    assert page.read("window.palpate.kept.table.asked") is True
    assert page.read(BONE) == both


def test_the_scan_is_cropped_to_the_box_and_undo_brings_it_back(page: Browser) -> None:
    whole = page.read(BONE)
    page.do("click", testid="clip-box")
    page.do("slide", testid="clip-S", value=48.0)
    page.do("click", testid="clip-crop")
    page.wait(f"{BONE} === {whole // 2}")
    page.do("press", key="Control+z")
    page.wait(f"{BONE} === {whole}")


def test_scissors_show_what_a_loop_takes_and_undo_brings_it_back(page: Browser) -> None:
    whole = page.read(BONE)
    loop = [[-90, -60], [90, -60], [90, 60], [-90, 60], [-90, -60]]
    page.read("window.palpate.setView('A')")
    page.do("click", testid="take-scissors")
    page.shows("scissors-says", "text.includes('Draw a loop')")
    before = page.read("window.palpate.camera")
    page.do("paintLine", points=loop)
    page.shows("scissors-says", "/Remove .* inside the loop/.test(text)")
    page.wait(f"{COUNT} === 2")
    page.finish()
    page.do("screenshot", path=str(OUTPUT / "scissors.png"))
    # the loop neither turns the picture nor changes anything yet
    assert page.read("window.palpate.camera") == before
    assert page.read(BONE) == whole
    through = page.text("scissors-says")

    page.do("choose", testid="scissors-depth", value="surface")
    page.shows("scissors-says", f"/Remove/.test(text) && text !== {through!r}")
    page.do("choose", testid="scissors-target", value="1")
    page.do("choose", testid="scissors-side", value="outside")
    page.do("choose", testid="scissors-depth", value="through")
    page.shows("scissors-says", "/Remove .* outside of the loop/.test(text)")
    page.do("press", key="Escape")
    page.wait(f"{COUNT} === 1")
    assert page.read(BONE) == whole

    page.do("click", testid="take-scissors")
    page.do("choose", testid="scissors-side", value="inside")
    page.do("choose", testid="scissors-target", value="")
    page.do("paintLine", points=loop)
    page.shows("scissors-says", "/Remove .* inside the loop/.test(text)")
    goes = page.text("scissors-says").removesuffix(" inside the loop, in red")
    # a page that is loaded anew knows no loop, but what would go, and has it go
    page.read("void (window.__before = true, window.location.reload())")
    page.wait("window.__before === undefined && window.palpate?.ready === true")
    page.shows("scissors-says", f"text === {goes + ', in red'!r}")
    page.finish()
    page.do("screenshot", path=str(OUTPUT / "scissors-again.png"))
    page.do("click", testid="scissors-remove")
    page.wait(f"{COUNT} === 1 && {BONE} < {whole} && {BONE} > 0")
    page.do("screenshot", path=str(OUTPUT / "scissors-gone.png"))
    page.do("press", key="Control+z")
    page.wait(f"{BONE} === {whole}")


def test_a_segment_is_taken_out_of_the_scan_and_undo_brings_it_back(page: Browser) -> None:
    page.do("clickText", text="Change shape")
    page.do("click", testid="take-out")
    page.wait(f"{COUNT} === 0")
    page.picture(OUTPUT / "removal-taken-out.png")
    page.do("press", key="Control+z")
    page.wait(f"{COUNT} === 1")
