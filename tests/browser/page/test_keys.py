"""Keys in a real browser, as keyboards of several layouts send them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import Browser, browser, palpate

pytestmark = pytest.mark.browser

BACK = "window.palpate.camera.back"
TOUCH = "document.querySelector('[data-testid=hint]').textContent.includes('Esc leaves')"


@pytest.fixture(scope="module")
def opened(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """A small block of bone on the page."""
    import SimpleITK

    values = np.full((24, 24, 24), -1000, np.int16)
    values[6:18, 6:18, 6:18] = 1000
    path: Path = tmp_path_factory.mktemp("keys") / "block.mha"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(path))
    with palpate("open", path, "--threshold", "500", "--unit", "HU") as command, browser() as page:
        assert page.do("open", url=command.url, width=1200, height=640)["firstPicture"] is not None
        yield page


@pytest.fixture
def page(opened: Browser) -> Iterator[Browser]:
    """The page, seen from before and out of touch mode."""
    opened.read("window.palpate.setView('A')")
    yield opened
    opened.do("press", key="Escape")
    assert opened.complaints == []


def key(page: Browser, key: str, code: str, **held: Any) -> None:
    page.do("key", key=key, code=code, **held)
    page.frames()


@pytest.mark.parametrize(
    ("written", "place"),
    [
        *[("\u0435", "KeyT"), ("\u03c4", "KeyT"), ("\u05d0", "KeyT"), ("t", "KeyK")],
        # Korean, with and without what puts syllables together
        *[("\u3145", "KeyT"), ("Process", "KeyT")],
    ],
)
def test_a_letter_is_the_latin_one_on_the_key_or_at_its_place(
    page: Browser, written: str, place: str
) -> None:
    assert not page.read(TOUCH)
    key(page, written, place)
    assert page.read(TOUCH)


def test_undo_is_at_its_place_on_a_keyboard_without_latin_letters(page: Browser) -> None:
    page.do("press", key="b")
    page.do("press", key="j")
    page.wait("window.palpate.marks.length === 1")
    key(page, "\u044f", "KeyZ", control=True)
    page.wait("window.palpate.marks.length === 0")


@pytest.mark.parametrize("pressed", [{"key": "&"}, {"key": "1", "shift": True}, {"key": "+"}])
def test_digits_are_those_of_their_places(page: Browser, pressed: dict[str, Any]) -> None:
    page.read("window.palpate.setView('L')")
    page.frames()
    before = page.read(BACK)
    key(page, code="Digit1", **pressed)
    after = page.read(BACK)
    page.do("press", key="1")
    page.frames()
    assert after == page.read(BACK)
    assert after != before


def test_with_alt_a_letter_does_nothing(page: Browser) -> None:
    key(page, "t", "KeyT", alt=True)
    key(page, "\u2020", "KeyT", alt=True)
    assert not page.read(TOUCH)


def test_a_key_that_is_held_acts_once(page: Browser) -> None:
    key(page, "t", "KeyT", repeats=7)
    assert page.read(TOUCH)


def test_a_mark_and_a_saved_scene_come_once_a_press_and_also_from_a_field(page: Browser) -> None:
    page.do("press", key="b")
    key(page, "j", "KeyJ", repeats=7)
    page.all_done()
    assert page.read("window.palpate.marks.length") == 1
    page.do("click", testid="threshold")
    saved = page.do("requests", about="/api/scene")["value"]
    key(page, "s", "KeyS", control=True, repeats=7)
    page.wait("document.querySelector('.notices').textContent.includes('Saved as ')")
    assert page.do("requests", about="/api/scene")["value"] == saved + 1
    page.read("document.activeElement.blur()")
    page.do("press", key="Control+z")
    page.wait("window.palpate.marks.length === 0")


def test_the_keys_of_the_page_work_in_a_field_and_what_was_typed_there_holds(page: Browser) -> None:
    page.do("click", testid="threshold")
    page.read("document.querySelector('[data-testid=threshold]').select()")
    page.do("type", text="700")
    page.do("press", key="Control+k")
    page.wait("document.querySelector('[data-testid=palette]') !== null")
    page.do("press", key="Escape")
    page.wait("document.querySelector('[data-testid=palette]') === null")
    page.all_done()
    assert page.read("document.querySelector('[data-testid=threshold]').value") == "700"
    page.read("document.activeElement.blur()")
    page.do("press", key="Control+z")
    page.all_done()
    assert page.read("document.querySelector('[data-testid=threshold]').value") == "500"
