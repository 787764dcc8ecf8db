"""The page of a cohort in a real browser: sorted, filtered, looked into; it fetches nothing."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest
from browser import Browser
from made_cohort import write_outlier
from palpate.cli.commands import run

pytestmark = pytest.mark.browser

RECIPE = """\
import:
  path: ct.nii.gz
  unit: HU
segment:
  - threshold: 100
    name: <block>
export:
  - out: labels.seg.nrrd
"""


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """Five cases, of which p4 is an outlier, and one that failed; opened as a file."""
    folder = tmp_path_factory.mktemp("cohort")
    write_outlier(folder)
    recipe, out = folder / "recipe.yaml", folder / "out"
    recipe.write_text(RECIPE, "utf-8")
    over = str(folder / "data" / "*" / "ct.nii.gz")
    assert run(["run", str(recipe), "--over", over, "-o", str(out)]) == 3
    with closing(Browser()) as browser:
        browser.do("open", url=(out / "index.html").as_uri(), width=1366, height=768, seconds=0.1)
        yield browser


def names(page: Browser) -> list[str]:
    """Returns the cases that are shown, in order."""
    shown = page.read("[...document.querySelectorAll('td.name')].map(one => one.innerText)")
    return [str(name).split()[-1] for name in shown]


def choose(page: Browser, text: str) -> None:
    page.do("clickText", text=text)


def test_cases_are_filtered_sorted_and_found(page: Browser) -> None:
    assert names(page) == ["p0", "p1", "p2", "p3", "p4", "torn"]
    choose(page, "Failed")
    assert names(page) == ["torn"]
    choose(page, "Outliers")
    assert names(page) == ["p4"]
    choose(page, "All")
    for _ in range(2):
        choose(page, "volume [ml]")
    # the largest first; what has no volume comes last
    assert names(page) == ["p4", "p2", "p1", "p3", "p0", "torn"]
    field = "document.querySelector('input[type=search]')"
    page.read(f"{field}.value = 'P2', {field}.dispatchEvent(new Event('input'))")
    assert names(page) == ["p2"]
    page.read(f"{field}.value = '', {field}.dispatchEvent(new Event('input'))")


def test_a_case_tells_how_it_is_opened_and_what_failed_why(page: Browser) -> None:
    page.read("document.getElementById('case-p4').click()")
    told = page.read("document.querySelector('tr.details').innerText")
    assert "--segments p4/labels.seg.nrrd" in told
    assert "<block>" in told
    assert "↑ 0.864" in told
    reason = page.read("document.querySelector('#case-torn .reason').innerText")
    assert "ct.nii.gz" in reason


def test_a_dot_leads_to_its_case(page: Browser) -> None:
    page.read(
        "[...document.querySelectorAll('.case-dot')]"
        ".find(dot => dot.textContent.startsWith('p0:')).dispatchEvent(new MouseEvent('click'))"
    )
    assert page.read("document.querySelector('tr.chosen').id") == "case-p0"


def test_the_page_is_accessible_and_complains_of_nothing(page: Browser) -> None:
    for scheme in ("light", "dark"):
        page.do("media", colorScheme=scheme)
        assert page.do("axe")["value"] == []
    assert page.complaints == []
    assert page.read("performance.getEntriesByType('resource').length") == 0


def test_nothing_is_wider_than_the_window(page: Browser) -> None:
    page.do("resize", width=1366, height=768)
    assert page.read("document.documentElement.scrollWidth <= innerWidth")
    assert Path(page.read("location.pathname")).name == "index.html"
