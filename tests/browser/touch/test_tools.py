"""Tools on the page in a real browser: what the mouse erases, what the drill tells, recovery.

The scan is a flat block, written here, as in ``test_touch.py``.
"""

from __future__ import annotations

import shutil
import signal
import time
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import palpate as palpate_package
import pytest
import SimpleITK
from browser import ROOT, Browser, browser, palpate
from palpate import Scene, Session, SessionOptions
from palpate.volumes.scan_hash import scan_hash

pytestmark = pytest.mark.browser

OUTPUT = ROOT / "tests" / "output"
EDGE = 48
"""Voxels along the scan, each 1 mm."""
SURFACE = 23.5
"""Where the block begins along y [mm]; it fills everything from there to the back."""
MIDDLE = EDGE / 2
OPTIONS = ("--threshold", "500", "--unit", "HU", "--port", "0")


def labelled(segment: int) -> str:
    """Returns what counts the voxels of a segment, once it was edited."""
    return (
        "fetch('/api/labels').then(answer => answer.arrayBuffer()).then(bytes => "
        f"new Uint8Array(bytes).reduce((sum, id) => sum + (id === {segment} ? 1 : 0), 0))"
    )


LABELLED = labelled(1)
"""How many voxels the block has."""
TOOL = "window.palpate.state.tool"
STILL = SessionOptions(real_time=False)


@pytest.fixture(scope="module")
def block(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A scan of a flat block in air."""
    values = np.full((EDGE, EDGE, EDGE), -1000, np.int16)
    values[:, EDGE // 2 :, :] = 1000
    path = tmp_path_factory.mktemp("block") / "block.mha"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(path))
    return path


@pytest.fixture
def page(block: Path) -> Iterator[Browser]:
    """The block on the page, seen from before, with the probe close to it."""
    with palpate("open", block, *OPTIONS) as command, browser() as opened:
        show(opened, command.url)
        yield opened
        assert opened.complaints == []


def show(page: Browser, url: str) -> None:
    assert page.do("open", url=url, width=1000, height=640)["firstPicture"] is not None
    page.read("window.palpate.setView('A')")
    page.read(f"window.palpate.place({[MIDDLE, SURFACE - 2, MIDDLE]})")
    page.wait(f"Math.abs(window.palpate.state.proxy[1] - {SURFACE - 2}) < 0.5")


def choose(page: Browser, kind: str) -> None:
    page.do("click", testid=f"tool-{kind}")
    page.wait(f"{TOOL}.kind === '{kind}'")


def show_surface(page: Browser) -> int:
    """Shows the block as a surface over its voxels; gives its triangles."""
    page.read("document.querySelector('[data-testid=shown-as-both]').click()")
    page.wait("window.palpate.triangles[1] > 0")
    triangles: int = page.read("window.palpate.triangles[1]")
    return triangles


def hold(page: Browser, *, on: bool) -> None:
    """Holds the key of the tool, or lets it go."""
    kind = "keydown" if on else "keyup"
    page.read(f"void window.dispatchEvent(new KeyboardEvent('{kind}', {{key: 'x'}}))")


def test_the_mouse_erases_what_volume_and_surface_show_and_undo_brings_it_back(
    page: Browser,
) -> None:
    triangles = show_surface(page)
    page.picture(OUTPUT / "tools-before.png")
    choose(page, "eraser")
    page.read(
        "void (() => { window.__frames = []; const look = () => {"
        " window.__frames.push([window.palpate.lastEdit, window.palpate.triangles[1]]);"
        " requestAnimationFrame(look); }; look(); })()"
    )
    page.do("stroke", x=10, y=0, depth=-200, steps=10, held=True)
    for x in (25, 40, 55, 70):
        # on, until the page has shown another edit
        before = page.read("window.palpate.lastEdit")
        page.do("touch", x=x, y=x / 3)
        page.wait(f"window.palpate.lastEdit > {before}")
    page.do("release")
    page.all_done()
    page.wait(f"!{TOOL}.on")
    erased = page.read(f"{TOOL}.voxels")
    assert erased > 20
    page.wait(f"{LABELLED}.then(count => count === {EDGE * EDGE * EDGE // 2 - erased})")
    page.wait("window.palpate.lastEdit === window.palpate.state.edit")
    page.shows("tool-volume", "text.endsWith('mm³')")
    # voxels and surface of an edit come in one message: its number tells which surface is seen
    shown = {tuple(frame) for frame in page.read("window.__frames")}
    edits = [edit for edit, _ in shown]
    assert len(edits) > 2
    assert len(edits) == len(set(edits))
    assert page.read("window.palpate.triangles[1]") != triangles

    page.do("press", key="Control+z")
    page.wait("!window.palpate.state.can_undo")
    page.wait(f"window.palpate.triangles[1] === {triangles}")
    page.do("press", key="Control+Shift+z")
    page.wait("!window.palpate.state.can_redo")
    page.wait(f"window.palpate.triangles[1] !== {triangles}")


def test_tools_have_names_their_card_stands_beside_the_picture_and_tooltips_tell_the_key(
    page: Browser,
) -> None:
    choose(page, "drill")
    assert page.text("tool-drill") == "DrillD"
    edges = page.read(
        "(() => { const box = (id) => document.querySelector(`[data-testid=${id}]`)"
        ".getBoundingClientRect(); return [box('canvas').right, box('tool-card').left]; })()"
    )
    assert edges[0] <= edges[1]
    point_at(page, "tool-needle")
    page.shows("tooltip", "/^Needle: .+I$/s.test(text)")
    # the browser has nothing to tell of it a second time
    assert page.read("document.querySelector('[data-testid=tool-needle]').title") == ""
    page.do("screenshot", path=str(OUTPUT / "tools-card.png"))
    point_at(page, "tool-eraser")
    page.shows("tooltip", "/^Eraser: .+E$/s.test(text)")
    told = page.read("document.querySelector('[data-testid=tool-needle]').title")
    assert told.endswith("(I)")
    page.do("click", testid="tool-eraser")
    page.wait("document.querySelector('[data-testid=tooltip]') === null")


def point_at(page: Browser, testid: str) -> None:
    """Puts the mouse over an element."""
    box = page.read(
        f"document.querySelector('[data-testid={testid}]').getBoundingClientRect().toJSON()"
    )
    page.do("point", x=box["x"] + box["width"] / 2, y=box["y"] + box["height"] / 2)


def test_a_stroke_does_not_turn_the_picture_and_a_drag_without_shift_does(page: Browser) -> None:
    choose(page, "eraser")
    before = page.read("window.palpate.camera.right")
    page.do("stroke", x=40, y=0)
    assert page.read("window.palpate.camera.right") == before
    page.all_done()
    page.wait(f"!{TOOL}.on")
    page.do("drag", x=40, y=0)
    assert page.read("window.palpate.camera.right") != before
    page.all_done()
    assert not page.read(f"{TOOL}.on")


def test_what_is_touched_is_painted_and_touch_does_not_notice(page: Browser) -> None:
    # the block is a range of values first, which a tissue's stands for
    page.do("choose", testid="threshold-preset", value="bone")
    page.wait("document.querySelector('[data-testid=threshold]').value === '226'")
    page.wait("document.querySelector('[data-testid=threshold-preset]').value === 'bone'")
    page.all_done()
    page.read(f"window.palpate.hand({[MIDDLE, SURFACE + 2, MIDDLE]})")
    page.wait("window.palpate.state.contact")
    page.all_done()
    # the key takes the brush and makes a segment to paint with
    page.do("press", key="w")
    page.wait(f"{TOOL}.kind === 'painter'")
    assert "Painted 1" in page.text("paint-segment")
    page.do("slide", testid="paint-depth", value=2)
    before = page.read("window.palpate.state.proxy[1]")
    hold(page, on=True)
    page.wait(f"{TOOL}.on && {TOOL}.voxels > 20")
    page.read(f"window.palpate.hand({[MIDDLE + 6, SURFACE + 2, MIDDLE]})")
    page.wait("window.palpate.state.proxy[0] > " + str(MIDDLE + 5))
    hold(page, on=False)
    page.wait(f"!{TOOL}.on")
    page.all_done()
    assert page.read("window.palpate.state.pending") == 0
    assert abs(page.read("window.palpate.state.proxy[1]") - before) < 0.01
    page.shows("tool-volume", "parseFloat(text) > 20")
    painted = page.read(f"{TOOL}.voxels")
    whole = EDGE * EDGE * EDGE // 2
    page.wait(f"{labelled(2)}.then(count => count === {painted})")
    page.wait(f"{LABELLED}.then(count => count === {whole - painted})")
    page.finish()
    page.do("screenshot", path=str(OUTPUT / "tools-painted.png"))
    page.do("press", key="Control+z")
    page.wait(f"{labelled(2)}.then(count => count === 0)")


def test_the_drill_takes_time_and_tells_what_it_removed(page: Browser, tmp_path: Path) -> None:
    choose(page, "drill")
    radius = page.read(f"{TOOL}.radius")
    page.wait(f"Math.abs(window.palpate.settings.probe_radius - {radius}) < 1e-6")
    hold(page, on=True)
    page.wait(f"{TOOL}.on")
    began = page.read("window.palpate.state.proxy")
    page.read(f"window.palpate.hand({[MIDDLE, SURFACE + 2, MIDDLE]})")
    page.read("void (window.__load = 0)")
    page.wait(
        f"(window.__load = Math.max(window.__load, {TOOL}.load)) > 0 && {TOOL}.volume > 2",
    )
    page.shows("tool-volume", "!text.startsWith('0 ')")
    page.shows("tool-time", "parseFloat(text) > 0")
    page.shows("tool-size", f"text === '⌀ {2 * radius:.1f} mm'")
    page.do("screenshot", path=str(OUTPUT / "tools-drill.png"))
    hold(page, on=False)
    page.wait(f"!{TOOL}.on")
    page.shows("drill-report", "text.startsWith('Stroke 1') && !text.includes('…')")
    check_strokes_table(page, tmp_path, began)
    choose(page, "none")
    # the probe is a point again, as it was
    page.wait("window.palpate.settings.probe_radius === 0")

    # the hole is as empty in a slice as in the volume, and undo fills it
    page.read(f"window.palpate.place({[MIDDLE, SURFACE - 6, MIDDLE]})")
    page.do("click", testid="layout-four")
    page.wait("window.palpate.slices.length === 3")
    page.do("screenshot", path=str(OUTPUT / "tools-hole.png"))
    drilled = hole_seen(page)
    page.do("press", key="Control+z")
    page.wait("!window.palpate.state.can_undo")
    whole = hole_seen(page)
    assert whole[0] > 0.5
    assert drilled[0] < whole[0] - 0.4
    assert drilled[1] > whole[1] + 0.9


def test_a_page_that_is_loaded_again_has_the_tool_of_the_engine_and_the_next_scan_none(
    page: Browser, block: Path, tmp_path: Path
) -> None:
    choose(page, "drill")
    page.wait("window.palpate.settings.probe_radius > 0")
    page.do("open", url=page.read("window.location.href"), width=1000, height=640)
    page.wait(f"{TOOL}.kind === 'drill'")
    page.shows("tool-card", "text.startsWith('Drill')")
    # a threshold stays one after it was drilled
    page.read(f"window.palpate.place({[MIDDLE, SURFACE - 2, MIDDLE]})")
    hold(page, on=True)
    page.read(f"window.palpate.hand({[MIDDLE, SURFACE + 2, MIDDLE]})")
    page.wait(f"{TOOL}.volume > 1")
    hold(page, on=False)
    page.wait(f"!{TOOL}.on")
    page.all_done()
    assert page.read("document.querySelector('[data-testid=threshold]').value") == "500"

    other = shutil.copy(block, tmp_path / "other.mha")
    before = page.read("performance.timeOrigin")
    page.do("click", testid="open-scan")
    page.do("fill", testid="open-path", text=str(other))
    page.do("click", testid="open-look")
    page.wait(f"performance.timeOrigin > {before} && window.palpate?.ready === true")
    page.wait(f"{TOOL}.kind === 'none'")
    assert page.read("window.palpate.settings.probe_radius") == 0


def check_strokes_table(page: Browser, folder: Path, began: list[float]) -> None:
    """Compares the table of one stroke with what the engine counted; where the probe began."""
    page.wait("!document.querySelector('[data-testid=strokes-save]').disabled")
    file = folder / "strokes.csv"
    assert page.do("download", testid="strokes-save", path=str(file))["name"].endswith(".csv")
    head, row = (line.split(",") for line in file.read_text().splitlines())
    told = dict(zip(head, map(float, row), strict=True))
    counted = page.read(TOOL)
    assert told["volume removed (mm3)"] == pytest.approx(counted["volume"], abs=1e-3)
    assert told["energy (mJ)"] == pytest.approx(counted["energy"], abs=0.1)
    assert 0.0 < told["mean force (N)"] <= told["peak force (N)"]
    # at least the straight way, to a tenth that the probe may move before the stroke is known
    way = float(np.linalg.norm(np.subtract(page.read("window.palpate.state.proxy"), began)))
    assert told["path (mm)"] >= way - 0.1
    page.do("click", testid="strokes-copy")
    page.wait("document.body.textContent.includes('The table of strokes is copied')")


def hole_seen(page: Browser) -> tuple[float, float]:
    """Returns what is seen where the drill was, just under the face of the block.

    That is how light the axial slice is there, 0..1, and how far the 3-D view looks [mm along y].
    """
    page.all_done()
    page.wait("window.palpate.lastEdit === window.palpate.state.edit")
    # beside it, so that no line of the crosshair is over it
    page.read(f"window.palpate.cross({[MIDDLE - 10, SURFACE - 10, MIDDLE]})")
    page.finish()
    path = OUTPUT / "tools-slice.png"
    page.do("screenshot", path=str(path), testid="slice-axial")
    pixels = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(path)))
    plane = page.read("window.palpate.slices.find(({name}) => name === 'axial').plane")
    from_middle = np.array([MIDDLE, SURFACE + 0.5, MIDDLE]) - plane["centre"]
    right, up = (float(from_middle @ plane[axis]) / plane["pixel"] for axis in ("right", "up"))
    height, width = pixels.shape[:2]
    pixel = pixels[round((height - 1) / 2 - up), round((width - 1) / 2 + right), :3]
    seen = page.read("window.palpate.pick(...window.palpate.middle).point[1]")
    return float(pixel.mean()) / 255.0, float(seen)


def test_a_tool_without_a_segment_says_so(page: Browser) -> None:
    page.do("click", testid="lock-1")
    page.wait("document.querySelector('[data-testid=lock-1]').ariaPressed === 'true'")
    page.do("press", key="e")
    page.wait("document.body.textContent.includes('what can be touched is locked')")
    remove = "document.querySelector('[aria-label=\"Remove threshold\"]')"
    assert page.read(f"{remove}.disabled")
    page.do("screenshot", path=str(OUTPUT / "locked.png"))
    page.do("press", key="Control+z")
    page.wait("document.querySelector('[data-testid=lock-1]').ariaPressed === 'false'")

    page.do("press", key="e")
    page.wait(f"{TOOL}.kind === 'eraser'")
    page.do("press", key="h")
    page.read(f"{remove}.click()")
    page.wait("document.querySelector('[data-testid=segment-1]') === null")
    page.do("press", key="e")
    page.wait("document.body.textContent.includes('There is no segment to work on')")


def steps_in(journal: Path, *, of: Path) -> int:
    """Counts the steps, the one that goes on too, that a journal of a scan holds by now."""
    volume = palpate_package.read(of)
    with TemporaryDirectory() as folder, Session(Scene(volume), options=STILL) as session:
        copy = Path(shutil.copy(journal, folder))
        found = session.look_at_journal(copy, scan_hash(volume))
    return 0 if found is None else found[0]


def test_after_a_kill_the_page_offers_what_was_done_and_brings_it_back(
    block: Path, tmp_path: Path
) -> None:
    with palpate("open", block, *OPTIONS, state=tmp_path) as command, browser() as page:
        show(page, command.url)
        choose(page, "eraser")
        page.do("stroke", x=30, y=0, depth=-200, steps=10)
        page.wait(f"!{TOOL}.on && {TOOL}.voxels > 0")
        left = page.read(LABELLED)
        (journal,) = tmp_path.rglob("*.journal")
        hold(page, on=True)
        page.read(f"window.palpate.hand({[MIDDLE - 8, SURFACE + 3, MIDDLE]})")
        page.wait(f"{TOOL}.on && {TOOL}.voxels > 0")
        # what is done is written down beside
        ends = time.monotonic() + 60.0
        while steps_in(journal, of=block) < 2:
            assert time.monotonic() < ends, "the second stroke is not written down"
        command.process.send_signal(signal.SIGKILL)
    with palpate("open", block, *OPTIONS, state=tmp_path) as command, browser() as page:
        page.do("open", url=command.url, width=1000, height=640)
        page.wait("document.querySelector('[data-testid=recovery]') !== null")
        assert "2 changes of this scan are kept" in page.text("recovery")
        page.do("screenshot", path=str(OUTPUT / "tools-recovery.png"))
        page.do("click", testid="bring-back")
        page.wait("window.palpate.state.can_undo")
        page.wait(f"{LABELLED}.then(count => 0 < count && count < {left})")
        page.do("press", key="Control+z")
        page.wait(f"{LABELLED}.then(count => count === {left})")
        assert page.complaints == []
