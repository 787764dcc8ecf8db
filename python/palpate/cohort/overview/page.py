"""The page of a cohort: what ``page.js`` shows, as one HTML file."""

from __future__ import annotations

import json
import shlex
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Any

from palpate.base.package_version import package_version
from palpate.cohort.overview.outliers import FEWEST, FURTHEST
from palpate.cohort.overview.told_cases import ToldCase, measures_of
from palpate.recipes.html_page import data_url, html_page

__all__ = ["cohort_page"]


def cohort_page(cases: Sequence[ToldCase]) -> str:
    """Returns the page; it names no patient but by names of cases and paths."""
    told = json.dumps([_case(case) for case in cases], ensure_ascii=False, allow_nan=False)
    # a text must not end the element that it stands in
    told = told.replace("<", r"\u003c")
    body = f"""<script type="application/json" id="cases">{told}</script>
<main id="page">This page needs JavaScript; cohort.csv beside it has the same numbers.</main>
<footer class="muted">An outlier is a number whose modified z-score, 0.6745 · (value − median) /
median distance to the median, is beyond ±{FURTHEST} among the cases that are done (Iglewicz and
Hoaglin, 1993). Of fewer than {FEWEST} cases nothing is said. The same numbers are in cohort.csv.
Palpate {escape(package_version())}; for research and teaching, not for clinical use.</footer>"""
    here = Path(__file__).parent
    style, script = (here / name for name in ("page.css", "page.js"))
    return html_page(
        "Palpate: cohort", body, style=style.read_text("utf-8"), script=script.read_text("utf-8")
    )


def _case(case: ToldCase) -> dict[str, Any]:
    return {
        "name": case.name,
        "reason": case.reason,
        "warnings": case.warnings,
        "files": case.files,
        "seconds": case.wall_s,
        "open": _command(case),
        "outliers": case.outliers,
        "picture": None if case.thumbnail is None else data_url("image/jpeg", case.thumbnail),
        "segments": {
            name: {"colour": row.get("colour"), "note": row.get("note"), "values": measures_of(row)}
            for name, row in case.segments.items()
        },
    }


def _command(case: ToldCase) -> str | None:
    """Returns how to open a case with its segments, from the folder of the cohort."""
    if case.scan is None:
        return None
    labels = None if case.labels is None else shlex.quote(f"{case.name}/{case.labels}")
    segments = "" if labels is None else f" --segments {labels}"
    return f"palpate open {shlex.quote(case.scan)}{segments}"
