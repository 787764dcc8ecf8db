"""Objects at the page: dragged by their handles, in the probe's hand, and the gap between them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
import SimpleITK
from browser import ROOT, Browser, browser, palpate

pytestmark = pytest.mark.browser

OUTPUT = ROOT / "tests" / "output"
SPACING = 1.0
MIDDLES = ((20.0, 32.0, 32.0), (46.0, 32.0, 32.0))
RADIUS = 9.0
SIZE = {"width": 1100, "height": 760}


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """Two balls of a label map, on the page."""
    folder = tmp_path_factory.mktemp("objects")
    z, y, x = np.indices((64, 64, 68))
    labels = np.zeros(z.shape, np.uint8)
    for label, middle in enumerate(MIDDLES, start=1):
        labels[np.linalg.norm(np.stack([x, y, z], -1) - middle, axis=-1) <= RADIUS] = label
    paths = folder / "scan.mha", folder / "labels.mha"
    for array, path in zip(((labels > 0) * np.int16(1000), labels), paths, strict=True):
        SimpleITK.WriteImage(SimpleITK.GetImageFromArray(array), str(path))
    with palpate("open", paths[0], "--segments", paths[1]) as command, browser() as opened:
        assert opened.do("open", url=command.url, **SIZE)["firstPicture"] is not None
        yield opened


def pose_of(state: dict[str, Any], segment: int) -> np.ndarray:
    """Returns where a segment stands in a state."""
    found = [moved["pose"] for moved in state["poses"] if moved["id"] == segment]
    return np.reshape(found[0], (4, 4)) if found else np.eye(4)


def test_the_arrow_drags_an_object_along_its_axis_and_the_gap_follows(page: Browser) -> None:
    page.do("click", testid="move-object")
    page.do("choose", testid="gap-to", value="2")
    apart = 26.0 - 2 * RADIUS
    page.shows("gap", "/mean/.test(text)")
    # half a voxel
    gap_is(page, apart, within=0.5)

    page.read("window.palpate.setView('A')")
    # the handles stand elsewhere then
    page.finish()
    page.do("dragElement", testid="arrow-L", x=25, y=0)
    page.wait("window.palpate.state.poses.some(({ id }) => id === 1)")
    pose = pose_of(page.settled(), 1)
    np.testing.assert_allclose(pose[:3, :3], np.eye(3), atol=1e-12)
    assert pose[0, 3] > 1.0
    np.testing.assert_allclose(pose[1:3, 3], 0.0, atol=1e-9)
    # the same stairs, nearer
    gap_is(page, apart - pose[0, 3], within=0.7)
    # it is shown as a surface
    page.wait("window.palpate.triangles[1] > 0")
    page.finish()
    page.do("screenshot", path=str(OUTPUT / "objects.png"))

    # a drag is one step back
    page.do("press", key="Control+z")
    page.wait("Math.abs(window.palpate.state.poses.find(({ id }) => id === 1).pose[3]) < 1e-6")


def test_a_ring_turns_an_object_about_its_middle(page: Browser) -> None:
    # half way between two other rings, which are seen from their edges
    page.finish()
    page.do("dragElement", testid="ring-P", x=20, y=20, **{"from": [44, -44]})
    pose = pose_of(page.settled(), 1)
    assert not np.allclose(pose[:3, :3], np.eye(3), atol=0.05)
    middle = np.append(np.add(MIDDLES[0], 0.0), 1.0)
    np.testing.assert_allclose((pose @ middle)[:3], middle[:3], atol=1e-6)
    page.do("click", testid="reset-object")
    page.wait(
        "window.palpate.state.poses.find(({ id }) => id === 1).pose"
        ".every((number, place) => Math.abs(number - (place % 5 === 0 ? 1 : 0)) < 1e-9)"
    )


def test_the_object_in_the_probes_hand_follows_it(page: Browser) -> None:
    page.read("window.palpate.place([20, 32, 50])")
    page.all_done()
    page.do("click", testid="grab-object")
    page.wait("window.palpate.state.grabbed === 1")
    before = page.settled()["proxy"]
    page.read("window.palpate.hand([24, 30, 54])")
    after = page.settled()
    pose = pose_of(after, 1)
    # what is shown of the probe is some ms older than the pose
    np.testing.assert_allclose(pose[:3, 3], np.subtract(after["proxy"], before), atol=0.1)
    assert np.linalg.norm(pose[:3, 3]) > 3.0
    page.do("click", testid="grab-object")
    page.wait("window.palpate.state.grabbed === 0")


def test_slices_show_an_object_where_it_stands(page: Browser) -> None:
    pose = pose_of(page.settled(), 1)
    middle = pose[:3, :3] @ np.array(MIDDLES[0]) + pose[:3, 3]
    page.do("click", testid="layout-four")
    page.read(f"window.palpate.cross({middle.tolist()})")
    outline = "document.querySelector('[data-testid=outline-axial-1]')"
    page.wait(f"{outline} !== null && {outline}.getBBox().width > 0")
    page.finish()
    box = page.read(f"(({{x, y, width, height}}) => [x, y, width, height])({outline}.getBBox())")
    slice_ = page.read("window.palpate.slices.find(({name}) => name === 'axial')")
    pixel, rect = slice_["plane"]["pixel"], slice_["rect"]
    # its diameter, and its middle at that of the crosshair
    assert box[2] * pixel == pytest.approx(2 * RADIUS, abs=1.5)
    assert box[3] * pixel == pytest.approx(2 * RADIUS, abs=1.5)
    offset = middle - np.array(slice_["plane"]["centre"])
    found = box[0] + box[2] / 2 - rect["width"] / 2, box[1] + box[3] / 2 - rect["height"] / 2
    # the patient's left is to the right, anterior is up
    np.testing.assert_allclose(np.multiply(found, pixel), offset[:2], atol=0.7)
    page.do("screenshot", path=str(OUTPUT / "objects_slices.png"))
    page.do("click", testid="layout-view")


def test_a_cut_shows_its_plane_then_makes_another_object_with_a_name_of_its_side(
    page: Browser,
) -> None:
    page.read("window.palpate.place([24, 30, 54])")
    page.all_done()
    page.do("click", testid="cut-object")
    page.wait("document.querySelector('[data-testid=cut-parts]') !== null")
    assert page.read("document.querySelector('[data-testid=segment-3]')") is None
    # what it goes along is seen from the side too: the left button turns the view meanwhile
    before = page.read("window.palpate.camera.right")
    page.do("drag", x=160, y=30)
    assert page.read("window.palpate.camera.right") != before
    page.finish()
    page.do("screenshot", path=str(OUTPUT / "objects_cut.png"))
    page.do("click", testid="cut-apply")
    page.wait("document.querySelector('[data-testid=segment-3]') !== null")
    page.shows("segment-3", "/, (left|right|upper|lower|front|back) part/.test(text)")
    page.do("press", key="Control+z")
    page.wait("document.querySelector('[data-testid=segment-3]') === null")
    assert page.complaints == []


def test_all_segments_are_drawn_otherwise_hidden_and_found_at_once(page: Browser) -> None:
    rows = "document.querySelectorAll('li[data-testid^=segment-]').length"
    count = page.read(rows)
    assert count >= 2
    page.do("click", testid="all-as-surface")
    drawn = "Object.values(window.palpate.triangles).filter((triangles) => triangles > 0).length"
    page.wait(f"{drawn} === {count}")
    seen = (
        "[...document.querySelectorAll('[data-testid^=visible-]')]"
        ".filter((eye) => eye.getAttribute('aria-pressed') === 'true').length"
    )
    assert page.read(seen) == count
    for left in (0, count):
        page.do("click", testid="all-visible")
        page.wait(f"{seen} === {left}")
    name = page.read(
        "document.querySelector('li[data-testid=segment-1] .whole').textContent.trim()"
    )
    page.do("fill", testid="find-segment", text=name.upper())
    page.wait(f"{rows} === 1")
    page.do("fill", testid="find-segment", text="")
    page.wait(f"{rows} === {count}")


def gap_is(page: Browser, expected: float, *, within: float) -> None:
    """Waits until the minimum that the page shows is that [mm]: it is measured beside all else."""
    page.shows("gap", f"Math.abs(parseFloat(text) - {expected}) <= {within}")
