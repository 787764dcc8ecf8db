"""Measures edits at the page, from the engine to the GPU: `make bench-edit` runs it.

The eraser is led through the bone of a scan that is shown as a surface and from its voxels. What
counts is the time from an edit's being applied to its last upload being issued, without the wait
for the next frame: that is the time of drawing the frame before.
"""

from __future__ import annotations

import math
import statistics
import sys
import time
from pathlib import Path

from browser import Browser, browser, palpate

SIZE = {"width": 960, "height": 400}
"""Size of the browser's window [pixels]: small, since drawing in software takes all cores."""
SECONDS = 15.0
RADIUS = 4.0
"""Of the eraser [mm], the page's own choice."""
CIRCLE = 15.0
"""Radius of the circles in which it is led [mm]."""


def press(page: Browser, *, on: bool) -> None:
    """Holds the key of the tool, or lets it go."""
    kind = "keydown" if on else "keyup"
    page.read(f"void window.dispatchEvent(new KeyboardEvent('{kind}', {{key: 'x'}}))")


def erase(page: Browser) -> None:
    """Leads the eraser in circles over what stands in the picture's middle, ever deeper."""
    middle = page.read(
        "(({x, y, width, height}) => [width / 2, height / 2])"
        "(document.querySelector('[data-testid=canvas]').getBoundingClientRect())"
    )
    seen = page.read(f"window.palpate.pick({middle[0]}, {middle[1] - 60}).point")
    right, up, back = page.read("(({right, up, back}) => [right, up, back])(window.palpate.camera)")
    page.read(f"window.palpate.place({seen})")
    page.do("press", key="e")
    press(page, on=True)
    began = time.monotonic()
    while (passed := time.monotonic() - began) < SECONDS:
        across, along = CIRCLE * math.cos(2.0 * passed), CIRCLE * math.sin(2.0 * passed)
        deep = 1.0 * passed
        point = [
            p + across * r + along * u - deep * b
            for p, r, u, b in zip(seen, right, up, back, strict=True)
        ]
        page.read(f"window.palpate.hand({point})")
    press(page, on=False)


def told(name: str, times: list[float]) -> str:
    """Says the median, the 95th percentile and the worst of some times [ms]."""
    ordered = sorted(times)
    percentile = ordered[min(len(ordered) - 1, round(0.95 * len(ordered)))]
    return f"{name} {statistics.median(ordered):.1f} / {percentile:.1f} / {ordered[-1]:.1f} ms"


def main(path: Path) -> None:
    """Measures one scan."""
    with palpate("open", path) as command, browser() as page:
        page.do("open", url=command.url, **SIZE)
        page.read("document.querySelector('[data-testid=shown-as-both]').click()")
        page.wait("Object.values(window.palpate.triangles).some(count => count > 0)")
        erase(page)
        times = page.read("window.palpate.editTimes")
        voxels = page.read("window.palpate.state.tool.voxels")
    if not times:
        sys.exit("nothing was erased; allowed: a scan with bone in its middle")
    parts = [[entry[part] for entry in times] for part in ("way", "work", "wait")]
    total = [way + work for way, work in zip(parts[0], parts[1], strict=True)]
    print(f"{path.name}: {len(times)} edits, {voxels} voxels, eraser of {RADIUS:g} mm")
    print("median / 95 % / worst:")
    print(told("applied until the last upload is issued, without drawing:", total))
    for name, part in zip(("  engine to page", "  page", "  (drawing)"), parts, strict=True):
        print(told(f"{name}:", part))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
