"""A scan of 255 segments: all of them are hidden, shown and brought back at once."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
import SimpleITK
from browser import ROOT, Browser, browser, palpate

pytestmark = pytest.mark.browser

OUTPUT = ROOT / "tests" / "output"
COUNT = 255
SEEN = (
    "[...document.querySelectorAll('[data-testid^=visible-]')]"
    ".filter((eye) => eye.getAttribute('aria-pressed') === 'true').length"
)
FELT = "window.palpate.segments.filter(({ felt }) => felt).length"
LABEL = "window.palpate.labelAt([5.5, 5.5, 8.5])"


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """A page of a block with 255 columns in it."""
    folder = tmp_path_factory.mktemp("many")
    values = np.full((16, 68, 68), 40, np.int16)
    values[4:12] = 1000
    labels = np.zeros(values.shape, np.uint8)
    for number in range(1, COUNT + 1):
        row, column = divmod(number - 1, 16)
        labels[4:12, 4 * row + 3 : 4 * row + 6, 4 * column + 3 : 4 * column + 6] = number
    scan, map_of_labels = folder / "block.nii.gz", folder / "labels.nii.gz"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(scan))
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(labels), str(map_of_labels))
    with (
        palpate("open", scan, "--unit", "HU", "--segments", map_of_labels) as command,
        browser() as opened,
    ):
        opened.do("open", url=command.url, width=1366, height=768)
        opened.all_done()
        yield opened


def test_all_are_hidden_shown_and_brought_back_at_once(page: Browser) -> None:
    page.wait(f"{SEEN} === {COUNT} && {FELT} === {COUNT} && {LABEL} === 1")
    before = page.do("requests", about="/api/labels")["value"]
    page.do("click", testid="all-visible")
    page.all_done()
    page.wait(f"{SEEN} === 0")
    page.wait(f"{FELT} === 0")
    page.wait(f"{LABEL} === 0")
    assert page.do("requests", about="/api/labels")["value"] == before, "nothing is to be fetched"

    page.do("click", testid="all-visible")
    page.all_done()
    page.wait(f"{SEEN} === {COUNT}")
    page.wait(f"{FELT} === {COUNT}")
    page.wait(f"{LABEL} === 1")
    assert page.do("requests", about="/api/labels")["value"] == before, "the map is here already"

    # each was one step
    page.do("press", key="Control+z")
    page.all_done()
    page.wait(f"{SEEN} === 0")
    page.do("press", key="Control+z")
    page.all_done()
    page.wait(f"{SEEN} === {COUNT}")
    assert page.read("document.querySelector('[aria-label=Undo]').disabled")
    page.wait(f"{LABEL} === 1")
    assert page.do("requests", about="/api/labels")["value"] == before
    page.do("screenshot", path=str(OUTPUT / "many-segments.png"))
    assert page.complaints == []


def test_a_name_has_the_room_that_it_needs_and_of_a_long_one_the_end_is_seen(page: Browser) -> None:
    row = "document.querySelector('[data-testid=segment-201]')"
    page.read(f"{row}.scrollIntoView()")
    is_whole = "(({ scrollWidth, clientWidth }) => scrollWidth === clientWidth)"
    assert page.read(f"{is_whole}({row}.querySelector('.name .one-line'))"), "its number tells it"

    page.read(f"{row}.querySelector('.name').click()")
    field = f"{row}.querySelector('input[type=text]')"
    page.wait(f"{field} !== null")
    page.read(f"{field}.value = 'common_carotid_artery_left'")
    page.read(f"{field}.dispatchEvent(new Event('change', {{ bubbles: true }}))")
    page.wait("window.palpate.segments[200].name === 'common_carotid_artery_left'")
    long = f"{row}.querySelector('.name [role=img]')"
    start, end = f"{long}.firstElementChild", f"{long}.lastElementChild"
    page.wait(f"{end}.textContent === '_left'")
    assert not page.read(f"{is_whole}({start})")
    assert page.read(f"{end}.getBoundingClientRect().right <= {row}.getBoundingClientRect().right")
    page.do("screenshot", path=str(OUTPUT / "many-segments-names.png"))
    page.do("press", key="Control+z")
    page.wait("window.palpate.segments[200].name === 'label 201'")
    page.read(f"{row}.querySelector('.name').click()")


def test_a_segment_that_is_opened_is_softened_by_the_next_click(page: Browser) -> None:
    soften = "document.querySelector('[data-testid=soften-200]')"
    # so many are not listed by themselves
    assert page.read(f"{soften} === null")
    page.read("document.querySelector('[data-testid=group-segments]').click()")
    page.read("document.querySelector('[data-testid=segment-200] .name').click()")
    page.wait(f"{soften} !== null")
    page.read("document.querySelector('[data-testid=segment-201] .name').click()")
    page.wait(f"{soften} === null")
    # one can also be chosen from a list beside it, and stays
    page.do("choose", testid="matter-more", value="200")
    page.wait(f"{soften} !== null")
    page.do("click", testid="soften-201")
    page.do("click", testid="tissue-201-liver")
    page.wait("window.palpate.segments[200].material?.preset === 'liver'")
    page.wait("window.palpate.state.matter.model === 'lattice'")
    page.do("screenshot", path=str(OUTPUT / "many-segments-tissue.png"))
    page.do("press", key="Control+z")
    page.wait("window.palpate.segments[200].material === null")
    page.do("click", testid="reset-matter")
    page.wait("window.palpate.state.matter.model === null")
    assert page.complaints == []


def test_one_is_hidden_and_shown_again_without_fetching_labels(page: Browser) -> None:
    page.wait(f"{SEEN} === {COUNT} && {LABEL} === 1")
    before = page.do("requests", about="/api/labels")["value"]
    version = page.read("window.palpate.labelsVersion")
    for shown in (COUNT - 1, COUNT):
        page.do("click", testid="visible-1")
        page.all_done()
        page.wait(f"{SEEN} === {shown} && {LABEL} === {1 if shown == COUNT else 0}")
    assert page.read("window.palpate.labelsVersion") == version, "segments that lie apart"
    assert page.do("requests", about="/api/labels")["value"] == before
    assert page.complaints == []
