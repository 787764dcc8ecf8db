"""``palpate bench edit`` in a real browser."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
import SimpleITK
from browser import TOOL

pytestmark = pytest.mark.browser


def test_bench_edit_tells_of_edits_with_drawing_suspended_and_in_software(tmp_path: Path) -> None:
    z, y, x = np.mgrid[0:64, 0:64, 0:64] - 32.0
    values = np.where(x * x + y * y + z * z <= 24.0**2, 900, -1000).astype(np.int16)
    scan, told = tmp_path / "ball.nrrd", tmp_path / "edit.json"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(scan))
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
