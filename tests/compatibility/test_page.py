"""A scene of 0.1 on the page: it is looked at as it was, and its marks are there."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from browser import browser, palpate

from .kept import FILES, FIXTURES
from .make_fixtures import SIZE, page_view

pytestmark = pytest.mark.browser


def test_the_page_shows_the_view_and_the_marks_of_a_scene(tmp_path: Path) -> None:
    expected = json.loads((FIXTURES / "expected.json").read_text("utf-8"))["scene"]
    path = tmp_path / "whole.palpate"
    path.write_bytes((FILES / "whole.palpate").read_bytes())
    with palpate("open", path) as command, browser() as page:
        page.do("open", url=command.url, **SIZE)
        assert page_view(page) == expected["page"]
        names = [one["look"]["name"] for one in expected["whole"]["looks"]]
        text = page.read("document.body.textContent")
        fields = page.read("[...document.querySelectorAll('input')].map(({ value }) => value)")
        assert [name for name in names if name not in text and name not in fields] == []
        assert page.complaints == []
