"""``palpate bench edit``: latency of an edit from the engine to the GPU of a page.

The eraser moves in circles through the bone of a scan that is shown both as a surface and from its
voxels. The latency is the time from when the engine applies an edit to when the page issues its
last upload. It is measured twice: with drawing suspended, so that the machine does everything
except drawing, and while the picture is drawn in software, which takes all cores. In the second
case the time that an edit waits for a frame in progress is reported separately. Without drawing the
picture follows every edit, with it as often as the page has time for.

In a third case the probe presses the same bone, made as soft as liver, in circles, with drawing
suspended: each answer of the lattice changes voxels, surface and displacement field.

The switch that suspends drawing exists for this benchmark only (``window.palpate``): uploads happen
as always, and no picture is drawn.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from palpate.base.errors import OptionError
from palpate.base.progress import Progress, silent
from palpate.bench.goals import GOALS
from palpate.bench.goals.edit import EDIT_DRAWN, EDIT_PRESSED, EDIT_SUSPENDED
from palpate.bench.haptics_data import CTHEAD, data_file
from palpate.bench.page import Page, chromium, opened, served
from palpate.bench.report import Row, row_of

__all__ = ["erased", "figures_of", "measure", "pressed", "rows_of"]

SIZE = {"width": 960, "height": 400}
"""Size of the browser's window [pixels]."""
SECONDS = 8.0
"""Duration of each case [s]."""
CIRCLE = 15.0
"""Radius of the circles of the eraser [mm]."""
DEEPER = 1.0
"""Speed at which the eraser goes deeper [mm/s]."""
PRESS_DEPTH, PRESS_CIRCLE = 4.0, 6.0
"""Depth and radius of the circles in which soft tissue is pressed [mm]."""
SOFT = "liver"
"""Material of the pressed tissue."""

FIRST_SEGMENT = 1
"""Number of the bone."""

Times = list[dict[str, float]]
"""Times of edits [ms]: ``way``, ``wait``, ``work``."""


def measure(
    scan: Path | None = None, *, seconds: float = SECONDS, progress: Progress = silent
) -> list[Row]:
    """Measures edits of the bone of a scan; the default is CThead.

    Raises:
        OptionError: There is no browser, or the scan has no bone in its middle.
        MissingDataError: The default scan is missing.
    """
    chromium()
    path = data_file(CTHEAD) if scan is None else scan
    found: dict[str, Times] = {}
    with served(path) as url, opened(url, **SIZE, drawer="browser") as page:
        page.read("document.querySelector('[data-testid=shown-as-both]').click()")
        page.wait("Object.values(window.palpate.triangles).some(count => count > 0)")
        for done, case in enumerate((EDIT_SUSPENDED, EDIT_PRESSED, EDIT_DRAWN)):
            progress(case, done / 3)
            suspended = case != EDIT_DRAWN
            page.read(f"void window.palpate.suspendDrawing({str(suspended).lower()})")
            _set(page, "edit-pace", "1" if suspended else "auto")
            found[case] = (pressed if case == EDIT_PRESSED else erased)(page, seconds)
    for case, times in found.items():
        if not times:
            raise OptionError(f"no edit while {case}; allowed: a scan with bone in its middle")
    return rows_of(found)


def rows_of(found: dict[str, Times]) -> list[Row]:
    """Returns the rows of a report."""
    reports = {case: figures_of(times) for case, times in found.items()}
    return [row_of(goal, reports[goal.case]) for goal in GOALS["edit"]]


def figures_of(times: Times) -> dict[str, float]:
    """Returns median, 95 % and maximum [s], with and without the wait for a frame, and parts."""
    way, wait, work = (np.array([one[part] for one in times]) / 1e3 for part in PARTS)
    figures = {"edits": float(len(times))}
    for name, taken in (("all", way + wait + work), ("undrawn", way + work)):
        quantiles = np.quantile(taken, [0.5, 0.95, 1.0])
        figures |= {
            f"{name} {quantile}": float(value)
            for quantile, value in zip(("median", "p95", "max"), quantiles, strict=True)
        }
    return figures | {
        "way": float(np.median(way)),
        "wait": float(np.median(wait)),
        "work": float(np.median(work)),
    }


PARTS = ("way", "wait", "work")


def erased(page: Page, seconds: float) -> Times:
    """Erases for a while; returns the times of the edits, and undoes them."""
    page.wait("window.palpate.finished || window.palpate.drawingSuspended")
    seen, axes = _aim(page)
    first = page.read("window.palpate.lastEdit")
    page.read(f"window.palpate.place({seen})")
    _key(page, "e")
    _key(page, "x")
    _lead(page, seen, axes, seconds=seconds, radius=CIRCLE, depth=lambda t: DEEPER * t)
    _key(page, "x", kind="keyup")
    page.wait("!window.palpate.state.tool.on")
    times: Times = page.read(f"window.palpate.editTimes.filter(({{edit}}) => edit > {first})")
    edit = page.read("window.palpate.state.edit")
    _key(page, "z", control=True)
    page.wait(f"window.palpate.state.edit > {edit}")
    return times


def pressed(page: Page, seconds: float) -> Times:
    """Presses soft tissue for a while; returns the times of changes, and makes it rigid again."""
    page.wait("window.palpate.finished || window.palpate.drawingSuspended")
    seen, axes = _aim(page)
    _choose(page, f"material-{FIRST_SEGMENT}", SOFT)
    page.wait("window.palpate.state.matter.model !== null")
    above = [p + 2.0 * PRESS_DEPTH * b for p, b in zip(seen, axes[2], strict=True)]
    page.read(f"window.palpate.place({above})")
    first = page.read("window.palpate.lastEdit")
    _lead(page, seen, axes, seconds=seconds, radius=PRESS_CIRCLE, depth=lambda _: PRESS_DEPTH)
    times: Times = page.read(f"window.palpate.editTimes.filter(({{edit}}) => edit > {first})")
    page.read(f"window.palpate.place({above})")
    page.read("document.querySelector('[data-testid=reset-matter]').click()")
    page.wait("window.palpate.state.matter.model === null")
    return times


def _lead(
    page: Page,
    seen: list[float],
    axes: list[list[float]],
    *,
    seconds: float,
    radius: float,
    depth: Callable[[float], float],
) -> None:
    """Moves the hand in circles around the aimed point, at a depth [mm] that depends on time."""
    began = time.monotonic()
    while (passed := time.monotonic() - began) < seconds:
        across, along = (radius * turn(2.0 * passed) for turn in (math.cos, math.sin))
        point = [
            p + across * r + along * u - depth(passed) * b
            for p, r, u, b in zip(seen, *axes, strict=True)
        ]
        page.read(f"window.palpate.hand({point})")
        time.sleep(0.005)


def _set(page: Page, testid: str, value: str) -> None:
    """Selects an entry of a list in the settings."""
    page.read("document.querySelector('[data-testid=open-settings]').click()")
    page.wait(f"document.querySelector('[data-testid={testid}]') !== null")
    _choose(page, testid, value)
    page.read("document.querySelector('[data-testid=close-settings]').click()")


def _choose(page: Page, testid: str, value: str) -> None:
    """Selects an entry of a list, as a user does."""
    page.read(
        f"(() => {{ const list = document.querySelector('[data-testid={testid}]');"
        f" list.value = '{value}';"
        " list.dispatchEvent(new Event('change', {bubbles: true})); })()"
    )


def _aim(page: Page) -> tuple[list[float], list[list[float]]]:
    """Returns the point of the bone in the middle of the picture, and the axes of the view."""
    middle = page.read(
        "(({width, height}) => [width / 2, height / 2])"
        "(document.querySelector('[data-testid=canvas]').getBoundingClientRect())"
    )
    picked = page.read(f"window.palpate.pick({middle[0]}, {0.7 * middle[1]})")
    if picked is None:
        raise OptionError("nothing in the picture's middle; allowed: a scan with bone there")
    axes = page.read("(({right, up, back}) => [right, up, back])(window.palpate.camera)")
    return picked["point"], axes


def _key(page: Page, key: str, *, kind: str = "keydown", control: bool = False) -> None:
    written = f"key: {key!r}, ctrlKey: {str(control).lower()}"
    page.read(f"void window.dispatchEvent(new KeyboardEvent('{kind}', {{{written}}}))")
