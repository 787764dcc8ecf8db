"""Takes the pictures of the page that the docs show: `make pictures` runs it.

CThead with the probe pressed into its bone, the organs of the LIDC chest beside its slices, and
those of AMOS 0336 on the light ground. Nothing in them is random.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

from browser import Browser, browser, palpate

SIZE = {"width": 1366, "height": 768}
"""Of the browser's window [pixels]."""
PATIENCE = 600.0
"""For all surfaces of a scan, drawn in software [s]."""
PRESSED = 3.0
"""How deep the probe is led into the forehead [mm]."""


def main(data: Path, images: Path) -> None:
    """Takes all pictures of the scans in a folder."""
    head = data / "cthead_stanford" / "CThead.mha"
    _take(images / "page-cthead.png", [str(head)], _touched)
    chest = data / "lidc0001_totalseg"
    _take(images / "page-lidc.png", _ct(chest / "cxr.nii.gz", chest / "mask.nii.gz"), _with_slices)
    trunk = data / "amos_0336"
    labels = trunk / "labels_from_meshes.nii.gz"
    _take(images / "page-amos.png", _ct(trunk / "amos_0336.mhd", labels), _on_light_ground)


def _ct(scan: Path, segments: Path) -> list[str]:
    return [str(scan), "--unit", "HU", "--segments", str(segments)]


def _take(path: Path, scan: list[str], arrange: Callable[[Browser], None]) -> None:
    with palpate("open", *scan) as command, browser(drawer="browser") as page:
        page.do("open", url=command.url, **SIZE)
        page.read("window.palpate.setJitter(false)")
        arrange(page)
        page.read("document.querySelectorAll('.notice button').forEach((each) => each.click())")
        page.wait("window.palpate.finished", seconds=PATIENCE)
        page.do("screenshot", path=str(path))
        print(path)


def _touched(page: Browser) -> None:
    """Presses the probe into the forehead."""
    back = page.read("window.palpate.camera.back")
    x, y = page.read("window.palpate.middle")
    seen = page.read(f"window.palpate.pick({x}, {0.75 * y})")["point"]
    before, inside = (
        [p + way * b for p, b in zip(seen, back, strict=True)] for way in (6.0, -PRESSED)
    )
    page.read(f"window.palpate.place({before})")
    page.settled()
    page.read(f"window.palpate.hand({inside})")
    page.settled()


def _with_slices(page: Browser) -> None:
    page.do("click", testid="layout-four")
    _as_surfaces(page)


def _on_light_ground(page: Browser) -> None:
    with page.settings():
        page.do("choose", testid="theme", value="light")
    _as_surfaces(page)


def _as_surfaces(page: Browser) -> None:
    """Shows all segments as surfaces, once these are there."""
    page.do("click", testid="all-as-surface")
    shown = "Object.values(window.palpate.triangles).filter((count) => count > 0).length"
    listed = "document.querySelectorAll('[data-testid^=segment-]:is(li)').length"
    page.wait(f"{shown} === {listed}", seconds=PATIENCE)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
