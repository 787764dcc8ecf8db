"""Paper, systems that paint in their own colours, and pages enlarged to twice their size."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from browser import ROOT, Browser, browser, palpate

pytestmark = [pytest.mark.browser, pytest.mark.data]

OUTPUT = ROOT / "tests" / "output"
TOOLS = ("none", "eraser", "adder", "painter", "drill", "needle")
"""By their test ids: each is a button of the panel."""


@pytest.fixture(scope="module")
def page(data_folder: Path) -> Iterator[Browser]:
    """A page of a head."""
    head = data_folder / "cthead_stanford" / "CThead.mha"
    with palpate("open", head, "--threshold", "1350") as command, browser() as opened:
        opened.do("open", url=command.url, width=1366, height=768)
        opened.finish()
        yield opened


def element(testid: str) -> str:
    """Returns the expression of an element."""
    return f"document.querySelector('[data-testid={testid}]')"


def ground(page: Browser, testid: str) -> str:
    """Returns the colour behind an element."""
    return str(page.read(ground_of(testid)))


def ground_of(testid: str) -> str:
    """Returns what gives the colour behind an element in the page."""
    return f"getComputedStyle({element(testid)}).backgroundColor"


def test_the_picture_is_printed_in_its_own_proportions(page: Browser) -> None:
    width, height = page.read(
        "(({ clientWidth, clientHeight }) => [clientWidth, clientHeight])"
        "(document.querySelector('main canvas'))"
    )
    page.do("media", media="print")
    page.do("resize", width=700, height=990)
    page.read("void window.dispatchEvent(new Event('beforeprint'))")
    printed = page.read(
        f"(({{ width, height }}) => [width, height])"
        f"({element('print-page')}.querySelector('canvas').getBoundingClientRect())"
    )
    page.do("screenshot", path=str(OUTPUT / "screens-print.png"))
    assert page.read("getComputedStyle(document.querySelector('.workspace')).display") == "none"
    page.do("media", media=None)
    page.do("resize", width=1366, height=768)
    assert printed[0] > 300
    assert printed[0] / printed[1] == pytest.approx(width / height, rel=0.01)
    page.finish()


def test_what_is_pressed_and_switched_on_is_seen_in_colours_of_the_system(page: Browser) -> None:
    page.do("media", forcedColors="active")
    page.do("screenshot", path=str(OUTPUT / "screens-forced-colours.png"))
    assert ground(page, "tool-none") != ground(page, "tool-drill"), "the tool in the hand"
    is_on = f"{element('show-path')}.checked"
    with page.settings():
        before = ground(page, "show-path")
        assert page.read(is_on) is False
        page.do("click", testid="show-path")
        page.wait(f"{is_on} === true")
        # its colour passes over to the other one
        page.wait(f"{ground_of('show-path')} !== '{before}'")
        page.do("click", testid="show-path")
        page.wait(f"{is_on} === false")
    lamp = f"getComputedStyle({element('light')}.querySelector('.lamp')).backgroundColor"
    assert page.read(lamp) != page.read("getComputedStyle(document.body).backgroundColor")
    page.do("media", forcedColors=None)


def test_enlarged_to_twice_its_size_the_page_has_all_panels_and_tools(page: Browser) -> None:
    # closed, the right panel leaves a strip of tools, which is an aside too
    left = "document.querySelector('.workspace:not(.no-left)') !== null"
    right = "document.querySelector('.workspace:not(.no-right)') !== null"
    assert page.read(f"{left} && {right}")
    page.do("resize", width=683, height=384)
    page.wait(f"!({left} && {right})")
    if not page.read(right):
        page.read("[...document.querySelectorAll('header button')].at(-1).click()")
        page.wait(right)
    seen, cut = page.read(
        "(() => { const tools = [...document.querySelectorAll('aside.right [data-testid^=tool-]')];"
        " const boxes = tools.map((tool) => { tool.scrollIntoView({ block: 'nearest' });"
        " return tool.getBoundingClientRect(); }).filter(({ width }) => width > 0);"
        " const cut = boxes.filter(({ left, right }) => left < 0 || right > window.innerWidth);"
        " return [boxes.length, cut.length]; })()"
    )
    assert seen >= len(TOOLS)
    assert cut == 0
    page.do("screenshot", path=str(OUTPUT / "screens-zoomed-tools.png"))
    page.read("document.querySelector('header button').click()")
    page.wait(left)
    page.do("screenshot", path=str(OUTPUT / "screens-zoomed-left.png"))
    page.do("resize", width=1366, height=768)
    page.wait(f"{left} && {right}")


def test_the_page_is_as_tall_as_its_window(page: Browser) -> None:
    tall = "document.documentElement.scrollHeight === window.innerHeight"
    assert page.read(tall)


def test_on_a_phone_the_picture_has_the_whole_width_and_panels_lie_below(page: Browser) -> None:
    canvas = "document.querySelector('main canvas').getBoundingClientRect()"
    panel = "document.querySelector('aside.right').getBoundingClientRect()"
    toggles = "[...document.querySelectorAll('header button')]"
    page.do("resize", width=480, height=800)
    page.wait("document.querySelectorAll('aside').length === 1")
    page.wait(f"{canvas}.width === 480")
    assert page.read(f"{panel}.top >= {canvas}.bottom && {panel}.bottom <= 800")
    assert page.read(f"{canvas}.height > 250 && {panel}.width === 480")
    page.do("screenshot", path=str(OUTPUT / "screens-phone-tools.png"))
    # closed, its tools are a strip in one row; the other one comes in its place
    page.read(f"{toggles}.at(-1).click()")
    page.wait(f"{panel}.height < 60 && {canvas}.height > 600")
    strip = "[...document.querySelectorAll('aside.right [data-testid^=tool-]')]"
    tops = page.read(f"{strip}.map((tool) => tool.getBoundingClientRect().top)")
    assert (len(tops), len(set(tops))) == (len(TOOLS), 1)
    page.read(f"{toggles}[0].click()")
    page.wait("document.querySelector('aside.left') !== null")
    left = "document.querySelector('aside.left').getBoundingClientRect()"
    assert page.read(f"{left}.width === 480 && {left}.top >= {canvas}.bottom")
    page.do("screenshot", path=str(OUTPUT / "screens-phone-scan.png"))
    page.read(f"{toggles}.at(-1).click()")
    page.do("resize", width=1366, height=768)
    page.wait("document.querySelectorAll('aside').length === 2")
    page.wait(f"{panel}.width > 200")


def test_the_whole_name_of_a_segment_is_its_tooltip(page: Browser) -> None:
    name = "document.querySelector('li[data-testid=segment-1] .name')"
    assert page.read(f"{name}.title") == page.read(
        f"{name}.querySelector('.whole').textContent.trim()"
    )
