"""Where things are on the page: the start page, groups of controls, settings, the bottom bar."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from browser import ROOT, Browser, browser, palpate

pytestmark = pytest.mark.browser

OUTPUT = ROOT / "tests" / "output"
SIZE = {"width": 1366, "height": 768}
READY = "window.palpate?.ready === true"

FIRST_HOUR = {
    "scan": ("open-scan", "save-scene", "take-scissors"),
    "segments": ("segment-1", "threshold", "find-segments"),
    "view": ("preset-CT-Bone", "blend", "clip-box", "clip-add"),
    "marks": ("mark-distance", "mark-point"),
}
"""Controls that everybody needs, by their groups."""
AT_HAND = ("tool-drill", "force", "matter-1", "stiffness", "open-settings")
"""The same beside the groups."""


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """The demo, opened from the start page."""
    state = tmp_path_factory.mktemp("state")
    with palpate("open", state=state) as command, browser() as opened:
        opened.do("open", url=command.url, **SIZE)
        starts(opened)
        opened.do("click", testid="open-demo")
        opened.wait(READY, seconds=120.0)
        yield opened


def starts(page: Browser) -> None:
    """The start page says what this is, what it is not for, and what can be done."""
    words = page.text("open-page")
    assert "Palpate" in words
    assert "not for clinical use" in words
    assert "Drop a scan here" in words
    assert page.text("open-demo") == "Try the demo"
    assert page.do("axe")["value"] == []
    page.do("screenshot", path=str(OUTPUT / "start-page.png"))


def unseen(page: Browser, names: tuple[str, ...]) -> list[str]:
    """Returns those of some controls that are not wholly in sight."""
    found: list[str] = page.read(
        f"{list(names)}.filter((name) => {{ const e = "
        'document.querySelector(`[data-testid="${name}"]`); if (e === null) return true;'
        " const { x, y, right, bottom, width } = e.getBoundingClientRect();"
        " const top = document.elementFromPoint((x + right) / 2, (y + bottom) / 2);"
        " return width === 0 || bottom > innerHeight || right > innerWidth"
        " || !(e.contains(top) || top?.contains(e)); })"
    )
    return found


def test_all_of_the_first_hour_is_in_sight_without_scrolling(page: Browser) -> None:
    for group, names in FIRST_HOUR.items():
        page.do("click", testid=f"group-{group}")
        page.frames()
        assert unseen(page, names) == [], group
        page.do("screenshot", path=str(OUTPUT / f"panel-{group}.png"))
    assert unseen(page, AT_HAND) == []
    assert page.read("document.querySelector('[aria-label=\"Touch mode\"]') !== null")


def test_groups_are_chosen_by_arrows_and_remembered(page: Browser) -> None:
    page.do("click", testid="group-scan")
    page.do("press", key="ArrowRight")
    chosen = "document.querySelector('[role=tab][aria-selected=true]')"
    assert page.read(f"{chosen}.dataset.testid") == "group-segments"
    assert page.read(f"document.activeElement === {chosen}")
    assert page.read("JSON.parse(localStorage.getItem('palpate.group')).shown") == "segments"


def test_a_setting_is_found_by_another_word_for_it(page: Browser) -> None:
    page.do("press", key="Control+,")
    opened = "document.querySelector('[data-testid=settings]')?.open === true"
    page.wait(opened)
    assert page.read("document.activeElement.dataset.testid") == "settings-field"
    page.do("type", text="graphics card")
    shown = "[...document.querySelectorAll('.setting:not([hidden])')].map((e) => e.dataset.testid)"
    page.wait(f"{shown}.join() === 'setting-drawer'")
    page.do("screenshot", path=str(OUTPUT / "settings-found.png"))
    page.do("fill", testid="settings-field", text="mesh decimator")
    page.shows("no-setting", "text.includes('No setting matches. Try another word')")
    page.do("press", key="Escape")
    # nothing of it works on while it is closed
    page.wait("document.querySelector('[data-testid=settings]') === null")
    # the palette has each of them by its name
    page.do("press", key="Control+k")
    page.do("type", text="settings anaglyph")
    page.do("press", key="Enter")
    page.wait(f"{opened} && {shown}.join() === 'setting-stereo'")
    assert page.do("axe")["value"] == []
    page.do("press", key="Escape")
    page.wait("document.querySelector('[data-testid=settings]') === null")


def test_rates_are_under_diagnostics_and_who_draws_in_the_bar(page: Browser) -> None:
    assert page.text("drawn-by") == "engine"
    assert "servo" not in page.text("status").lower()
    with page.settings():
        assert float(page.text("servo-rate")) > 0
    # the button shows the choice
    page.do("click", testid="drawn-by")
    shown = "[...document.querySelectorAll('.setting:not([hidden])')].map((e) => e.dataset.testid)"
    page.wait(f"{shown}.join() === 'setting-drawer'")
    page.do("screenshot", path=str(OUTPUT / "settings-drawn-by.png"))
    page.do("press", key="Escape")
    page.wait("document.querySelector('[data-testid=settings]') === null")


def test_the_bar_says_what_the_pointer_stands_on_and_what_is_felt(page: Browser) -> None:
    canvas = "document.querySelector('[data-testid=canvas]')"
    box = page.read(f"{canvas}.getBoundingClientRect().toJSON()")
    page.do("point", x=box["x"] + box["width"] / 2, y=box["y"] + box["height"] / 2)
    page.shows("pointed", "/mm$/.test(text)")
    assert page.text("status-touch") == "off"
    page.do("press", key="t")
    page.shows("status-touch", "text === 'on'")
    page.do("press", key="Escape")
    page.do("point", x=5, y=5)
    page.wait("document.querySelector('[data-testid=pointed]') === null")


def test_tools_stay_at_hand_where_the_right_panel_is_hidden(page: Browser) -> None:
    page.read("document.querySelector('[aria-label=\"Touch panel\"]').click()")
    page.wait("document.querySelector('[data-testid=force]') === null")
    page.do("click", testid="tool-drill")
    page.wait("window.palpate.state.tool.kind === 'drill'")
    page.do("screenshot", path=str(OUTPUT / "tool-strip.png"))
    page.do("click", testid="tool-none")
    page.read("document.querySelector('[aria-label=\"Touch panel\"]').click()")
    page.wait("document.querySelector('[data-testid=force]') !== null")
