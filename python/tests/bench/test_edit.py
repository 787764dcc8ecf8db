"""What ``palpate bench edit`` tells of times, and how it fails without a browser."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from palpate.base.errors import OptionError
from palpate.bench.edit import figures_of, rows_of
from palpate.bench.goals import GOALS
from palpate.bench.goals.edit import EDIT_DRAWN, EDIT_PRESSED, EDIT_SUSPENDED
from palpate.bench.page import chromium

TIMES = [{"way": 4.0 + i, "wait": 10.0 * (i % 2), "work": 1.0} for i in range(21)]
"""Ways of 4 to 24 ms, every other edit after a wait of 10 ms."""


def test_figures_are_in_seconds_with_the_wait_and_without() -> None:
    figures = figures_of(TIMES)
    assert figures["edits"] == 21.0
    assert figures["undrawn median"] == pytest.approx(0.015)
    assert figures["undrawn max"] == pytest.approx(0.025)
    assert figures["all max"] == pytest.approx(0.034)
    assert figures["all p95"] >= figures["undrawn p95"]
    assert figures["wait"] == 0.0


def test_every_goal_has_its_row_and_the_budget_is_that_of_the_design() -> None:
    rows = rows_of({EDIT_SUSPENDED: TIMES, EDIT_PRESSED: TIMES, EDIT_DRAWN: TIMES})
    assert len(rows) == len(GOALS["edit"])
    assert {(row.case, row.metric) for row in rows if row.goal is not None} == {
        (case, f"applied to last upload, {quantile}")
        for case in (EDIT_SUSPENDED, EDIT_PRESSED)
        for quantile in ("median", "95 %")
    }
    assert {row.goal for row in rows} == {None, 50.0}


def test_without_a_browser_it_says_what_is_missing(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    for name in ("PALPATE_CHROMIUM", "CHROMIUM"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(OptionError, match=r"no browser .*allowed: an installed Chromium"):
        chromium()
    monkeypatch.setenv("PALPATE_CHROMIUM", str(tmp_path / "none"))
    with pytest.raises(OptionError, match=r"no browser at .*none"):
        chromium()


@pytest.mark.parametrize("row", GOALS["edit"])
def test_rows_say_which_is_better(row: Any) -> None:
    assert row.better == ("higher" if row.metric == "edits" else "lower")
