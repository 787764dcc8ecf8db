"""What the documents name exists, and what they show runs."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
DOCUMENTS = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")])
FOLDERS = "crates|python|viewer|tests|scripts|docs|benches|examples"
SOURCES = "rs|py|ts|svelte|glsl|frag|vert|css|mjs|js|toml"
PYTHON = ROOT / "python"
PAGE = ROOT / "viewer" / "src" / "gl"
PLACES = [ROOT, ROOT / "crates", *ROOT.glob("crates/*/src"), PYTHON, PYTHON / "palpate", PAGE]
"""Where paths on a page begin: at the root, or in the room that the page is about."""


def name(document: Path) -> str:
    return str(document.relative_to(ROOT))


@pytest.mark.parametrize("document", DOCUMENTS, ids=name)
def test_links_lead_somewhere(document: Path) -> None:
    targets = re.findall(r"\]\(([^)#\s]+)[^)]*\)", document.read_text(encoding="utf-8"))
    local = [target for target in targets if "://" not in target]
    assert [target for target in local if not (document.parent / target).exists()] == []


@pytest.mark.parametrize("document", DOCUMENTS, ids=name)
def test_links_lead_to_headings_that_exist(document: Path) -> None:
    links = re.findall(r"\]\(([^):\s]*)#([^)\s]+)\)", document.read_text(encoding="utf-8"))
    pages = [(document.parent / page if page else document, anchor) for page, anchor in links]
    assert [anchor for page, anchor in pages if anchor not in anchors(page)] == []


def anchors(page: Path) -> set[str]:
    """Returns the anchors of the headings of a page, as GitHub makes them."""
    headings = re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w -]", "", each.lower()).replace(" ", "-") for each in headings}


@pytest.mark.parametrize("document", DOCUMENTS, ids=name)
def test_files_of_the_repository_that_are_named_exist(document: Path) -> None:
    text = document.read_text(encoding="utf-8")
    path = r"[\w./{},*-]+"
    named = re.findall(rf"`((?:{FOLDERS})/{path}|{path}/{path}\.(?:{SOURCES}))`", text)
    built = {"python/palpate/viewer/", "viewer/bench/dist/"}
    paths = [each for form in named if form not in built for each in unfolded(form)]
    assert [each for each in paths if not any(any(place.glob(each)) for place in PLACES)] == []


def unfolded(form: str) -> list[str]:
    """Returns the paths that ``a/{b,c}.rs`` stands for."""
    before, brace, rest = form.partition("{")
    if not brace:
        return [form]
    inside, _, after = rest.partition("}")
    return [path for part in inside.split(",") for path in unfolded(before + part + after)]


READERS = ("use", "reference", "understand", "extend", "figures")
INDICES = {
    "docs": ("*.md", *(f"{folder}/*.md" for folder in READERS)),
    "docs/decisions": ("*.md",),
}


@pytest.mark.parametrize("index", INDICES)
def test_every_page_is_listed_once(index: str) -> None:
    folder = ROOT / index
    text = (folder / "README.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| \[.+?\]\((\S+\.md)\) \|", text, re.MULTILINE)
    pages = {str(page.relative_to(folder)) for form in INDICES[index] for page in folder.glob(form)}
    others = {"README.md", "decisions/README.md"}
    assert sorted(row for row in rows if row not in others) == sorted(pages - others)


def test_every_thread_is_listed() -> None:
    table = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8").partition("## Threads")[2]
    live = (ROOT / "crates" / "engine" / "src" / "session" / "live.rs").read_text(encoding="utf-8")
    threads = re.findall(r'live\.spawn\("(\w+)"', live)
    assert len(threads) > 5, "live.rs starts threads otherwise than this test believes"
    assert [name for name in threads if f"\n| {name} |" not in table] == []


def test_tests_named_for_the_promises_of_touch_exist() -> None:
    text = (ROOT / "docs" / "understand" / "touch.md").read_text(encoding="utf-8")
    promises = text.partition("## Guarantees")[2].partition("## ")[0]
    # names of tests are sentences: three words at least
    named = re.findall(r"`((?:[a-z0-9]+_){2,}[a-z0-9]+)`", promises)
    sources = [file.read_text(encoding="utf-8") for file in ROOT.glob("crates/*/tests/**/*.rs")]
    assert len(named) > 15, "the page names no tests: has its form changed?"
    assert [name for name in named if not any(f"fn {name}()" in text for text in sources)] == []


def test_tests_named_in_the_thesis_map_exist() -> None:
    text = (ROOT / "docs" / "understand" / "thesis-map.md").read_text(encoding="utf-8")
    proofs = re.findall(r"`([\w/]+\.(?:rs|py))`: ((?:`\w+`(?:, )?)+)", text)
    assert len(proofs) > 10, "the map names no tests: has its form changed?"
    for file, tests in proofs:
        source = (ROOT / file).read_text(encoding="utf-8")
        for test in re.findall(r"`(\w+)`", tests):
            assert re.search(rf"\b(?:fn|def) {test}\b", source), f"no {test} in {file}"


@pytest.mark.parametrize("page", ["README.md", "docs/use/python.md"])
def test_the_python_example_of_a_page_runs(page: str, tmp_path: Path) -> None:
    text = (ROOT / page).read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert blocks
    for block in blocks:
        subprocess.run([sys.executable, "-c", block], cwd=tmp_path, check=True, timeout=600)


EXAMPLES = {
    "adding-a-contact-model.md": "crates/haptics/examples/simple_model.rs",
    "adding-a-device.md": "crates/device/examples/udp_device.rs",
    "adding-a-model.md": "crates/deform/examples/simple_model.rs",
}
"""Pages that show a whole file; tests of its crate run it."""


@pytest.mark.parametrize(("page", "file"), EXAMPLES.items(), ids=list(EXAMPLES))
def test_examples_on_a_page_are_the_files_they_name(page: str, file: str) -> None:
    text = (ROOT / "docs" / "extend" / page).read_text(encoding="utf-8")
    source = (ROOT / file).read_text(encoding="utf-8")
    assert f"`{file}`" in text
    assert re.findall(r"```rust\n(.*?)```", text, re.DOTALL) == [source]

    # what a page shows fits on one
    assert len(source.splitlines()) < 60
