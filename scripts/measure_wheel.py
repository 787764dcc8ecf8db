"""How many slices a second a page shows while the wheel turns, without a graphics card.

Run: ``python scripts/measure_wheel.py SCAN [slice ...]``. Notches come 25 a second; a slice counts
once it stands on the canvas. Say with the figure how many cores there were and what else ran.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "support"))

from browser import browser, palpate

NOTCH = 120
"""Of the wheel, as browsers count it."""
NOTCHES = 40
EVERY = 40
"""Milliseconds between two."""


def main(scan: str, names: list[str]) -> None:
    """Prints for each slice how many were passed and drawn, and in what time."""
    with palpate("open", scan, "--threshold", "250") as command, browser() as page:
        page.do("open", url=command.url, width=1366, height=768)
        page.do("click", testid="layout-four")
        page.wait("window.palpate.slices.length === 3")
        page.finish()
        drawn = "window.palpate.drawnSlices"
        for name in names:
            at = f"window.palpate.slices.find(({{name}}) => name === {name!r}).plane.centre"
            before, first = page.read(at), page.read(drawn)
            told = page.do(
                "wheelOver", testid=f"slice-{name}", y=-NOTCH, times=NOTCHES, every=EVERY
            )
            last = page.read(drawn)
            moved = max(abs(a - b) for a, b in zip(before, page.read(at), strict=True))
            seconds = told["value"] / 1000
            print(
                f"{name}: {NOTCHES} notches in {seconds:.2f} s moved it by {moved:.1f} mm; "
                f"{last - first} slices drawn, {(last - first) / seconds:.1f} a second"
            )


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:] or ["axial", "coronal", "sagittal"])
