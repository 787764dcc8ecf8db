"""The reference in docs/reference says what the code says."""

from __future__ import annotations

from pathlib import Path

import palpate
import pytest
from make_reference import FOLDER, pages, stale
from reference_python import markdown


def test_the_committed_pages_are_up_to_date() -> None:
    assert stale() == [], "run scripts/make_reference.py"


def test_a_page_that_differs_or_is_missing_is_found(tmp_path: Path) -> None:
    (tmp_path / "cli.md").write_text("# Command line\n", encoding="utf-8")
    assert stale(tmp_path) == ["cli.md", "python.md"]


@pytest.mark.parametrize("name", palpate.__all__)
def test_every_public_name_has_a_section_with_text(name: str) -> None:
    text = (FOLDER / "python.md").read_text(encoding="utf-8")
    section = text.partition(f"\n### {name}\n")[2].partition("\n### ")[0]
    told = [line for line in section.splitlines() if line[:1].isupper()]
    assert told != []


def test_every_command_has_a_section() -> None:
    page = pages()["cli.md"]
    for command in ("open", "segment", "surface export", "scenario play", "bench haptics"):
        assert f"\n## palpate {command}\n" in page


def test_sections_of_a_docstring_become_lists() -> None:
    docstring = "Reads.\n\nArgs:\n    path: A ``file``,\n        or two.\n\nReturns:\n    It."
    page = "Reads.\n\n**Arguments**\n\n- `path`: A `file`, or two.\n\n**Returns**\n\nIt."
    assert markdown(docstring) == page
