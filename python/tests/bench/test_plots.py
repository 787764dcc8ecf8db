"""Figures of benchmarks are drawn."""

from __future__ import annotations

from pathlib import Path

import pytest
from palpate import OptionError
from palpate.base import plot_file
from palpate.base.plot_file import check_plot
from palpate.bench import plots
from palpate.bench.goals import GOALS
from palpate.bench.report import Row, row_of


def quality_rows() -> list[Row]:
    """A figure for every goal, as if it had been measured."""
    return [row_of(goal, {goal.key: 1.0}) for goal in GOALS["touch-quality"]]


@pytest.mark.parametrize("name", ["a.png", "a.svg"])
def test_plots_are_pictures(tmp_path: Path, name: str) -> None:
    begins = {".png": b"\x89PNG", ".svg": b"<?xml"}[Path(name).suffix]
    for plot, rows in (
        (plots.plot_quality, quality_rows()),
        # only one way of touch was measured
        (plots.plot_quality, [row for row in quality_rows() if row.case.startswith("exact")]),
        (plots.plot_haptics, [row_of(goal, {goal.key: 1.0}) for goal in GOALS["haptics"]]),
    ):
        plot(rows, tmp_path / name)
        assert (tmp_path / name).read_bytes().startswith(begins)
        assert (tmp_path / name).stat().st_size > 10_000


def test_a_plot_that_cannot_be_made_is_refused_before_measuring(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    check_plot(None)
    check_plot(tmp_path / "a.PNG")
    with pytest.raises(OptionError, match="allowed: a file that ends in"):
        check_plot(tmp_path / "a.xyz")
    monkeypatch.setattr(plot_file, "find_spec", lambda _: None)
    with pytest.raises(OptionError, match="pip install palpate"):
        check_plot(tmp_path / "a.png")
