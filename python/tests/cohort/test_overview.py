"""Page and table of all cases of a cohort, and which numbers are marked as outliers."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import pytest
from made_cohort import write_outlier
from palpate.cli.commands import run
from palpate.cohort.overview.outliers import outliers

RECIPE = """\
import:
  path: ct.nii.gz
  unit: HU
segment:
  - threshold: 100
    name: <b> & block
export:
  - out: labels.seg.nrrd
"""
RUN = ["run", "recipe.yaml", "--over", "data/*/ct.nii.gz", "-o", "out"]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Five cases, one of them much larger than the others, and one that cannot be read."""
    write_outlier(tmp_path)
    (tmp_path / "recipe.yaml").write_text(RECIPE, "utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_run_ends_with_a_page_and_a_table_of_all_cases(folder: Path, capsys: Any) -> None:
    assert run(RUN) == 3
    page, table = folder / "out" / "index.html", folder / "out" / "cohort.csv"
    assert f"{page} written" in capsys.readouterr().out

    with table.open(encoding="utf-8") as file:
        rows = {row["case"]: row for row in csv.DictReader(file)}
    assert [row["state"] for row in rows.values()] == [*["done"] * 5, "failed"]
    assert rows["torn"]["reason"]
    assert float(rows["p1"]["volume_ml"]) == pytest.approx(5 * 36 / 1000)
    assert float(rows["p1"]["mean_HU"]) == 300.0
    assert "volume_ml" in rows["p4"]["outlier"]
    assert not rows["p1"]["outlier"]

    text = page.read_text("utf-8")
    # one file: it fetches nothing, and no name becomes HTML
    assert "http" not in text.replace("http://www.w3.org/2000/svg", "")
    assert "<b> & block" not in text
    told = json.loads(text.split('id="cases">')[1].split("</script>")[0])
    first, last = told[0], told[-1]
    assert first["segments"]["<b> & block"]["values"]["volume_ml"] == pytest.approx(0.144)
    assert first["picture"].startswith("data:image/jpeg;base64,")
    scan = folder / "data" / "p0" / "ct.nii.gz"
    assert first["open"] == f"palpate open {scan} --segments p0/labels.seg.nrrd"
    assert last["reason"] == rows["torn"]["reason"]

    # the same is written anew on demand
    page.unlink()
    assert run(["report", "out"]) == 0
    assert "index.html: 6 cases" in capsys.readouterr().out
    assert page.read_text("utf-8") == text


def test_only_the_folder_of_a_cohort_has_a_report(folder: Path, capsys: Any) -> None:
    assert run(["report", "data"]) == 2
    assert "holds something else" in capsys.readouterr().err
    assert run(["report", "nowhere"]) == 2
    assert "allowed: an output folder of" in capsys.readouterr().err
    assert not (folder / "nowhere").exists()


@pytest.mark.parametrize(
    ("values", "far"),
    [
        # distances to the median 3 are 2, 1, 0, 1, 97: their median is 1, 0.6745 · 97 > 3.5
        ([1.0, 2.0, 3.0, 4.0, 100.0], [False, False, False, False, True]),
        # 0.6745 · 5 = 3.37 is within, 0.6745 · 5.2 = 3.51 beyond
        ([1.0, 2.0, 3.0, 4.0, 8.0], [False] * 5),
        ([1.0, 2.0, 3.0, 4.0, 8.2], [False, False, False, False, True]),
        ([1.0, 2.0, 3.0, 100.0], [False] * 4),
        ([5.0, 5.0, 5.0, 5.0, 9.0], [False] * 5),
    ],
)
def test_outliers_are_far_from_the_median_by_the_median_distance(
    values: list[float], far: list[bool]
) -> None:
    assert outliers(values) == far
