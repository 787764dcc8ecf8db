"""The page in another language: every text of it stands in the catalogue, a language is a file.

The language en-XA is made of the catalogue when the page is built, as a real one is of its file:
each text stands in brackets. What is seen outside of brackets is in no catalogue.
"""

from __future__ import annotations

import json
from collections.abc import Iterator

import pytest
from browser import ROOT, Browser, browser, palpate

pytestmark = pytest.mark.browser

OUTPUT = ROOT / "tests" / "output"
SIZE = {"width": 1366, "height": 768}

TOLD_BY_THE_ENGINE = ", ".join(
    (
        # names of the scan, of segments, tissues, models and presets, and where they come from
        "[data-testid=whose-scan], [data-testid=status] > :first-child, .left p.name",
        "[data-testid^=segment-] .text, [data-testid^=segment-] input, [data-testid=gap-to] option",
        "[data-testid^=matter-] .name, [data-testid^=material-] option, [data-testid^=tissue-]",
        "[data-testid=deformation] option, [data-testid=threshold-preset] option",
        "[data-testid^=preset-], [data-testid^=needle-tissue-]",
        "[data-testid=statistics-table] th[scope=row]",
    )
)
KEYS = "kbd, dt"
UNITS = r"mm|cm|ml|HU|MiB|GiB|ms|Hz|kHz|mJ|mW|kPa|MPa|GPa|N\/mm|N·s\/mm|px|N"
NO_TEXTS = "bone|liver|phantom|MIP|CT|MR|LPS|NIfTI|NRRD|PNG|WebM|CSV"
"""Names of this scan, and abbreviations that are the same in every language."""

UNTRANSLATED = f"""(() => {{
  const word = /\\p{{L}}{{2,}}/u;
  const kept = /(?<!\\p{{L}})({UNITS}|{NO_TEXTS})(?!\\p{{L}})|#[0-9a-f]{{6}}/gu;
  let depth = 0;
  const outside = (text) => [...text].filter((c) => {{
    depth += c === "⟦" ? 1 : c === "⟧" ? -1 : 0;
    return depth === 0 && c !== "⟧";
  }}).join("").replace(kept, "").trim();
  const told = (e) => e.closest({json.dumps(TOLD_BY_THE_ENGINE)}) !== null;
  const where = (e) => e.closest("[data-testid]")?.dataset.testid ?? e.className ?? e.tagName;
  const found = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {{
    const {{ data, parentElement: e }} = walker.currentNode;
    const text = outside(data);
    const seen = e.checkVisibility({{ visibilityProperty: true }})
      || e.closest("select")?.checkVisibility();
    if (word.test(text) && seen && !told(e) && e.closest({json.dumps(KEYS)}) === null) {{
      found.push(`${{where(e)}}: ${{text}}`);
    }}
  }}
  if (depth !== 0) found.push("brackets that do not close");
  const names = ["aria-label", "title", "placeholder", "alt"];
  for (const name of [...names, "aria-valuetext", "aria-roledescription"]) {{
    for (const e of document.querySelectorAll(`[${{name}}]`)) {{
      depth = 0;
      const text = outside(e.getAttribute(name));
      if (word.test(text) && !told(e)) found.push(`${{where(e)}} ${{name}}: ${{text}}`);
    }}
  }}
  return [...new Set(found)];
}})()"""

OPEN_ALL = (
    "document.querySelectorAll('aside button[aria-expanded=false]')"
    ".forEach((each) => each.checkVisibility() && each.click())"
)


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """The start page in the language of brackets."""
    state = tmp_path_factory.mktemp("state")
    with palpate("open", state=state) as command, browser() as opened:
        # once with its token, which leaves the address
        opened.do("open", url=command.url, **SIZE)
        address = opened.read("location.origin")
        opened.do("open", url=f"{address}/?language=en-XA", **SIZE)
        # the start page stands only before a scan is open
        start = opened.read(UNTRANSLATED)
        opened.do("screenshot", path=str(OUTPUT / "language-start.png"))
        assert opened.text("open-demo").startswith("⟦")
        assert start == []
        opened.do("click", testid="open-demo")
        opened.wait("window.palpate?.ready === true", seconds=120.0)
        yield opened


def translated(page: Browser, name: str) -> None:
    """All that is seen now is in the catalogue."""
    page.frames()
    page.do("screenshot", path=str(OUTPUT / f"language-{name}.png"))
    assert page.read(UNTRANSLATED) == [], name


def test_the_page_tells_its_language(page: Browser) -> None:
    assert page.read("document.documentElement.lang") == "en-XA"


@pytest.mark.parametrize("group", ["scan", "segments", "view", "marks"])
def test_all_of_a_group_is_in_the_catalogue(page: Browser, group: str) -> None:
    page.do("click", testid=f"group-{group}")
    # what folds out may hold more that folds out
    for _ in range(3):
        page.read(OPEN_ALL)
        page.frames()
    translated(page, group)


@pytest.mark.parametrize("format_", ["slicer", "labels", "scan"])
def test_all_of_an_export_is_in_the_catalogue(page: Browser, format_: str) -> None:
    # the names of the others, which a scan without a file does not offer, are seen in the list
    page.do("click", testid="group-scan")
    page.do("choose", testid="export-format", value=format_)
    translated(page, f"export-{format_}")


@pytest.mark.parametrize("control", ["paint-segments", "find-segments", "show-statistics"])
def test_what_makes_and_measures_segments_is_in_the_catalogue(page: Browser, control: str) -> None:
    page.do("click", testid="group-segments")
    page.do("click", testid=control)
    translated(page, control)
    page.do("click", testid=control)


@pytest.mark.parametrize("tool", ["none", "eraser", "adder", "painter", "drill", "needle"])
def test_all_of_a_tool_is_in_the_catalogue(page: Browser, tool: str) -> None:
    page.do("click", testid=f"tool-{tool}")
    translated(page, f"tool-{tool}")


@pytest.mark.parametrize("mark", ["point", "distance", "angle", "ellipse", "rectangle", "path"])
def test_what_a_mark_asks_for_is_in_the_catalogue(page: Browser, mark: str) -> None:
    page.do("click", testid="group-marks")
    page.do("click", testid=f"mark-{mark}")
    translated(page, f"mark-{mark}")
    page.do("press", key="Escape")


@pytest.mark.parametrize("layout", ["slice", "four", "view"])
def test_slices_are_in_the_catalogue(page: Browser, layout: str) -> None:
    page.do("click", testid=f"layout-{layout}")
    translated(page, f"layout-{layout}")


def test_all_settings_are_in_the_catalogue(page: Browser) -> None:
    with page.settings():
        translated(page, "settings")


@pytest.mark.parametrize(
    ("key", "name"), [("?", "help"), ("Control+k", "palette"), ("Control+o", "open")]
)
def test_what_a_key_shows_is_in_the_catalogue(page: Browser, key: str, name: str) -> None:
    page.do("press", key=key)
    translated(page, name)
    page.do("press", key="Escape")
    page.frames()


def test_the_tour_is_in_the_catalogue(page: Browser) -> None:
    page.do("press", key="?")
    page.do("click", testid="show-tour")
    page.wait("document.querySelector('[data-testid=tour]') !== null")
    translated(page, "tour")
    page.do("press", key="Escape")


def test_pictures_and_guarantees_are_in_the_catalogue(page: Browser) -> None:
    for popover, name in (("images", "save-image"), ("guarantees", "guarantees")):
        page.read(f"document.querySelector('[popovertarget={popover}]').click()")
        translated(page, name)
        page.do("press", key="Escape")


def test_the_page_works_as_in_english(page: Browser) -> None:
    # nothing that the engine understands was translated
    page.do("click", testid="group-view")
    page.do("click", testid="preset-CT-Bone")
    page.wait("window.palpate.allDone() !== null")
    page.all_done()
    assert page.complaints == []
    assert page.read("document.querySelectorAll('.notice.error').length") == 0


def test_the_page_speaks_english_to_who_wants_no_language_that_there_is(page: Browser) -> None:
    page.do("open", url=f"{page.read('location.origin')}/?language=xx", **SIZE)
    page.wait("window.palpate?.ready === true", seconds=120.0)
    assert page.read("document.documentElement.lang") == "en"
    # names that were given in the other language stay
    assert page.text("touch-mode") == "Touch mode"
