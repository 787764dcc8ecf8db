"""The run over all bodies that the docs show: its scans are there, and the recipe fits them."""

from __future__ import annotations

from pathlib import Path

import pytest
from palpate.cli.commands import run
from run_bodies import BODIES, RECIPE, prepared

PAGE = Path(__file__).parents[1] / "docs" / "understand" / "cohorts.md"


@pytest.mark.data
def test_each_body_is_there_and_is_taken(
    data_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert all((data_folder / scan).exists() for scan, *_ in BODIES.values())
    assert run([*prepared(data_folder, tmp_path), "--dry-run"]) == 0
    told = capsys.readouterr().out
    assert told == "".join(f"{name}\n" for name in BODIES) + f"{len(BODIES)} to run, 0 kept\n"


def test_the_docs_show_the_recipe_that_is_run() -> None:
    assert f"```yaml\n{RECIPE}```" in PAGE.read_text("utf-8")
