"""Runs one recipe over every public scan that shows a body, and takes the picture of its page.

`make bodies` runs it. Left out are scans of few slices, cut-outs without skin, and coarser copies
of a scan that is there.
"""

from __future__ import annotations

import csv
import subprocess
import sys
from pathlib import Path

from browser import browser

RECIPE = """\
import:
  path: "{scan}"
  unit: "{unit}"
segment:
  - threshold: "{bone}"
    name: bone
  - threshold: "{skin}"
    keep-largest: true
    name: skin
touch:
  - segment: skin
    at: "{at}"
    depth: 5
    material: skin
    out: press.csv
    plot: press.svg
picture:
  - out: view.png
report: report.html
"""
HU = ("HU", 250, -300)
OWN = ("none", 1274, 724)
"""Unit and lowest values of bone and skin; of CThead's own values, about HU + 1024."""
BODIES = {
    "abdomen": ("totalseg_tests/example_ct.nii.gz", *HU, "anterior"),
    "abdomen-dicom": ("totalseg_tests/example_ct_dicom", *HU, "anterior"),
    "chest": ("lidc0001_totalseg/cxr.nii.gz", *HU, "anterior"),
    "head": ("cthead_stanford/CThead.mha", *OWN, "anterior"),
    "head-tilted": ("ge_gantry_tilt/GE_human_head_tilt+18.5", *HU, "superior"),
    "lung-baseline": ("elastix_lung_pair/3DCT_lung_baseline.mha", *HU, "anterior"),
    "lung-followup": ("elastix_lung_pair/3DCT_lung_followup.mha", *HU, "anterior"),
    "trunk": ("amos_0336/amos_0336.mhd", *HU, "anterior"),
}
"""Scan, unit, lowest values of bone and skin, and where the skin is pressed."""
SIZE = {"width": 1366, "height": 900}
"""Of the browser's window [pixels]."""


def prepared(data: Path, place: Path) -> list[str]:
    """Writes recipe and table into a folder; returns the command that runs them."""
    place.mkdir(parents=True, exist_ok=True)
    recipe, table = place / "recipe.yaml", place / "cases.csv"
    recipe.write_text(RECIPE, "utf-8")
    with table.open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["case", "scan", "unit", "bone", "skin", "at"])
        for name, (scan, *values) in BODIES.items():
            rows.writerow([name, (data / scan).absolute(), *values])
    return ["run", str(recipe), "--table", str(table), "--output", str(place / "out")]


def main(data: Path, place: Path, picture: Path) -> None:
    """Runs all scans; the same call again runs what is missing."""
    subprocess.run([sys.executable, "-m", "palpate", *prepared(data, place)], check=True)
    with browser() as page:
        url = (place / "out" / "index.html").absolute().as_uri()
        page.do("open", url=url, seconds=0.1, **SIZE)
        page.do("screenshot", path=str(picture.absolute()))
    print(picture)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
