"""``palpate bench edit``, and what ``palpate bench render`` sees, in a real browser."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
import SimpleITK
from browser import ROOT, TOOL
from palpate.bench.goals.seen import SEEN_ROWS, seen_case
from palpate.bench.pictures.seen import Looking, seen

pytestmark = pytest.mark.browser


@pytest.fixture
def scan(tmp_path: Path) -> Path:
    z, y, x = np.mgrid[0:64, 0:64, 0:64] - 32.0
    values = np.where(x * x + y * y + z * z <= 24.0**2, 900, -1000).astype(np.int16)
    path = tmp_path / "ball.nrrd"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(path))
    return path


@pytest.mark.long
def test_bench_edit_tells_of_edits_with_drawing_suspended_and_in_software(
    scan: Path, tmp_path: Path
) -> None:
    told = tmp_path / "edit.json"
    command = [*map(str, TOOL), "bench", "edit", str(scan), "--seconds", "4", "--json", str(told)]
    subprocess.run(command, check=True, timeout=300, capture_output=True, text=True)

    report = json.loads(told.read_text(encoding="utf-8"))
    assert report["bench"] == "edit"
    found = {(row["case"], row["metric"]): row["value"] for row in report["rows"]}
    for case in ("drawing suspended", "drawn in software", "matter gives way, drawing suspended"):
        assert found[case, "edits"] >= 1
        way, page = found[case, "engine to page, median"], found[case, "page, median"]
        assert way > 0.0
        assert page > 0.0
        # each part is within the whole
        assert found[case, "applied to last upload, max"] >= max(way, page)


@pytest.mark.long
def test_bench_render_sees_every_figure_of_a_scan_that_the_engine_draws(
    scan: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = subprocess.run(
        [ROOT / "scripts" / "chromium.sh"], check=True, capture_output=True, text=True
    )
    monkeypatch.setenv("PALPATE_CHROMIUM", found.stdout.strip())
    figures = seen(scan, Looking(openings=1, turning=3.0, rests=1, drilling=1.0), drawer="engine")
    assert figures.pop("by engine") == 1.0
    rows = {row.key for row in SEEN_ROWS if row.case == seen_case("CThead", by_engine=True)}
    assert set(figures) == rows
    assert all(figure > 0.0 for figure in figures.values())
    # each is a part of the one after it
    assert figures["first"] <= figures["sharp"] <= figures["final"]
    assert figures["rest sharp"] <= figures["rest final"]
    assert figures["coarsest"] >= 1.0
