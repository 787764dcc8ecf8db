"""The words of the page are those that people use; none of the old ones is left."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from browser import Browser, browser, palpate

pytestmark = [pytest.mark.browser]

TEXTS = """(() => {
  const told = ['title', 'aria-label', 'placeholder'];
  const all = [...document.body.querySelectorAll('*:not(script):not(style)')];
  const own = (element) => [...element.childNodes].filter((node) => node.nodeType === 3)
    .map((node) => node.textContent.trim());
  return [...new Set(all.flatMap((element) =>
    [...own(element), ...told.map((name) => element.getAttribute(name) ?? '')]))].filter(Boolean);
})()"""
"""Every text of the page, with its tooltips and names for readers of screens."""
FOLDED = "[...document.querySelectorAll('aside [aria-expanded=false]')]"
NEW = {
    "Include the scan", "Search actions", "Tolerance (SD)", "Stop at necks narrower than",
    "Maximum volume", "Distance to", "Collide with other segments", "No soft tissue", "Hard",
    "Update rate", "Fracture energy", "Zones", "Smooth (image)", "Smooth (mask)", "Voxel steps",
    "Force checks passed", "Bone outside segments", "Update surfaces",
}  # fmt: skip
OLD = (
    "With the scan in it", "Without a description", "No passage below", "At most …", "Gap to",
    "None: all is hard", "Matter", "Work of breaking", "Surface smooth", "guarantees ok",
    "Other bone", "Surfaces follow", "Window own", "Begins", "middles of what is bright",
    "Not let in", "What should be done?", "Stops at others", "; allowed",
)  # fmt: skip


@pytest.fixture(scope="module")
def page() -> Iterator[Browser]:
    """The demo."""
    with palpate("demo") as command, browser() as page:
        page.do("open", url=command.url, width=1366, height=768)
        page.finish()
        yield page


def unfold(page: Browser) -> None:
    """Opens all that is folded, also what was in something folded."""
    for _ in range(3):
        page.read(f"void {FOLDED}.forEach((each) => each.click())")
        page.frames()


def test_the_panels_have_the_words_that_people_use(page: Browser) -> None:
    texts: set[str] = set()
    page.do("click", testid="soften-2")
    page.all_done()
    for group in ("scan", "segments", "view", "marks"):
        page.do("click", testid=f"group-{group}")
        unfold(page)
        if group == "segments":
            page.do("click", testid="find-segments")
            page.do("click", testid="move-object")
            page.frames()
        texts |= set(page.read(TEXTS))
    with page.settings():
        page.frames()
        texts |= set(page.read(TEXTS))
    page.do("press", key="Control+k")
    page.frames()
    texts |= set(page.read(TEXTS))
    page.do("press", key="Escape")
    missing = {word for word in NEW if not any(word in text for text in texts)}
    assert missing == set()
    left = {text for text in texts if any(word in text for word in OLD)}
    assert left == set()
