"""Objects as a person with the page puts them together.

They are picked where they stand, dragged step by step, cut along a painted line; a plate stands
beside a scan of thick slices; and the clutch and a gamepad lead the probe.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import SimpleITK
from browser import ROOT, Browser, browser, palpate
from numpy.typing import ArrayLike
from palpate.volumes.mesh_write import write_mesh
from palpate.volumes.surface import Mesh

pytestmark = pytest.mark.browser

OUTPUT = ROOT / "tests" / "output"
MIDDLES = ((20.0, 32.0, 32.0), (46.0, 32.0, 32.0))
RADIUS = 9.0
SPACING = (1.0, 1.0, 2.0)
PLATE = np.array([10.0, 1.5, 14.0])
PLATE_AT = np.array([46.0, 12.0, 32.0])
"""The middle of the plate [mm], before the second ball."""
SIZE = {"width": 1100, "height": 760}
POSE = "window.palpate.state.poses.find(({ id }) => id === 1)?.pose"
PAD = (
    "void (() => { const button = () => ({pressed: false, value: 0});"
    " const pad = {id: 'Test Pad', index: 0, connected: true, timestamp: 1, mapping: 'standard',"
    " axes: [0, 0, 0, 0], buttons: Array.from({length: 17}, button)}; window.__pad = pad;"
    " Object.defineProperty(navigator, 'getGamepads', {configurable: true,"
    " value: () => window.__pad === null ? [] : [window.__pad]});"
    " window.dispatchEvent(new Event('gamepadconnected')); })()"
)
"""Plugs a gamepad in."""


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """Two balls of a label map in thick slices and a plate from a file, seen from before."""
    folder = tmp_path_factory.mktemp("assembly")
    z, y, x = np.indices((32, 64, 68))
    points = np.stack([x, y, z], -1) * SPACING
    labels = np.zeros(z.shape, np.uint8)
    for label, middle in enumerate(MIDDLES, start=1):
        labels[np.linalg.norm(points - middle, axis=-1) <= RADIUS] = label
    paths = folder / "scan.mha", folder / "labels.mha"
    for array, path in zip(((labels > 0) * np.int16(1000), labels), paths, strict=True):
        image = SimpleITK.GetImageFromArray(array)
        image.SetSpacing(SPACING)
        SimpleITK.WriteImage(image, str(path))
    write_plate(folder / "plate.stl")
    mesh = ("--mesh", folder / "plate.stl", "--spacing", "0.25")
    with (
        palpate("open", paths[0], "--segments", paths[1], *mesh) as command,
        browser() as opened,
    ):
        assert opened.do("open", url=command.url, **SIZE)["firstPicture"] is not None
        opened.read("window.palpate.setView('A')")
        opened.wait("window.palpate.triangles[3] > 0")
        opened.finish()
        yield opened


def write_plate(path: Path) -> None:
    corners = np.array([[i & 1, i >> 1 & 1, i >> 2 & 1] for i in range(8)], np.float64) - 0.5
    sides = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    triangles = [triple for a, b, c, d in sides for triple in ((a, b, c), (a, c, d))]
    normals = corners / np.linalg.norm(corners, axis=1, keepdims=True)
    vertices = PLATE_AT + corners * PLATE
    write_mesh(Mesh(vertices, normals.astype(np.float32), np.array(triangles, np.uint32)), path)


def seen(page: Browser, point: ArrayLike) -> tuple[float, float]:
    """Returns where a point of the scene stands in the picture [CSS pixels]."""
    camera = page.read("window.palpate.camera")
    width, height = page.read(
        "(({ clientWidth, clientHeight }) => [clientWidth, clientHeight])"
        "(document.querySelector('[data-testid=canvas]'))"
    )
    right, up, back, target = (np.array(camera[key]) for key in ("right", "up", "back", "target"))
    from_eye = np.asarray(point) - (target + back * camera["distance"])
    scale = height / 2.0 / np.tan(camera["field"] / 2.0) / -(from_eye @ back)
    return width / 2.0 + scale * (from_eye @ right), height / 2.0 - scale * (from_eye @ up)


def pick(page: Browser, point: ArrayLike) -> int | None:
    x, y = seen(page, point)
    picked = page.read(f"window.palpate.pick({x}, {y})")
    return None if picked is None else picked["segment"]


def test_a_mesh_of_the_command_line_is_as_thick_as_it_is_in_thick_slices(page: Browser) -> None:
    assert "plate" in page.text("segment-3")
    assert pick(page, PLATE_AT) == 3
    front = float(PLATE_AT[1] - PLATE[1] / 2.0)
    for start, end in ((front - 4.0, front), (front + 4.5, front + 1.5)):
        page.read(f"window.palpate.place({[46.0, start, 32.0]})")
        page.wait(f"Math.abs(window.palpate.state.proxy[1] - {start}) < 0.01")
        page.read(f"window.palpate.hand({[46.0, 12.0, 32.0]})")
        # the probe stops at the face, whichever it comes to: the plate is a multiple of its voxels
        page.wait(
            f"window.palpate.state.touched === 3"
            f" && Math.abs(window.palpate.state.proxy[1] - {end}) < 0.02"
        )
        page.read(f"window.palpate.place({[46.0, start, 32.0]})")
        page.wait("!window.palpate.state.contact")


def test_a_moved_object_is_found_where_it_stands_and_says_its_name(page: Browser) -> None:
    assert pick(page, MIDDLES[0]) == 1
    page.do("click", testid="move-object")
    page.do("dragElement", testid="arrow-S", x=0, y=-90)
    page.wait(f"{POSE} !== undefined && {POSE}[11] > 6 && window.palpate.triangles[1] > 0")
    page.wait("window.palpate.state.pending === 0")
    shift = settled_pose(page)[11]
    moved = (MIDDLES[0][0], MIDDLES[0][1], MIDDLES[0][2] + shift)
    page.do("click", testid="move-object")
    page.finish()
    assert pick(page, moved) == 1
    # of where the scan has it nothing is drawn that is not covered by the moved one
    assert pick(page, (MIDDLES[0][0], MIDDLES[0][1], MIDDLES[0][2] - RADIUS + 1.5)) is None
    x, y = seen(page, moved)
    page.do("doubleClick", x=x, y=y)
    page.wait("document.querySelector('[data-testid=picked-name]') !== null")
    assert page.text("picked-name") == "label 1"
    # the probe is before what was seen, not where the scan has it
    page.wait(f"Math.abs(window.palpate.state.proxy[2] - {moved[2]}) < 2")


def settled_pose(page: Browser) -> list[float]:
    """Returns the pose once it is where it was asked to be."""
    page.all_done()
    page.read("void (window.__pose = undefined)")
    page.wait(
        f"(() => {{ const now = JSON.stringify({POSE}), tick = window.palpate.state.tick;"
        " const before = window.__pose;"
        " if (before === undefined || before.now !== now) window.__pose = { now, tick };"
        " return before !== undefined && before.now === now && tick - before.tick > 300; })()"
    )
    # the handles stand there too
    page.frames()
    pose: list[float] = page.read(POSE)
    return pose


def test_each_drag_is_a_step_of_undo(page: Browser) -> None:
    page.do("click", testid="move-object")
    before = settled_pose(page)
    page.do("dragElement", testid="arrow-L", x=-14, y=0)
    once = settled_pose(page)
    page.do("dragElement", testid="arrow-L", x=-14, y=0)
    twice = settled_pose(page)
    assert before[3] > once[3] + 0.5 > twice[3] + 1.0
    for pose in (once, before):
        page.do("press", key="Control+z")
        page.wait(f"Math.abs({POSE}[3] - {pose[3]}) < 1e-9")
    page.do("click", testid="move-object")


def test_a_painted_line_is_looked_at_then_cut_and_undone(page: Browser) -> None:
    # the whole view, so that the line from its middle outward parts the ball beside it
    ball = settled_pose(page)
    middle = np.add(MIDDLES[0], [ball[3], ball[7], ball[11]])
    page.read("window.palpate.setView('A')")
    page.finish()
    page.do("click", testid="paint-cut")
    assert "Paint a line" in page.text("cut-bar")
    camera = page.read("window.palpate.camera")
    x, y = seen(page, middle)
    width, height = page.read(
        "(({ clientWidth, clientHeight }) => [clientWidth, clientHeight])"
        "(document.querySelector('[data-testid=canvas]'))"
    )
    # from the middle of the picture straight through the middle of the ball
    page.do("drag", x=x - width / 2.0, y=y - height / 2.0)
    page.wait("document.querySelector('[data-testid=cut-parts]') !== null")
    assert page.read("window.palpate.camera") == camera, "painting turns no picture"
    sizes = [
        float(word) for word in page.text("cut-parts").split() if re.fullmatch(r"\d+\.\d+", word)
    ]
    # a ball of 9 mm has 3.05 ml; a plane through its middle halves it, to a layer of voxels
    assert sizes[0] == pytest.approx(1.53, rel=0.2)
    assert sizes[1] == pytest.approx(1.53, rel=0.2)
    page.do("screenshot", path=str(OUTPUT / "painted-cut.png"))
    # another line can be painted in its place; from the side the cut is seen as a surface
    page.do("click", testid="cut-anew")
    page.wait("document.querySelector('[data-testid=cut-parts]') === null")
    page.do("drag", x=x - width / 2.0, y=y - height / 2.0)
    page.wait("document.querySelector('[data-testid=cut-parts]') !== null")
    assert page.read("document.querySelector('[data-testid=segment-4]')") is None
    page.do("click", testid="cut-apply")
    page.wait("document.querySelector('[data-testid=segment-4]') !== null")
    assert page.read("document.querySelector('[data-testid=cut-bar]')") is None
    page.do("press", key="Control+z")
    page.wait("document.querySelector('[data-testid=segment-4]') === null")

    # a line that misses says so, and Escape ends it
    page.do("click", testid="paint-cut")
    page.do("drag", x=-200.0, y=320.0)
    page.wait("document.querySelector('[data-testid=cut-bar]').textContent.includes('one side')")
    page.do("press", key="Escape")
    page.wait("document.querySelector('[data-testid=cut-bar]') === null")


def hold(page: Browser, key: str, *, on: bool) -> None:
    kind = "keydown" if on else "keyup"
    page.read(f"void window.dispatchEvent(new KeyboardEvent('{kind}', {{key: '{key}'}}))")


def test_the_clutch_lets_the_hand_move_without_the_probe(page: Browser) -> None:
    page.read("window.palpate.place([34, 6, 52])")
    page.wait("Math.abs(window.palpate.state.proxy[2] - 52) < 0.01")
    proxy = page.settled()["proxy"]
    hold(page, "k", on=True)
    page.wait("window.palpate.state.clutched")
    page.read("window.palpate.hand([24, 6, 46])")
    still = page.settled()
    assert still["clutched"]
    assert still["proxy"] == pytest.approx(proxy, abs=1e-6)
    assert still["force"] == [0.0, 0.0, 0.0]
    hold(page, "k", on=False)
    page.wait("!window.palpate.state.clutched")
    # what the hand did meanwhile is forgotten; what it does from now on leads the probe again
    assert page.settled()["proxy"] == pytest.approx(proxy, abs=1e-6)
    page.read("window.palpate.hand([24, 6, 46])")
    page.wait("Math.abs(window.palpate.state.proxy[0] - 24) < 0.05")


def test_the_upper_button_of_a_gamepad_grabs_what_is_touched_and_lets_go(page: Browser) -> None:
    page.read(PAD)
    with page.settings():
        page.wait("document.querySelector('[data-testid=gamepad]') !== null")
    front = float(PLATE_AT[1] - PLATE[1] / 2.0)
    page.read(f"window.palpate.place({[46.0, front - 3.0, 32.0]})")
    page.wait(f"Math.abs(window.palpate.state.proxy[1] - {front - 3.0}) < 0.01")
    page.read(f"window.palpate.hand({PLATE_AT.tolist()})")
    page.wait("window.palpate.state.touched === 3")
    for grabbed in (3, 0):
        page.read("void (window.__pad.buttons[3] = {pressed: true, value: 1})")
        page.wait(f"window.palpate.state.grabbed === {grabbed}")
        page.read("void (window.__pad.buttons[3] = {pressed: false, value: 0})")
        # the page must have seen it released before it is pressed again
        page.read(f"new Promise(done => {3 * 'requestAnimationFrame(() => '}done(0){3 * ')'})")
    page.read("window.__pad = null; void window.dispatchEvent(new Event('gamepaddisconnected'))")
    with page.settings():
        page.wait("document.querySelector('[data-testid=gamepad]') === null")


def test_the_box_that_the_device_reaches_is_drawn_once_it_is_seen_from_outside(
    page: Browser,
) -> None:
    assert page.read("document.querySelector('[data-testid=reach]')") is None
    with page.settings():
        page.do("slide", testid="gain", value=-1.0)
    page.wait("window.palpate.settings.gain < 0.11")
    for _ in range(12):
        page.do("wheel", y=400)
    page.wait("document.querySelectorAll('[data-testid=reach] line').length === 12")
    page.do("screenshot", path=str(OUTPUT / "reach.png"))
    with page.settings():
        page.do("slide", testid="gain", value=0.0)
    assert page.complaints == []
