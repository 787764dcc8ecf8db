"""``palpate bench render``: times of pictures, data sent for an edit, and vtk.js for comparison.

What a person sees is reported first, whoever draws (``render_seen.py``). Everything else is about
what the browser draws itself, in a page in a headless Chromium that shows a scan, by default
CThead. The first picture is that of a chest of 512×512×133, or of the given scan, freshly read,
timed from opening the page's address. Three times are reported for each mode and size: between
pictures while the view rotates, at the resolution that the page chooses then; from the last
rotation until the picture has the full quality that the page chooses; and of one whole picture at
full resolution with one step per voxel, drawn off screen. GL calls and bytes of edits are counted
in a separate page, since counting costs time.

vtk.js draws the same values in the same page, with the same camera, size, transfer function and
step, and the segment as tissue. The quality of a picture is its mean difference from one of the
same renderer with eight times as many steps. For equal quality vtk.js gets the fewest steps, of 1,
2, 4 and 8 per voxel, with which it is as near to its own reference as Palpate is to its own, or
else 8. It is not part of the package: the source tree builds it (``npm run build:bench``), else
there is no comparison.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from statistics import median
from typing import Any, Literal

import numpy as np

from palpate.base.errors import OptionError
from palpate.base.progress import Progress, silent
from palpate.bench.edit import erased
from palpate.bench.goals.render import (
    EDIT_CASE,
    MODES,
    OPENED_CASE,
    PEER_MODES,
    RENDER_ROWS,
    RESTING,
    SIZES,
    peer_case,
    picture_case,
)
from palpate.bench.goals.seen import LATE_CASE, LATE_MORE
from palpate.bench.haptics_data import CTHEAD, LIDC, data_file
from palpate.bench.page import Page, chromium, opened, served
from palpate.bench.pictures.first_picture import first_picture
from palpate.bench.pictures.render_seen import SeenEffort, measure_seen
from palpate.bench.pictures.seen import WINDOW, Looking
from palpate.bench.report import Row, rows_in

__all__ = ["QUICK", "SURFACES", "Drawer", "Effort", "Measured", "built_peer", "measure", "rows_of"]

Drawer = Literal["auto", "engine", "browser"]
"""Who draws what is seen; "auto" leaves it to the page, and measures the browser as well."""
FINE = 8
"""Steps of a reference picture, relative to those of the picture that is compared with it."""
PEER_STEPS = (1, 2, 4, 8)
"""Steps per voxel that are tried with vtk.js."""
STEP_ANGLE = 0.02
"""Rotation of the view from picture to picture [rad]."""
BEFORE_REST = 20
"""Frames of rotation before the view rests."""

Report = dict[str, dict[str, float]]
"""Figures by their case."""


@dataclass(frozen=True)
class Effort:
    """How much is measured."""

    turning: int = 60
    """Pictures while the view rotates."""
    whole: int = 7
    """Whole pictures."""
    rests: int = 3
    """Times that the view comes to rest."""
    edits: float = 2.0
    """Time of erasing [s]."""
    openings: int = 3
    """Times that the page is opened until its first picture."""
    sizes: tuple[tuple[int, int], ...] = SIZES
    modes: tuple[str, ...] = MODES
    peer_modes: tuple[str, ...] = PEER_MODES
    peer_size: tuple[int, int] = (320, 240)
    """Columns and rows of pictures that are compared with those of vtk.js, of which accurate ones
    take minutes in software."""
    seen: SeenEffort = field(default_factory=SeenEffort)


QUICK = Effort(
    turning=8,
    whole=1,
    rests=1,
    edits=1.5,
    openings=1,
    sizes=SIZES[:1],
    modes=("shaded",),
    peer_modes=("mip",),
    peer_size=(160, 120),
    seen=SeenEffort(
        looking=Looking(openings=1, turning=1.5, rests=1, drilling=1.0),
        views=1,
        pairs=1,
        span=1.0,
        rounds=1,
        vtk_size=(202, 174),
        vtk_js_size=(80, 60),
    ),
)


@dataclass(frozen=True)
class Measured:
    """What was measured."""

    rows: list[Row]
    renderer: str
    """Of what the browser draws, as it names it."""
    missing: list[str]
    """Sentences on what could not be measured."""


def built_peer() -> Path | None:
    """Returns the script that draws with vtk.js, where the source tree has built it."""
    built = Path(__file__).parents[4] / "viewer" / "bench" / "dist" / "vtk.js"
    return built if built.is_file() else None


def measure(
    scan: Path | None = None,
    *,
    drawer: Drawer = "auto",
    peer: Path | None = None,
    effort: Effort | None = None,
    progress: Progress = silent,
) -> Measured:
    """Measures pictures of a scan, and of ``peer``, a script that draws with vtk.js.

    Raises:
        OptionError: There is no browser, no such script, or nothing in the middle of the scan.
        MissingDataError: The default scan is missing.
    """
    chromium()
    if peer is not None and not peer.is_file():
        raise OptionError(f"no script at {peer}; allowed: what `npm run build:bench` has built")
    effort = effort or Effort()
    report, missing = measure_seen(
        scan,
        drawer=None if drawer == "auto" else drawer,
        peer=peer,
        effort=effort.seen,
        progress=progress,
    )
    # JSON of the page
    support: dict[str, Any] = {"software": True, "renderer": "the engine"}
    if drawer != "engine":
        found, support = _browser(scan, peer=peer, effort=effort, progress=progress)
        report |= found
    on_gpu = not support["software"]
    return Measured(rows_of(report, on_gpu=on_gpu), support["renderer"], missing)


def _browser(
    scan: Path | None, *, peer: Path | None, effort: Effort, progress: Progress
) -> tuple[Report, dict[str, Any]]:
    """Measures what the browser draws; returns with that what its graphics can do."""
    path = data_file(CTHEAD) if scan is None else scan
    support: dict[str, Any] = {}
    with served(path) as url:
        progress("counting what edits send", 0.0)
        report = _counted(url, effort)
    progress("first picture", 0.1)
    opened_scan = data_file(LIDC) if scan is None else scan
    report[OPENED_CASE] |= first_picture(opened_scan, runs=effort.openings, **WINDOW)
    with served(path) as url:
        for done, size in enumerate(effort.sizes):
            with opened(url, **WINDOW, drawer="browser") as page:
                support = page.read("window.palpate.support")
                _fit(page, size)
                for mode in effort.modes:
                    progress(picture_case(mode, size), 0.2 + 0.5 * done / len(effort.sizes))
                    _show(page, mode)
                    report[picture_case(mode, size)] = _times(page, size, effort)
        if peer is not None:
            with opened(url, **WINDOW, drawer="browser") as page:
                progress("beside vtk.js", 0.7)
                page.wait("window.palpate.finished")
                report |= _beside(page, peer.read_text(encoding="utf-8"), effort)
    return report, support


def rows_of(report: Report, *, on_gpu: bool) -> list[Row]:
    """Returns the rows of all measured cases; some goals are for a GPU or real-time priority."""
    rows = rows_in(RENDER_ROWS, report)
    without = set() if on_gpu else {RESTING}
    if not report.get(LATE_CASE, {}).get("real time", 1.0):
        without.add(LATE_MORE)
    return [replace(row, goal=None) if row.metric in without else row for row in rows]


# --- what the page shows ------------------------------------------------------------------


def _fit(page: Page, size: tuple[int, int]) -> None:
    """Sets the size of the 3-D view, and removes all randomness from it."""
    page.read("window.palpate.setJitter(false)")
    for _ in range(4):  # panels are narrower in a narrow window
        found = page.read(
            "(({width, height}) => [window.innerWidth, window.innerHeight, width, height])"
            "(document.querySelector('[data-testid=canvas]').getBoundingClientRect())"
        )
        if (round(found[2]), round(found[3])) == size:
            break
        page.resize(round(found[0] + size[0] - found[2]), round(found[1] + size[1] - found[3]))
        page.read(FRAMES)
    page.wait("window.palpate.finished")


FRAMES = "new Promise(resolve => requestAnimationFrame(() => requestAnimationFrame(resolve)))"
"""Waits until changes have reached the picture."""


SURFACES = {
    "surface": ("surface", 1, "shaded"),
    "translucent surface": ("surface", 0.5, "shaded"),
    "surface and voxels": ("both", 1, "shaded"),
    "surface before a MIP": ("surface", 1, "mip"),
}
"""How bone is shown in modes that are not blend modes, its opacity, and the blend mode of the rest.
"""
CHOOSE = """(() => {
  const control = document.querySelector('[data-testid=%s]');
  control.value = '%s';
  for (const name of ['input', 'change']) control.dispatchEvent(new Event(name, {bubbles: true}));
})()"""
"""Sets the value of a list or a slider."""


def _show(page: Page, mode: str) -> None:
    """Makes the page draw in a mode."""
    shown, opacity, blend = SURFACES.get(mode, ("volume", None, mode))
    page.read(f"document.querySelector('[data-testid=shown-as-{shown}]')?.click()")
    if opacity is not None:
        page.wait("Object.values(window.palpate.triangles).some(count => count > 0)")
        page.read(CHOOSE % ("surface-opacity", opacity))
    page.read(CHOOSE % ("blend", blend))
    page.read("window.palpate.allDone()")
    page.read(FRAMES)
    page.wait("window.palpate.finished")


# --- times --------------------------------------------------------------------------------


def _times(page: Page, size: tuple[int, int], effort: Effort) -> dict[str, float]:
    turning = page.read(TURNING % (effort.turning, STEP_ANGLE))
    # pictures are averaged only where rays start at random
    page.read("window.palpate.setJitter(true)")
    resting = [
        float(page.read(RESTING_TIME % (BEFORE_REST, STEP_ANGLE))) for _ in range(effort.rests)
    ]
    page.read("window.palpate.setJitter(false)")
    width, height = size
    page.read("void window.palpate.suspendDrawing(true)")
    wish = f"{{width: {width}, height: {height}, stepsPerVoxel: 1}}"
    draw = f"window.palpate.bench.draw({wish}).milliseconds"
    page.read(draw)
    whole = [float(page.read(draw)) for _ in range(effort.whole)]
    page.read("void window.palpate.suspendDrawing(false)")
    times = {
        f"{name} {quantile}": float(np.quantile(taken, share)) / 1e3
        for name, taken in (("turning", turning), ("whole", whole))
        for quantile, share in (("median", 0.5), ("p99", 0.99))
    }
    return times | {"resting": median(resting) / 1e3}


TURNING = """new Promise((resolve) => {
  const { bench } = window.palpate, wanted = %d, times = [];
  let pieces = bench.pieces, last = null;
  const step = (now) => {
    last ??= now;
    if (bench.pieces !== pieces) {
      times.push(now - last);
      [pieces, last] = [bench.pieces, now];
    }
    bench.turn(%g);
    if (times.length < wanted) requestAnimationFrame(step); else resolve(times);
  };
  requestAnimationFrame(step);
})"""
"""Rotates a resting view with every frame: times to the first picture and between pictures [ms]."""


RESTING_TIME = """new Promise((resolve) => {
  const { bench } = window.palpate;
  let turns = %d, last = 0;
  const step = (now) => {
    if (turns > 0) {
      bench.turn(%g);
      [last, turns] = [now, turns - 1];
    } else if (now - last > 50 && window.palpate.finished) return resolve(now - last);
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
})"""
"""Rotates a view with some frames: time from the last rotation until the picture is final [ms].

A rotation reaches the picture within 50 ms, and until then the previous picture may be final.
"""


# --- what edits send ----------------------------------------------------------------------


def _counted(url: str, effort: Effort) -> Report:
    with opened(None, width=960, height=400, drawer="browser") as page:
        page.before(COUNTING)
        page.go(url)
        page.wait("window.palpate.finished")
        page.read("document.querySelector('[data-testid=shown-as-both]').click()")
        page.wait("Object.values(window.palpate.triangles).some(count => count > 0)")
        page.wait("window.palpate.finished")
        heap = page.heap()
        textures = float(page.read("window.__gl.textures"))
        page.read("void window.palpate.suspendDrawing(true)")
        page.read("void Object.assign(window.__gl, {calls: 0, bytes: 0})")
        count = len(erased(page, effort.edits))
        if count == 0:
            raise OptionError("no edit was made; allowed: a scan with bone in its middle")
        sent: dict[str, float] = page.read("window.__gl")
    per_edit = sent["bytes"] / count
    return {
        OPENED_CASE: {"heap": heap, "textures": textures},
        EDIT_CASE: {
            "edits": float(count),
            "calls": sent["calls"] / count,
            "bytes": per_edit,
            "share": per_edit / textures,
        },
    }


COUNTING = """(() => {
  const counted = window.__gl = { calls: 0, bytes: 0, textures: 0 };
  const { prototype } = WebGL2RenderingContext;
  const size = (gl, format, type) => {
    const parts = { [gl.RED]: 1, [gl.RED_INTEGER]: 1, [gl.RG]: 2, [gl.RGB]: 3 }[format] ?? 4;
    const single = type === gl.UNSIGNED_BYTE || type === gl.BYTE;
    const double = type === gl.UNSIGNED_SHORT || type === gl.SHORT || type === gl.HALF_FLOAT;
    return parts * (single ? 1 : double ? 2 : 4);
  };
  const sent = {
    texSubImage3D: (gl, a) => a[5] * a[6] * a[7] * size(gl, a[8], a[9]),
    texImage3D: (gl, a) => (a[9] ? a[3] * a[4] * a[5] * size(gl, a[7], a[8]) : 0),
    texSubImage2D: (gl, a) => (a.length > 7 ? a[4] * a[5] * size(gl, a[6], a[7]) : 0),
    texImage2D: (gl, a) => (a[8] ? a[3] * a[4] * size(gl, a[6], a[7]) : 0),
    bufferData: (gl, a) => a[1]?.byteLength ?? 0,
    bufferSubData: (gl, a) => (a[4] ? a[4] * (a[2].BYTES_PER_ELEMENT ?? 1) : a[2].byteLength),
  };
  const rooms = (gl) => ({ [gl.R8]: 1, [gl.R8UI]: 1, [gl.RG8]: 2, [gl.R16F]: 2 });
  const made = {
    texStorage3D: (gl, a) => a[3] * a[4] * a[5] * (rooms(gl)[a[2]] ?? 4),
    texImage3D: (gl, a) => a[3] * a[4] * a[5] * size(gl, a[7], a[8]),
  };
  for (const name of Object.getOwnPropertyNames(prototype)) {
    const { value } = Object.getOwnPropertyDescriptor(prototype, name);
    if (typeof value !== "function") continue;
    prototype[name] = function (...all) {
      counted.calls += 1;
      counted.bytes += sent[name]?.(this, all) ?? 0;
      counted.textures += made[name]?.(this, all) ?? 0;
      return value.apply(this, all);
    };
  }
})()"""
"""Counts calls, bytes that are sent, and the size of 3-D textures [bytes]."""


# --- vtk.js -------------------------------------------------------------------------------


def _beside(page: Page, script: str, effort: Effort) -> Report:
    """Compares pictures of the same scene, with the segment as tissue."""
    # vtk.js is given no surfaces, which the page may show by now
    _show(page, PEER_MODES[0])
    page.read("document.querySelector('[data-testid=inside-plain]')?.click()")
    page.read("void window.palpate.suspendDrawing(true)")
    page.read(f"void (() => {{ {script} }})()")
    _show_suspended(page, PEER_MODES[0])
    if page.read("window.palpate.bench.scene() !== null") is not True:
        raise OptionError(
            "the page shows a part of the scan only; allowed: a scan that fits the GPU"
        )
    page.read("void window.vtkDoor.open(window.palpate.bench.scene())")
    report: Report = {}
    for mode in effort.peer_modes:
        _show_suspended(page, mode)
        size, whole = effort.peer_size, effort.whole
        ours = _Renderer(page, "window.palpate.bench.draw(", whole, size)
        theirs = _Renderer(page, f"window.vtkDoor.draw('{mode}', ", whole, size)
        our_time, our_off = ours.time(1), ours.off(1)
        offs = {1: theirs.off(1)}
        steps = 1
        while offs[steps] > our_off and steps < PEER_STEPS[-1]:
            steps *= 2
            offs[steps] = theirs.off(steps)
        same = theirs.time(1)
        equal = same if steps == 1 else theirs.time(steps)
        report[peer_case(mode)] = {
            "ours": our_time,
            "ours off": our_off,
            "same": same,
            "same off": offs[1],
            "same ratio": same / our_time,
            "equal steps": float(steps),
            "ratio": equal / our_time,
        }
    return report


def _show_suspended(page: Page, mode: str) -> None:
    """Sets a mode for when the page draws again, and passes the appearance on now."""
    page.read(
        "(() => { const list = document.querySelector('[data-testid=blend]');"
        f" list.value = '{mode}'; list.dispatchEvent(new Event('change', {{bubbles: true}})); }})()"
    )
    page.read(FRAMES)


@dataclass(frozen=True)
class _Renderer:
    page: Page
    call: str
    """JavaScript that draws, up to the options."""
    repeats: int
    size: tuple[int, int]
    """Columns and rows."""

    def time(self, steps: int) -> float:
        """Returns the median time of whole pictures [s]."""
        expression = f"{self._drawn(steps)}.milliseconds"
        self.page.read(expression)
        return median(float(self.page.read(expression)) for _ in range(self.repeats)) / 1e3

    def off(self, steps: int) -> float:
        """Returns the mean difference from a picture with more steps; colours are 0 to 1."""
        found: Any = self.page.read(
            f"(() => {{ const one = {self._drawn(steps)}.colours.map(shown);"
            f" const fine = {self._drawn(FINE * steps)}.colours.map(shown);"
            " let sum = 0, count = 0;"
            " for (let i = 0; i < one.length; ++i) if (fine[i] > 0 || one[i] > 0) {"
            "   sum += Math.abs(one[i] - fine[i]); count += 1; }"
            " return sum / Math.max(1, count);"
            f" function shown(c) {{ c = Math.min(1, Math.max(0, c)); return {self._coded}; }} }})()"
        )
        return float(found)

    @property
    def _coded(self) -> str:
        """Screen value of a colour: Palpate's are linear light, those of vtk.js are encoded."""
        if "vtk" in self.call:
            return "c"
        return "c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055"

    def _drawn(self, steps: int) -> str:
        width, height = self.size
        return f"{self.call}{{width: {width}, height: {height}, stepsPerVoxel: {steps}}})"
