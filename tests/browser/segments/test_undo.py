"""Undo of all that a person changes on the page, on a real scan in a real browser.

The oracle is what the page showed before each gesture.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from browser import ROOT, Browser, browser, palpate

pytestmark = [pytest.mark.browser, pytest.mark.data]

OUTPUT = ROOT / "tests" / "output"
BONE = 1350
SHOWN = (
    *("colour-1", "visible-1", "visible-2", "shown-as-surface", "shown-as-both"),
    *("surface-opacity", "blend", "preset", "curve-shift", "curve-scale", "light-specular"),
    *("picture-window", "picture-level", "window-width", "window-level"),
)
"""Controls that tell how segments, volume and slices look."""
READ = """(() => {
  const told = (each) => {
    if (each === null) return null;
    if (each.type === "radio") return each.checked;
    return each.value || each.ariaPressed || each.textContent.trim();
  };
  const names = %s;
  const all = names.map((name) => [name, told(document.querySelector(`[data-testid=${name}]`))]);
  return Object.fromEntries(all);
})()"""


def shown(page: Browser) -> dict[str, Any]:
    """Returns what the controls say, once the engine has done all that was asked for."""
    page.all_done()
    page.frames()
    found: dict[str, Any] = page.read(READ % list(SHOWN))
    return found


def kept(page: Browser, name: str) -> Any:
    """Returns what is kept with the scan."""
    return page.read(f"window.palpate.kept[{name!r}] ?? null")


@pytest.fixture(scope="module")
def page(data_folder: Path) -> Iterator[Browser]:
    """A head, its bone as a segment, in four panes."""
    scan = data_folder / "cthead_stanford" / "CThead.mha"
    with palpate("open", scan, "--threshold", str(BONE)) as command, browser() as page:
        opening = page.do("open", url=command.url, width=1366, height=768)
        assert opening["firstPicture"] is not None
        page.do("click", testid="layout-four")
        page.wait("window.palpate.slices.length === 3")
        yield page
        assert page.complaints == []


def colour(page: Browser) -> None:
    """Another colour of the bone, as the browser's chooser gives it."""
    page.do("fill", testid="colour-1", text="#20c040")


def edit(page: Browser) -> None:
    """Makes another segment: this step is the engine's."""
    page.do("clickText", text="Add a segment by threshold")
    page.wait("document.querySelector('[data-testid=visible-2]') !== null")


def preset(page: Browser) -> None:
    """A transfer function of the list."""
    page.do("click", testid="preset")
    page.do("click", testid="preset-CT-Bone")


GESTURES: dict[str, Callable[[Browser], Any]] = {
    "colour": colour,
    "drawn as a surface": lambda page: page.do("click", testid="shown-as-surface"),
    "opacity": lambda page: page.do("slide", testid="surface-opacity", value=0.4),
    "hidden": lambda page: page.do("click", testid="visible-1"),
    "an edit": edit,
    "all as both": lambda page: page.do("click", testid="all-as-both"),
    "mode": lambda page: page.do("choose", testid="blend", value="composite"),
    "preset": preset,
    "shift and scale": lambda page: page.do("altDrag", x=40, y=25),
    "light": lambda page: page.do("slide", testid="light-specular", value=2.5),
    "another mode": lambda page: page.do("choose", testid="blend", value="mip"),
    "window of the picture": lambda page: page.do("slide", testid="picture-window", value=900),
    "window of slices": lambda page: page.do("slide", testid="window-width", value=700),
    "a drag in a slice": lambda page: page.do(
        "dragElement", testid="slice-axial", x=30, y=20, button="right"
    ),
    "all seen": lambda page: page.do("click", testid="all-visible"),
}
"""In their order: each of these is one step."""


def test_all_that_was_changed_comes_back_in_turn_and_again(page: Browser) -> None:
    page.do("clickText", text="Lighting")
    states = [shown(page)]
    for name, gesture in GESTURES.items():
        gesture(page)
        states.append(shown(page))
        assert states[-1] != states[-2], name
    page.do("screenshot", path=str(OUTPUT / "undo_changed.png"))
    assert kept(page, "optics")["blend"] == "mip"
    assert "visibility of segments" in page.read(
        "document.querySelector('[aria-label=Undo]').title"
    )

    for name, before in zip(reversed(GESTURES), reversed(states[:-1]), strict=True):
        page.do("press", key="Control+z")
        assert shown(page) == before, f"undo: {name}"
    assert page.read("document.querySelector('[aria-label=Undo]').disabled")
    assert kept(page, "optics")["blend"] == "shaded"
    assert kept(page, "curve")["curve"] is None
    assert kept(page, "window")["window"] == pytest.approx(float(states[0]["window-width"]), abs=1)

    for name, after in zip(GESTURES, states[1:], strict=True):
        page.do("press", key="Control+Shift+z")
        assert shown(page) == after, f"redo: {name}"
    assert page.read("document.querySelector('[aria-label=Redo]').disabled")


def test_a_name_that_was_typed_comes_back_where_it_holds(page: Browser) -> None:
    text = "document.querySelector('[data-testid=segment-1] input[type=text]')"
    # a newer segment is open
    page.read("document.querySelector('[data-testid=segment-1]:not(.open) .name')?.click()")
    page.frames()
    page.read(f"{text}.focus()")
    page.do("press", key="Control+a")
    page.do("type", text="Skull")
    page.do("press", key="Enter")
    row = "document.querySelector('[data-testid=segment-1] button.name').textContent"
    page.wait(f"{row}.includes('Skull')")
    page.do("press", key="Control+z")
    page.wait(f"!{row}.includes('Skull')")
